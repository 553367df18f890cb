// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "tests/support/scene_maker.h"

namespace pm::test {

MaterialDescription glass(float ior = 1.5f);
// In a body of glass.
MaterialDescription air();
MaterialDescription mirror(float reflectance = 0.9f);

// A room of 2 x 2 x 2 around the origin, open towards the camera on +z: white, with a red wall on
// the left and a green one on the right. No lamp.
SceneMaker openRoom();
// A lamp under its ceiling that faces down, of side 2 * half.
void ceilingLamp(SceneMaker& maker, double half, Rgb radiance);

struct Room {
    std::string name;
    SceneMaker maker;
};

// For test names.
std::string roomName(const ::testing::TestParamInfo<Room>& info);
void PrintTo(const Room& room, std::ostream* out);

// Rooms that have every lobe between them, and every order of lobes that path tracing can find.
std::vector<Room> roomsOfEveryLobe();

}  // namespace pm::test
