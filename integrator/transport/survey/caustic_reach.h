// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>

namespace pm {

class Scene;

// Photons that are sent, at most, before light is said to cast no caustics.
inline constexpr std::uint64_t kCausticReachPhotons = 1 << 16;

// Whether of so many photons, aimed at what casts caustics, one goes on from there. Where one of
// the first few does, as nearly everywhere, the others are not sent. A function of its arguments
// and the scene's geometry; works in parallel in the calling TBB arena. Throws Error(kCancelled)
// soon after cancel is set.
bool findsCaustics(const Scene& scene, std::uint64_t seed, const std::atomic<bool>& cancelled);

}  // namespace pm
