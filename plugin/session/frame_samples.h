// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where the samples that light is asked for meet the frame that keeps and allots them.
#pragma once

#include <cstdint>
#include <span>

#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/frame_renderer.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// The empty frame of a render with these settings. sharesNoise: SampleRule::sharesNoise, which the
// plan knows (tracePhotons), as errorScale. Errors: those of FrameStore.
FrameStore makeFrame(const RenderSettings& settings, bool sharesNoise,
                     const ErrorScale& errorScale);

// What it takes, in bytes.
std::uint64_t frameMemoryBytes(const RenderSettings& settings);

// The samples of the pixels of rect, row by row, in a pass: of a fixed level, or what the frame
// allots. rect within the window's atoms.
void findSamples(const RenderSettings& settings, const FrameStore& frame, std::uint32_t pass,
                 const Rect& rect, std::span<SampleRun> runs);

}  // namespace pm::plugin
