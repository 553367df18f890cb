// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// Cuts materials that have a diffuse picture and none of opacity by the alpha of the former, where
// it has one (all tiles of it have). Opens the pictures to look; one that can't be read is left as
// it is, for whoever reads it to tell.
void takeAlphaOfPictures(std::span<MaterialData> materials);

}  // namespace pm::host
