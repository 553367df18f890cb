// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "plugin/include/pm_plugin.h"

namespace pm::plugin {

enum class Layer : std::size_t {
    kBeauty,
    kDirect,
    kIndirect,
    kCaustic,
    kEmission,
    kAlbedo,
    kNormal,
    kDepth,
    kStandardError,
    kHalfDifference,
    kSamples,
    kAaLevel,
    kCount
};
inline constexpr std::size_t kLayerCount = static_cast<std::size_t>(Layer::kCount);

// One layer; texts end with 0 and live as long as the library.
struct LayerSpec {
    Layer id;
    const char* name;
    const char* channels;
    std::uint32_t channelCount;
    std::int32_t kind;  // PMR_LAYER_*
    bool isDefault;
    const char* help;
};

// In the order of Layer.
std::span<const LayerSpec, kLayerCount> layerSpecs();

// Null where there is none of that name.
const LayerSpec* findLayer(std::string_view name);

// For the texts of errors.
std::vector<std::string_view> layerNames();

PmrLayerInfo toInfo(const LayerSpec& spec);

// What a host asks of a picture's layers. Throw CallError where it gave a null pointer, an index
// beyond them or a struct of no known size.
void writeLayerCount(const std::vector<Layer>& layers, std::uint32_t* count);
void writeLayerInfo(const std::vector<Layer>& layers, std::uint32_t index, PmrLayerInfo* info);

}  // namespace pm::plugin
