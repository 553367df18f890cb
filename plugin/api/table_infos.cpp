// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/table_infos.h"

#include "plugin/api/struct_reader.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

PmrSettingInfo toInfo(const SettingSpec& spec) {
    PmrSettingInfo info{};
    info.size = sizeof info;
    info.name = spec.name;
    info.unit = spec.unit;
    info.defaultText = spec.defaultText;
    info.choices = spec.choices;
    info.help = spec.help;
    info.cost = spec.cost;
    info.minimum = static_cast<double>(spec.minimum);
    info.maximum = static_cast<double>(spec.maximum);
    info.type = static_cast<std::int32_t>(spec.type);
    info.changesPixels = spec.changesPixels ? 1 : 0;
    return info;
}

PmrLayerInfo toInfo(const LayerSpec& spec) {
    PmrLayerInfo info{};
    info.size = sizeof info;
    info.name = spec.name;
    info.channels = spec.channels;
    info.help = spec.help;
    info.channelCount = spec.channelCount;
    info.kind = static_cast<std::int32_t>(spec.kind);
    info.isDefault = spec.isDefault ? 1 : 0;
    return info;
}

void writeLayerCount(const std::vector<Layer>& layers, std::uint32_t* count) {
    if (count == nullptr) throw argumentError("count is null");
    *count = static_cast<std::uint32_t>(layers.size());
}

void writeLayerInfo(const std::vector<Layer>& layers, std::uint32_t index, PmrLayerInfo* info) {
    checkIndex(index, layers.size());
    const LayerSpec& spec = layerSpecs()[static_cast<std::size_t>(layers[index])];
    writeStruct(info, toInfo(spec), "PmrLayerInfo");
}

}  // namespace pm::plugin
