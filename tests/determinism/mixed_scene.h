// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>

namespace pm::host::test {

// Writes mixed.obj, mixed.mtl and checks.png to the folder: a box, open towards +z, with diffuse
// walls, a textured floor, a glossy back wall, a mirror wall, a glass ball and a lamp. What it
// holds takes every way through the integrator that a picture can take.
void writeMixedScene(const std::filesystem::path& folder);

}  // namespace pm::host::test
