// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

namespace pm {
struct RenderSettings;
class FrameStore;
}  // namespace pm

namespace pm::plugin {

// How many samples a pass will have over the one before it, about: counted in some of the atoms.
// The pass before must be whole. Threads: one at a time with those that add to the frame.
double samplesOverPassBefore(const RenderSettings& settings, const FrameStore& frame,
                             std::uint32_t pass);

}  // namespace pm::plugin
