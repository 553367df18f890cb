// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon.h"
#include "integrator/photons/trace/photon_tracer.h"

namespace pm {

// Those that glossy lobes received, as a pilot of radii takes them.
std::vector<Photon> photonsOf(std::span<const ReceivedPhoton> received);

// The second after the first. Works in parallel in the calling TBB arena.
BigVector<Photon> join(std::span<const Photon> first, std::span<const Photon> second);

// A pilot is traced in two halves, independently of each other; each is of all the light, so that
// both together have half of their flux. Halves that of a part; the photons of the second are
// marked.
void halve(PhotonTraceResult& part, bool isSecond);
// What becomes of the light of both.
PhotonBalance ofHalves(PhotonBalance first, const PhotonBalance& second);
// What a round gave, behind what those before it gave.
void append(PhotonTraceResult& all, PhotonTraceResult part);

}  // namespace pm
