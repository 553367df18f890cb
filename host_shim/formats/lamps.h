// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Warns of each group and material that emits of which no face has an area: it gives no light.
// sceneName is for messages.
void warnOfLampsWithoutArea(const SceneData& scene, const std::string& sceneName,
                            const WarningSink& warn);

// Gives faces that emit from both sides a back: a mesh of its own of the same faces turned round,
// behind them by 2e-5 of the scene's diagonal. Not where the group is closed, as a bulb, whose
// inside nobody sees, nor where it is a cage with tags.
void addBackSides(SceneData& scene);

}  // namespace pm::host
