// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "integrator/lights/light_kinds.h"
#include "integrator/materials/material_description.h"
#include "integrator/rays/ray.h"
#include "integrator/shapes/shape.h"
#include "integrator/values/transform.h"

namespace pm {

struct InstanceDescription {
    Shape shape;
    Transform transform = kIdentityTransform;
    std::vector<std::uint32_t> materials;  // index into SceneDescription::materials for each slot
    std::string name;
    std::uint32_t id = 0;
    Viewers hiddenFrom = 0;
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
    std::vector<LightDescription> lights;
    std::optional<EnvironmentDescription> environment;
    std::optional<CameraDescription> camera;
    std::shared_ptr<const TextureSource> textures;  // may be null when no material names one
    std::string renderingSpace = "linear Rec.709";
    std::array<double, 9> rgbToXyz{};
};

}  // namespace pm
