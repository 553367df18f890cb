// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>

#include "integrator/scene/scene.h"
#include "plugin/textures/scene_textures.h"
#include "plugin/textures/texture_system.h"
#include "plugin/values/identity.h"

namespace pm::plugin {

// A committed scene with what renders need of it beside its light. A plain value; all of it is
// immutable.
struct RenderScene {
    std::shared_ptr<const Scene> scene;
    Identity identity;  // sceneIdentity()
    std::shared_ptr<const SceneTextures> textures;
    std::shared_ptr<TextureSystem> textureSystem;  // that all textures are of
    double buildSeconds = 0;
};

}  // namespace pm::plugin
