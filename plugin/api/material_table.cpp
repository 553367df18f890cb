// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <array>
#include <cstddef>

#include "plugin/api/parameter_tables.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/parameters/place.h"

namespace pm::plugin {

namespace {

using Kind = StructPlace::Kind;
using Type = ParameterType;
using M = MaterialDescription;

// Nothing of what is not displaced: such scenes keep the checksums that they have had.
constexpr Place<M> kDisplacement = {texturePlace<&M::displacementTexture>().put,
                                    [](Hasher& hasher, const M& material) {
                                        if (material.displacementTexture == kNoTexture) return;
                                        hasher.add("displacement");
                                        hasher.add(material.displacementTexture);
                                    }};
constexpr Place<M> kDisplacementScale = {memberPlace<&M::displacementScale>().put,
                                         [](Hasher& hasher, const M& material) {
                                             if (material.displacementTexture != kNoTexture)
                                                 hasher.add(material.displacementScale);
                                         }};

// Which materials they are, the scene knows.
template <std::uint32_t M::*Part>
constexpr Place<M> partPlace() {
    constexpr auto kUnknown = [](M& material, const ParameterValue&, std::int32_t) {
        material.*Part = ~std::uint32_t{0};
    };
    return {kUnknown, [](Hasher& hasher, const M& material) {
                if (material.kind == MaterialKind::kMixture) hasher.add(material.*Part);
            }};
}

constexpr std::array kMaterialRows = {
    MaterialParameter{{.name = "kind",
                       .help = "surface: diffuse, plus a glossy lobe; mirror: glossy is its "
                               "reflectance; dielectric: smooth boundary of a medium; mixture: of "
                               "first and second",
                       .type = Type::kChoice,
                       .maximum = 3,
                       .defaultText = "surface",
                       .choices = "surface,mirror,dielectric,mixture"},
                      {Kind::kInt32, offsetof(PmrMaterialDesc, kind)},
                      {memberPlace<&M::kind>()}},
    MaterialParameter{{.name = "fresnel",
                       .help = "Perfect mirrors: 1 = Schlick's Fresnel from the glossy colour.",
                       .type = Type::kInteger,
                       .defaultText = "0"},
                      {Kind::kInt32, offsetof(PmrMaterialDesc, fresnel)},
                      {memberPlace<&M::fresnelMirror>()}},
    MaterialParameter{{.name = "diffuse",
                       .help = "Surface: Lambertian reflectance.",
                       .count = 3,
                       .defaultText = "0 0 0"},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, diffuse)},
                      {memberPlace<&M::diffuse>()}},
    MaterialParameter{{.name = "glossy",
                       .help = "Surface: reflectance of the Phong lobe at normal incidence; "
                               "mirror: reflectance.",
                       .count = 3,
                       .defaultText = "0 0 0"},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, glossy)},
                      {memberPlace<&M::glossy>()}},
    MaterialParameter{{.name = "glossyExponent",
                       .help = "Surface: exponent of the Phong lobe; mirror: 0 = perfect.",
                       .maximum = kNoEnd,
                       .defaultText = "0"},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, glossyExponent)},
                      {memberPlace<&M::glossyExponent>()}},
    MaterialParameter{{.name = "ior",
                       .help = "Dielectric: index of refraction against vacuum; 0 = "
                               "1.5.",
                       .maximum = kNoEnd,
                       .excludesMinimum = true,
                       .defaultText = "1.5",
                       .zeroMeans = 1.5},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, ior)},
                      {memberPlace<&M::ior>()}},
    MaterialParameter{{.name = "transmission",
                       .help = "Dielectric: tint at each transmission.",
                       .count = 3,
                       .defaultText = "0 0 0"},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, transmission)},
                      {memberPlace<&M::transmission>()}},
    MaterialParameter{{.name = "emission",
                       .help = "Radiance of the front.",
                       .count = 3,
                       .unit = "W m^-2 sr^-1",
                       .maximum = kNoEnd,
                       .defaultText = "0 0 0"},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, emission)},
                      {memberPlace<&M::emission>()}},
    MaterialParameter{{.name = "transparency",
                       .help = "Share of light that passes straight through (cut-outs); 0 = "
                               "opaque.",
                       .defaultText = "0"},
                      {Kind::kFloats, offsetof(PmrMaterialDesc, transparency)},
                      {memberPlace<&M::transparency>()}},
    MaterialParameter{
        {.name = "diffuseTexture", .help = "Multiplies diffuse.", .type = Type::kTexture},
        {Kind::kTexture, offsetof(PmrMaterialDesc, diffuseTexture)},
        {texturePlace<&M::diffuseTexture>()}},
    MaterialParameter{
        {.name = "glossyTexture", .help = "Multiplies glossy.", .type = Type::kTexture},
        {Kind::kTexture, offsetof(PmrMaterialDesc, glossyTexture)},
        {texturePlace<&M::glossyTexture>()}},
    MaterialParameter{{.name = "glossyExponentTexture",
                       .help = "Multiplies glossyExponent.",
                       .type = Type::kTexture},
                      {Kind::kTexture, offsetof(PmrMaterialDesc, glossyExponentTexture)},
                      {texturePlace<&M::glossyExponentTexture>()}},
    MaterialParameter{
        {.name = "transmissionTexture", .help = "Multiplies transmission.", .type = Type::kTexture},
        {Kind::kTexture, offsetof(PmrMaterialDesc, transmissionTexture)},
        {texturePlace<&M::transmissionTexture>()}},
    MaterialParameter{
        {.name = "emissionTexture", .help = "Multiplies emission.", .type = Type::kTexture},
        {Kind::kTexture, offsetof(PmrMaterialDesc, emissionTexture)},
        {texturePlace<&M::emissionTexture>()}},
    MaterialParameter{{.name = "opacityTexture",
                       .help = "Opacity is (1 - transparency) times it.",
                       .type = Type::kTexture},
                      {Kind::kTexture, offsetof(PmrMaterialDesc, opacityTexture)},
                      {texturePlace<&M::opacityTexture>()}},
    MaterialParameter{
        {.name = "name", .help = "For messages.", .type = Type::kText, .changesPixels = false},
        {Kind::kText, offsetof(PmrMaterialDesc, name)},
        {unseenPlace<&M::name>()}},
    MaterialParameter{{.name = "roughness",
                       .help = "In place of an exponent: the root of GGX's alpha. Surfaces then "
                               "have a coat that reflects the glossy colour at normal incidence "
                               "and all at grazing angles; mirrors and dielectrics below 0.01 are "
                               "smooth.",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::roughness>()}},
    MaterialParameter{{.name = "roughnessTexture",
                       .help = "Multiplies roughness.",
                       .type = Type::kTexture,
                       .isLater = true},
                      {},
                      {texturePlace<&M::roughnessTexture>()}},
    MaterialParameter{{.name = "conductorN",
                       .help = "Mirror: real part of a metal's index of refraction, where "
                               "conductorK isn't 0.",
                       .count = 3,
                       .maximum = 100,
                       .defaultText = "0 0 0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::conductorN>()}},
    MaterialParameter{{.name = "conductorK",
                       .help = "Mirror: its imaginary part; 0: the glossy colour is what it "
                               "reflects.",
                       .count = 3,
                       .maximum = 100,
                       .defaultText = "0 0 0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::conductorK>()}},
    MaterialParameter{
        {.name = "normalTexture",
         .help = "A normal map in tangent space, of meshes with texture coordinates: "
                 "red along u, green along v; 0 is 0.5 of floats, 128 of 8 bits, 32768 of 16 "
                 "bits.",
         .type = Type::kTexture,
         .isLater = true},
        {},
        {texturePlace<&M::normalTexture>()}},
    MaterialParameter{{.name = "normalScale",
                       .help = "How strong it is: a factor of what it says along the surface.",
                       .maximum = 100,
                       .defaultText = "1",
                       .isLater = true},
                      {},
                      {memberPlace<&M::normalScale>()}},
    MaterialParameter{
        {.name = "attenuationColour",
         .help = "Dielectric: what is left of light after attenuationDistance inside.",
         .count = 3,
         .defaultText = "1 1 1",
         .isLater = true},
        {},
        {memberPlace<&M::attenuationColour>()}},
    MaterialParameter{{.name = "attenuationDistance",
                       .help = "Dielectric: see attenuationColour; 0: nothing is absorbed inside.",
                       .unit = "scene units",
                       .maximum = kNoEnd,
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::attenuationDistance>()}},
    MaterialParameter{{.name = "diffuseRoughness",
                       .help = "Surface: of its diffuse part, as plaster or clay; 0: Lambertian.",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::diffuseRoughness>()}},
    MaterialParameter{{.name = "diffuseTransmission",
                       .help = "Surface without a glossy part: what it lets through to all sides, "
                               "as a leaf or a lampshade.",
                       .count = 3,
                       .defaultText = "0 0 0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::diffuseTransmission>()}},
    MaterialParameter{{.name = "coat",
                       .help = "A clear coat over all else: the share of it that it covers. Glass "
                               "below one is as rough as both together.",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::coat>()}},
    MaterialParameter{{.name = "coatRoughness",
                       .help = "Its roughness, as of all else.",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::coatRoughness>()}},
    MaterialParameter{{.name = "coatIor",
                       .help = "Its index of refraction.",
                       .minimum = 1,
                       .maximum = 10,
                       .defaultText = "1.5",
                       .isLater = true},
                      {},
                      {memberPlace<&M::coatIor>()}},
    MaterialParameter{{.name = "sheen",
                       .help = "Surface: what fibres that stand on it, as of velvet, reflect.",
                       .count = 3,
                       .defaultText = "0 0 0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::sheen>()}},
    MaterialParameter{{.name = "sheenRoughness",
                       .help = "How unlike they stand: smaller shines at grazing angles alone.",
                       .defaultText = "0.3",
                       .isLater = true},
                      {},
                      {memberPlace<&M::sheenRoughness>()}},
    MaterialParameter{{.name = "edgeTint",
                       .help = "Mirror: metal whose glossy colour is what it reflects at normal "
                               "incidence, with this tint at its edge; 0: none is given.",
                       .count = 3,
                       .defaultText = "0 0 0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::edgeTint>()}},
    MaterialParameter{{.name = "anisotropy",
                       .help = "Of the roughness of metals and of surfaces' glossy part: how much "
                               "longer highlights are along the tangent than across.",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::anisotropy>()}},
    MaterialParameter{{.name = "anisotropyRotation",
                       .help = "Turns it from the tangent towards the bitangent.",
                       .unit = "turns",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::anisotropyRotation>()}},
    MaterialParameter{{.name = "priority",
                       .help = "Dielectric: where bodies overlap, the one of the highest priority "
                               "is there; of equal ones that with the smaller box. Air in glass "
                               "is a body of index 1 with a priority.",
                       .type = Type::kInteger,
                       .minimum = -1000,
                       .maximum = 1000,
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::priority>()}},
    MaterialParameter{{.name = "thinWalled",
                       .help = "Dielectric: 1 = its surface is a thin pane, with nothing inside.",
                       .type = Type::kInteger,
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::thinWalled>()}},
    MaterialParameter{{.name = "bumpTexture",
                       .help = "Heights over the surface, of meshes with texture coordinates.",
                       .type = Type::kTexture,
                       .isLater = true},
                      {},
                      {texturePlace<&M::bumpTexture>()}},
    MaterialParameter{{.name = "bumpScale",
                       .help = "What a height of 1 is.",
                       .unit = "scene units",
                       .minimum = -1e6,
                       .maximum = 1e6,
                       .defaultText = "1",
                       .isLater = true},
                      {},
                      {memberPlace<&M::bumpScale>()}},
    MaterialParameter{{.name = "displacementTexture",
                       .help = "Heights by which the limit surfaces of cages with texture "
                               "coordinates are displaced along their normal.",
                       .type = Type::kTexture,
                       .isLater = true},
                      {},
                      {kDisplacement}},
    MaterialParameter{{.name = "displacementScale",
                       .help = "What a height of 1 is.",
                       .unit = "scene units",
                       .minimum = -1e6,
                       .maximum = 1e6,
                       .defaultText = "1",
                       .isLater = true},
                      {},
                      {kDisplacementScale}},
    MaterialParameter{{.name = "first",
                       .help = "Mixture: the name of one of its two materials, which was made "
                               "before. It may be a mixture.",
                       .type = Type::kText,
                       .isLater = true},
                      {},
                      {partPlace<&M::first>()}},
    MaterialParameter{{.name = "second",
                       .help = "Mixture: the name of the other.",
                       .type = Type::kText,
                       .isLater = true},
                      {},
                      {partPlace<&M::second>()}},
    MaterialParameter{{.name = "weight",
                       .help = "Mixture: share of the second.",
                       .defaultText = "0",
                       .isLater = true},
                      {},
                      {memberPlace<&M::weight>()}},
    MaterialParameter{{.name = "weightTexture",
                       .help = "Multiplies weight.",
                       .type = Type::kTexture,
                       .isLater = true},
                      {},
                      {texturePlace<&M::weightTexture>()}},
};

}  // namespace

std::span<const MaterialParameter> materialParameters() {
    return kMaterialRows;
}

}  // namespace pm::plugin
