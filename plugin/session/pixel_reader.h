// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a host sees of a frame store: its layers.
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/transport/frame_renderer.h"
#include "plugin/session/layer_table.h"
#include "plugin/session/setting_values.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// The layers of a render with these settings, in the order of the pixels.
std::vector<Layer> layersOf(const SettingValues& settings);

// What readPixels is given, as the header has it.
struct PixelRequest {
    Rect rectangle{};
    const char* layer = nullptr;
    float* destination = nullptr;
    std::int64_t pixelStrideBytes = 0, rowStrideBytes = 0;
};

// Copies the layer's pixels; 0 where there is no frame yet (null). passes: made so far. Errors:
// CallError ARGUMENT, and NAME for a layer that is not among these settings'.
void readLayerPixels(const PixelRequest& request, const SettingValues& settings,
                     const FrameStore* frame, const ChannelLayout& layout, std::uint32_t passes);

}  // namespace pm::plugin
