// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "integrator/photons/big_array.h"
#include "integrator/photons/photon.h"

namespace pm {

// Of the photons that are descended from caustics, those that have been refocused, in their order.
std::vector<Photon> refocusedOf(std::span<const Photon> descended);

// The second after the first. Works in parallel in the calling TBB arena.
BigVector<Photon> join(std::span<const Photon> first, std::span<const Photon> second);

}  // namespace pm
