// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon.h"
#include "integrator/photons/trace/photon_tracer.h"

namespace pm {

// Of the photons that are descended from caustics, those that have been refocused, in their order.
BigVector<Photon> refocusedOf(std::span<const Photon> descended);

// Those that glossy lobes received, as a pilot of radii takes them.
std::vector<Photon> photonsOf(std::span<const ReceivedPhoton> received);

// The second after the first. Works in parallel in the calling TBB arena.
BigVector<Photon> join(std::span<const Photon> first, std::span<const Photon> second);

// As one the two halves of a pilot, traced independently of each other; the photons of the second
// are marked. Each half is of all the light, so that both together have half of their flux.
PhotonTraceResult joinHalves(PhotonTraceResult first, PhotonTraceResult second);

}  // namespace pm
