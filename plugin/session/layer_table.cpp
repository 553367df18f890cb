// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/layer_table.h"

#include <array>

#include "plugin/values/named_table.h"

namespace pm::plugin {

namespace {

constexpr std::array<LayerSpec, kLayerCount> kLayers = {{
    {Layer::kBeauty, "beauty", "R,G,B,A", 4, LayerKind::kColour, true,
     "Radiance, the sum of direct, indirect, caustic and emission; A is the coverage."},
    {Layer::kDirect, "direct", "direct.R,direct.G,direct.B", 3, LayerKind::kColour, true,
     "Radiance of light that comes straight from a lamp to the surface seen."},
    {Layer::kIndirect, "indirect", "indirect.R,indirect.G,indirect.B", 3, LayerKind::kColour, true,
     "Radiance of light that met other surfaces before."},
    {Layer::kCaustic, "caustic", "caustic.R,caustic.G,caustic.B", 3, LayerKind::kColour, true,
     "Radiance of light that mirrors or glass focus on the surface seen."},
    {Layer::kEmission, "emission", "emission.R,emission.G,emission.B", 3, LayerKind::kColour, true,
     "Radiance that the surface seen emits itself."},
    {Layer::kAlbedo, "albedo", "albedo.R,albedo.G,albedo.B", 3, LayerKind::kColour, false,
     "Reflectance of the surface seen, premultiplied by coverage."},
    {Layer::kNormal, "N", "N.X,N.Y,N.Z", 3, LayerKind::kData, false,
     "Shading normal in world space, premultiplied by coverage: its mean over the pixel."},
    {Layer::kDepth, "Z", "Z", 1, LayerKind::kData, false,
     "Depth along the view axis in scene units, the mean over what is covered; 1e10 where nothing "
     "is hit."},
    {Layer::kStandardError, "stderr", "stderr.X,stderr.Y,stderr.Z", 3, LayerKind::kData, false,
     "Standard error of the beauty's mean, from the spread between passes; 0 with one pass."},
    {Layer::kHalfDifference, "halfdiff", "halfdiff.X,halfdiff.Y,halfdiff.Z", 3, LayerKind::kData,
     false,
     "The beauty's mean over even passes minus that over odd ones, scaled to its standard error: "
     "an "
     "error as it may be, with what pixels have in common; 0 with one pass."},
    {Layer::kSamples, "samples", "samples.X", 1, LayerKind::kData, false,
     "Camera samples of the pixel; a quarter for each that it shares with its group at level 0."},
    {Layer::kAaLevel, "aalevel", "aalevel.X", 1, LayerKind::kData, false,
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

}  // namespace pm::plugin
