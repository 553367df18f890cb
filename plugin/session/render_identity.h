// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/scene/scene.h"
#include "integrator/transport/plan/plan.h"
#include "integrator/values/cancel_check.h"
#include "plugin/parameters/scene_tables.h"
#include "plugin/session/setting_values.h"
#include "plugin/textures/scene_textures.h"
#include "plugin/values/identity.h"

namespace pm::plugin {

// Instruction set, colour space, geometry, materials, texels, lights and camera, of what is
// described all rows of the tables. Errors:
// CallError(IO) when a texture can't be read again; Error(kCancelled) soon after cancel is set.
Identity sceneIdentity(const Scene& scene, const SceneTextures& textures, const SceneTables& tables,
                       const CancelCheck& cancel);

// A checksum of each thing that a scene is made of: "object NAME", "material NAME", "light NAME",
// "environment", "camera", "texture FILE". Of several of one name all in one. What an object is
// made of counts for it by the materials' names, and for a material the texels that it looks up.
Identity sceneInputs(const Scene& scene, const SceneTextures& textures, const SceneTables& tables);

// Version and build, and every setting that changes pixels, but for the number of passes: a
// finished render may go on with more of them.
Identity settingsIdentity(const SettingValues& settings);

// Version, and all that the photons of a pass depend on: of the scene all but the camera, the seed,
// and of the plan how many photons there are. scene: sceneIdentity().
Identity photonIdentity(const Identity& scene, const SettingValues& settings, const Plan& plan);

// The settings that pieces of a picture must share though no pixel depends on them: window and
// channels; and what the host says of itself (setting hostIdentity), a part a line, `name: value`.
Identity frameIdentity(const SettingValues& settings);

}  // namespace pm::plugin
