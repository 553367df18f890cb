// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/colour/display_transform.h"
#include "host_shim/pictures/picture.h"

namespace pm::host {

struct DisplayResult {
    DisplayPicture picture;
    DisplayCleaning cleaning;
};

// The beauty (channels R, G, B and, where there is one, A) of a scene-linear picture as a display
// shows it; covers the data window. Without alpha the premultiplied colours go through the view as
// they are, that is over black; with it they are divided by A first, so alpha is straight.
// Errors: kInternal when R, G or B is missing.
DisplayResult makeDisplayPicture(const Picture& picture, const DisplayTransform& transform,
                                 bool withAlpha = false);

}  // namespace pm::host
