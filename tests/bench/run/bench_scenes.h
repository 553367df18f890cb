// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "tests/bench/run/neutral_scene.h"
#include "tests/support/scene_maker.h"

namespace pm::bench {

// One of the neutral scenes as the integrator takes it, without the C interface.
test::SceneMaker makeNeutralScene(const NeutralScene& scene);

// Those of paper_scenes.h, likewise.
test::SceneMaker plainBox();
test::SceneMaker boxWithSpheres();
test::SceneMaker roomWithMesh();

}  // namespace pm::bench
