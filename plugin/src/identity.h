// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/plan/plan.h"
#include "integrator/values/cancel_check.h"
#include "plugin/src/scene_textures.h"
#include "plugin/src/setting_values.h"

namespace pm::plugin {

// What makes two renders the same render: 128-bit checksums (XXH3) as 32 hexadecimal digits. They
// hold for one build on one byte order.

// One of the things that a render's pixels depend on: a name for people, and what it is, as a short
// text or as a checksum.
struct IdentityPart {
    std::string name, value;
    friend bool operator==(const IdentityPart&, const IdentityPart&) = default;
};
using Identity = std::vector<IdentityPart>;

// Instruction set, colour space, geometry, materials, texels, lights and camera. Errors:
// CallError(IO) when a texture can't be read again; Error(kCancelled) soon after cancel is set.
Identity sceneIdentity(const Scene& scene, const SceneTextures& textures,
                       const CancelCheck& cancel);

// Version and build, and every setting that changes pixels, but for the number of passes: a
// finished render may go on with more of them.
Identity settingsIdentity(const SettingValues& settings);

// Version, and all that the photons of a pass depend on: of the scene all but the camera, the seed,
// and of the plan how many photons there are. scene: sceneIdentity().
Identity photonIdentity(const Identity& scene, const SettingValues& settings, const Plan& plan);

// The very library: of one version there are as many as there are compilers.
Identity buildIdentity();

// The settings that pieces of a picture must share though no pixel depends on them: window and
// channels; and what the host says of itself (setting hostIdentity), a part a line, `name: value`.
Identity frameIdentity(const SettingValues& settings);

// Of sceneIdentity and settingsIdentity.
std::string identityHash(const Identity& identity);

// What differs, in words, as "geometry; setting seed (1 there, 2 here)"; empty where nothing does.
std::string differences(const Identity& there, const Identity& here);

}  // namespace pm::plugin
