// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/scene/texture_source.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// Object to world, 3 x 4, row-major: p' = M[:, 0:3] p + M[:, 3].
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentityTransform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

enum class MaterialKind { kSurface, kMirror, kDielectric };

// A material as the host gives it: numbers, each multiplied by its texture where it has one.
// Units and ranges as PmrMaterialDesc in pm_plugin.h.
struct MaterialDescription {
    std::string name;
    MaterialKind kind = MaterialKind::kSurface;
    bool fresnelMirror = false;
    Rgb diffuse;
    Rgb glossy;
    float glossyExponent = 0.0f;
    float ior = 1.5f;
    Rgb transmission{1.0f};
    Rgb emission;
    float transparency = 0.0f;
    std::int32_t diffuseTexture = kNoTexture;
    std::int32_t glossyTexture = kNoTexture;
    std::int32_t glossyExponentTexture = kNoTexture;
    std::int32_t transmissionTexture = kNoTexture;
    std::int32_t emissionTexture = kNoTexture;
    std::int32_t opacityTexture = kNoTexture;
};

// Whether the material looks up a texture.
inline bool hasTexture(const MaterialDescription& material) {
    for (const std::int32_t texture :
         {material.diffuseTexture, material.glossyTexture, material.glossyExponentTexture,
          material.transmissionTexture, material.emissionTexture, material.opacityTexture})
        if (texture != kNoTexture) return true;
    return false;
}

// Whether light can leave the material in no other way than diffusely, whatever its textures.
inline bool isDiffuseAtMost(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && isBlack(material.glossy) &&
           material.transparency == 0.0f && material.opacityTexture == kNoTexture;
}

// Half of a Phong lobe's greatest value lies 10 degrees aside, or farther.
inline constexpr float kMostBroadExponent = 45.0f;

// Whether the material's Phong lobe, where it has one, is so broad that it casts no caustics: light
// that it scatters is found as diffuse light is. By the number alone, whatever its texture.
inline bool isBroad(const MaterialDescription& material) {
    return material.glossyExponent <= kMostBroadExponent;
}

// Whether light can leave the material in one direction, or two, like from a mirror or glass.
inline bool mayHaveDelta(const MaterialDescription& material) {
    return material.kind != MaterialKind::kSurface || material.transparency > 0.0f ||
           material.opacityTexture != kNoTexture;
}

// Whether the material lets some light straight on and scatters some, as half-transparent sheets
// do.
inline bool isSheet(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && mayHaveDelta(material) &&
           !isBlack(material.diffuse);
}

// Whether light that meets the material goes nowhere from there, whatever its textures.
inline bool isBlackBody(const MaterialDescription& material) {
    return isDiffuseAtMost(material) && isBlack(material.diffuse);
}

// An analytic sphere in object space; its front is outside. Under a transform it must stay a
// sphere: rotation, translation, uniform scale. Textures are latitude-longitude pictures: in object
// space their middle is towards +z, their right half towards +x, their upper edge at +y; so a
// camera that isn't turned sees the middle as it is.
struct SphereShape {
    Vec3d centre;
    double radius = 1.0;  // > 0, scene units
};

using Shape = std::variant<std::shared_ptr<const TriangleMesh>, SphereShape>;

// What an instance may be hidden from, as bits.
enum Viewer : std::uint32_t {
    kCamera = 1,      // rays from the camera, as far as they go straight on
    kShadow = 2,      // rays that ask whether a light is seen
    kReflection = 4,  // rays that leave surfaces, and photons
};

struct InstanceDescription {
    Shape shape;
    Transform transform = kIdentityTransform;
    std::vector<std::uint32_t> materials;  // index into SceneDescription::materials for each slot
    std::string name;
    std::uint32_t id = 0;
    std::uint32_t hiddenFrom = 0;  // a set of Viewer
};

// A light without area that shines equally in all directions.
struct PointLightDescription {
    Vec3d position;  // world
    Rgb intensity;   // W/sr
    std::string name;
};

// A light without area that shines into a cone.
struct SpotLightDescription {
    Vec3d position;          // world
    Vec3d direction;         // world, in which light travels along the cone's middle; not 0
    Rgb intensity;           // W/sr, inside the part where it does not fade
    double coneAngle = 0.5;  // half of the whole cone's, radians, in (0, pi]
    double coneFalloff = 0;  // radians of it over which light fades, in [0, coneAngle]
    std::string name;
};

// Light from infinitely far: parallel, or from an even disc.
struct DirectionalLightDescription {
    Vec3d direction;           // world, in which light travels from the disc's middle; not 0
    Rgb irradiance;            // W m^-2, of a surface that faces it
    double angularRadius = 0;  // of the disc, radians, in [0, pi/2]; next to 0 is parallel light
    std::string name;
};

// Light from infinitely far all around. See Environment for the picture's directions.
struct EnvironmentDescription {
    Rgb radiance;  // W m^-2 sr^-1; times the texture where there is one
    std::int32_t texture = kNoTexture;
    Transform toWorld = kIdentityTransform;  // a rotation; its translation means nothing
};

// A pinhole camera that looks along -z of its transform, +y up, +x right.
struct CameraDescription {
    Transform cameraToWorld = kIdentityTransform;
    double verticalFieldOfView = 0.7;  // radians, in (0, pi)
    double pixelAspect = 1.0;          // width of a pixel over its height
};

struct SceneDescription {
    std::vector<MaterialDescription> materials;
    std::vector<InstanceDescription> instances;
    std::vector<PointLightDescription> pointLights;
    std::vector<SpotLightDescription> spotLights;
    std::vector<DirectionalLightDescription> directionalLights;
    std::optional<EnvironmentDescription> environment;
    std::optional<CameraDescription> camera;
    std::shared_ptr<const TextureSource> textures;  // may be null when no material names one
    std::string renderingSpace = "linear Rec.709";
    std::array<double, 9> rgbToXyz{};
};

}  // namespace pm
