// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <memory>

#include "integrator/scene/scene.h"
#include "plugin/parameters/scene_tables.h"
#include "plugin/textures/scene_textures.h"
#include "plugin/textures/texture_system.h"
#include "plugin/values/identity.h"

namespace pm::plugin {

// A committed scene with what renders need of it beside its light. A plain value; all of it is
// immutable.
struct RenderScene {
    std::shared_ptr<const Scene> scene;
    Identity identity;   // sceneIdentity()
    SceneTables tables;  // that it was read by
    std::shared_ptr<const SceneTextures> textures;
    std::shared_ptr<TextureSystem> textureSystem;  // that all textures are of
    double buildSeconds = 0;
    // Whether what renders plan is to be given up; never null.
    std::shared_ptr<const std::atomic<bool>> cancelPlans =
        std::make_shared<const std::atomic<bool>>(false);
};

}  // namespace pm::plugin
