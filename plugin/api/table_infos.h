// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The rows of the library's tables, as hosts read them.
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/values/rect.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/session/layer_table.h"
#include "plugin/session/setting_table.h"

namespace pm::plugin {

PmrSettingInfo toInfo(const SettingSpec& spec);
PmrLayerInfo toInfo(const LayerSpec& spec);

constexpr Rect toRect(const PmrRectangle& rectangle) {
    return {rectangle.x0, rectangle.y0, rectangle.x1, rectangle.y1};
}

// What a host asks of a picture's layers. Throw CallError where it gave a null pointer, an index
// beyond them or a struct of no known size.
void writeLayerCount(const std::vector<Layer>& layers, std::uint32_t* count);
void writeLayerInfo(const std::vector<Layer>& layers, std::uint32_t index, PmrLayerInfo* info);

}  // namespace pm::plugin
