// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm {

class PhotonPaging;

// How maps of global, caustic and refocused photons are kept in pages.
struct MapPaging {
    PhotonPaging* pages = nullptr;  // null: maps are in memory
    float roomForSites = 1.0f;      // see IrradianceSites
    float shareOfWindow = 1.0f;     // of its pixels that are rendered here, in [0, 1]
};

}  // namespace pm
