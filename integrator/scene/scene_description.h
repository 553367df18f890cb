// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "integrator/cameras/camera_description.h"
#include "integrator/lights/light_kinds.h"
#include "integrator/materials/material_description.h"
#include "integrator/shapes/shape.h"
#include "integrator/values/ray.h"
#include "integrator/values/transform.h"

namespace pm {

// When a cage is cut into triangles: all of it before rays are traced, or each part of it where one
// meets it. kAuto: on demand what is displaced.
enum class TessellationTime { kAuto, kOnDemand, kWhole };

struct InstanceDescription {
    Shape shape;
    Transform transform = kIdentityTransform;
    std::vector<std::uint32_t> materials;  // index into SceneDescription::materials for each slot
    std::string name;
    std::uint32_t id = 0;
    Viewers hiddenFrom = 0;
    // Of a limit shape: pieces of every edge of its cage; 0: by the camera, or the cage's own rate
    // without one.
    std::uint32_t tessellationRate = 0;
    // For whoever makes a shape of a cage: which one.
    TessellationTime tessellation = TessellationTime::kAuto;
    // Set by the scene on a mesh that it has cut of this, as the camera asks: what the host gave.
    std::shared_ptr<const LimitShape> cutOf = nullptr;
};

struct SceneDescription {
    std::vector<MaterialDescription> materials;
    std::vector<InstanceDescription> instances;
    std::vector<LightDescription> lights;
    std::optional<EnvironmentDescription> environment;
    std::optional<CameraDescription> camera;
    std::shared_ptr<const TextureSource> textures;  // may be null when no material names one
    std::string renderingSpace = "linear Rec.709";
    std::array<double, 9> rgbToXyz{};
};

}  // namespace pm
