// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/layer_table.h"

#include <array>

#include "plugin/src/call_error.h"
#include "plugin/src/named_table.h"
#include "plugin/src/struct_reader.h"

namespace pm::plugin {

namespace {

constexpr std::array<LayerSpec, kLayerCount> kLayers = {{
    {Layer::kBeauty, "beauty", "R,G,B,A", 4, PMR_LAYER_COLOUR, true,
     "Radiance, the sum of direct, indirect, caustic and emission; A is the coverage."},
    {Layer::kDirect, "direct", "direct.R,direct.G,direct.B", 3, PMR_LAYER_COLOUR, true,
     "Radiance of light that comes straight from a lamp to the surface seen."},
    {Layer::kIndirect, "indirect", "indirect.R,indirect.G,indirect.B", 3, PMR_LAYER_COLOUR, true,
     "Radiance of light that met other surfaces before."},
    {Layer::kCaustic, "caustic", "caustic.R,caustic.G,caustic.B", 3, PMR_LAYER_COLOUR, true,
     "Radiance of light that mirrors or glass focus on the surface seen."},
    {Layer::kEmission, "emission", "emission.R,emission.G,emission.B", 3, PMR_LAYER_COLOUR, true,
     "Radiance that the surface seen emits itself."},
    {Layer::kAlbedo, "albedo", "albedo.R,albedo.G,albedo.B", 3, PMR_LAYER_COLOUR, false,
     "Reflectance of the surface seen, premultiplied by coverage."},
    {Layer::kNormal, "N", "N.X,N.Y,N.Z", 3, PMR_LAYER_DATA, false,
     "Shading normal in world space, premultiplied by coverage: its mean over the pixel."},
    {Layer::kDepth, "Z", "Z", 1, PMR_LAYER_DATA, false,
     "Depth along the view axis in scene units, the mean over what is covered; 1e10 where nothing "
     "is hit."},
    {Layer::kStandardError, "stderr", "stderr.X,stderr.Y,stderr.Z", 3, PMR_LAYER_DATA, false,
     "Standard error of the beauty's mean, from the spread between passes; 0 with one pass."},
    {Layer::kHalfDifference, "halfdiff", "halfdiff.X,halfdiff.Y,halfdiff.Z", 3, PMR_LAYER_DATA,
     false,
     "The beauty's mean over even passes minus that over odd ones, scaled to its standard error: "
     "an "
     "error as it may be, with what pixels have in common; 0 with one pass."},
    {Layer::kSamples, "samples", "samples.X", 1, PMR_LAYER_DATA, false,
     "Camera samples of the pixel; a quarter for each that it shares with its group at level 0."},
    {Layer::kAaLevel, "aalevel", "aalevel.X", 1, PMR_LAYER_DATA, false,
     "Level of anti-aliasing that the pixel's samples amount to: 1 + log4(samples in four "
     "passes); 0 where it is still one of a group."},
}};

static_assert(isInOrderOfIds(kLayers));

}  // namespace

std::span<const LayerSpec, kLayerCount> layerSpecs() {
    return kLayers;
}

const LayerSpec* findLayer(std::string_view name) {
    return findByName(kLayers, name);
}

std::vector<std::string_view> layerNames() {
    std::vector<std::string_view> names;
    for (const LayerSpec& spec : kLayers) names.emplace_back(spec.name);
    return names;
}

PmrLayerInfo toInfo(const LayerSpec& spec) {
    PmrLayerInfo info{};
    info.size = sizeof info;
    info.name = spec.name;
    info.channels = spec.channels;
    info.help = spec.help;
    info.channelCount = spec.channelCount;
    info.kind = spec.kind;
    info.isDefault = spec.isDefault ? 1 : 0;
    return info;
}

void writeLayerCount(const std::vector<Layer>& layers, std::uint32_t* count) {
    if (count == nullptr) throw argumentError("count is null");
    *count = static_cast<std::uint32_t>(layers.size());
}

void writeLayerInfo(const std::vector<Layer>& layers, std::uint32_t index, PmrLayerInfo* info) {
    checkIndex(index, layers.size());
    const LayerSpec& spec = kLayers[static_cast<std::size_t>(layers[index])];
    writeStruct(info, toInfo(spec), "PmrLayerInfo");
}

}  // namespace pm::plugin
