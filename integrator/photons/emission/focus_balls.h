// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "integrator/photons/emission/aim_cone.h"
#include "integrator/photons/emission/focus.h"

namespace pm {

// Balls around a focus as casters to aim at, each twice as wide as the one before: as many as it
// takes to hold the scene, at most kMostCasters. Not for a focus that is everywhere.
std::vector<Caster> ballsAround(const Focus& focus, double sceneRadius);

// Those of them that a wider caster reaches into, at most kMostBalls, if one is much wider than the
// first; none of a focus that is everywhere.
std::vector<Caster> ballsInside(std::span<const Caster> casters, const Focus& focus);

}  // namespace pm
