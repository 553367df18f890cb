// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <string>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Warns where the materials of a scene together would show nothing: all fully transparent, all
// glass that bends nothing, or all black. sceneName is for messages.
void warnOfUnlikelyMaterials(std::span<const MaterialData> materials, const std::string& sceneName,
                             const WarningSink& warn);

}  // namespace pm::host
