// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

#include "integrator/scene/scene.h"
#include "plugin/src/scene_textures.h"
#include "plugin/src/setting_values.h"

namespace pm::plugin {

// What makes two renders the same render: 128-bit checksums (XXH3) as 32 hexadecimal digits. They
// hold for one build on one byte order.

// Geometry, materials, texels, lights, camera, colour space and instruction set. Errors:
// CallError(IO) when a texture can't be read again.
std::string sceneHash(const Scene& scene, const SceneTextures& textures);

// Version and build, and every setting that changes pixels, but for the number of passes: a
// finished render may go on with more of them.
std::string settingsHash(const SettingValues& settings);

}  // namespace pm::plugin
