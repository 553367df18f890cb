// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

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

// The numbers are those of PMR_LAYER_* in pm_plugin.h.
enum class LayerKind : std::int32_t { kColour, kData };

// One layer; texts end with 0 and live as long as the library.
struct LayerSpec {
    Layer id;
    const char* name;
    const char* channels;
    std::uint32_t channelCount;
    LayerKind kind;
    bool isDefault;
    const char* help;
};

// In the order of Layer.
std::span<const LayerSpec, kLayerCount> layerSpecs();

// Null where there is none of that name.
const LayerSpec* findLayer(std::string_view name);

// For the texts of errors.
std::vector<std::string_view> layerNames();

}  // namespace pm::plugin
