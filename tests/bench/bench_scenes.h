// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "tests/bench/neutral_scene.h"
#include "tests/integrator/scene_maker.h"

namespace pm::bench {

// One of the neutral scenes as the integrator takes it, without the C interface.
test::SceneMaker makeNeutralScene(const NeutralScene& scene);

// A Cornell-like box of 32 triangles: two boxes, an area light; the scene's centre is at the
// origin.
test::SceneMaker plainBox();
// The same with two analytic spheres on the boxes, mirror and glass.
test::SceneMaker boxWithSpheres();
// The same room with a bumpy ball of about a million triangles in place of boxes and spheres.
test::SceneMaker roomWithMesh();

}  // namespace pm::bench
