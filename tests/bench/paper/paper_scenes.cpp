// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/paper/paper_scenes.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace pm::bench {

namespace {

// Five walls around the origin, from -1 to 1, open towards +z, and a light under the ceiling.
NeutralScene emptyRoom() {
    NeutralScene room;
    room.size = 256;
    room.reflectances = {{"white", {0.725f, 0.71f, 0.68f}},
                         {"red", {0.63f, 0.065f, 0.05f}},
                         {"green", {0.14f, 0.45f, 0.091f}}};
    room.quads = {{"floor", {-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, "white"},
                  {"ceiling", {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, "white"},
                  {"back", {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, "white"},
                  {"left", {-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, "red"},
                  {"right", {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, "green"}};
    room.lamp = {"lamp", {-0.25, 0.99, -0.25}, {0.5, 0, 0}, {0, 0, 0.5}, "lamp"};
    room.radiance = {30, 24, 12};
    room.camera = {{0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37};
    return room;
}

// Four sides and a top, standing on the floor, turned about the vertical.
void addStandingBox(NeutralScene& scene, Vec3d centre, double height, double degrees) {
    const double a = degrees * std::numbers::pi / 180, h = 0.3;
    const Vec3d x{2 * h * std::cos(a), 0, -2 * h * std::sin(a)};
    const Vec3d z{2 * h * std::sin(a), 0, 2 * h * std::cos(a)};
    const Vec3d y{0, height, 0};
    const Vec3d p = centre - x * 0.5 - z * 0.5;
    scene.quads.push_back({"top", p + z + y, x, -z, "white"});
    scene.quads.push_back({"front", p + z, x, y, "white"});
    scene.quads.push_back({"right", p + z + x, -z, y, "white"});
    scene.quads.push_back({"back", p + x, -x, y, "white"});
    scene.quads.push_back({"left", p, z, y, "white"});
}

// 2 x rings x 2 rings triangles, but for the two caps; flat ones.
NeutralMesh bumpyBall(Vec3d centre, double radius, int rings) {
    NeutralMesh mesh{"ball", {}, {}, "white"};
    const int segments = 2 * rings;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i < segments; ++i) {
            const double theta = std::numbers::pi * j / rings;
            const double phi = 2 * std::numbers::pi * i / segments;
            const Vec3d up{std::sin(theta) * std::cos(phi), std::cos(theta),
                           std::sin(theta) * std::sin(phi)};
            const Vec3f n(up);
            const float bump = std::sin(23 * n.x) * std::sin(19 * n.y) * std::sin(29 * n.z);
            mesh.positions.push_back(Vec3f(centre + up * radius) + n * (0.08f * bump));
        }
    const auto at = [&](int j, int i) {
        return static_cast<std::uint32_t>(j * segments + i % segments);
    };
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < segments; ++i) {
            if (j > 0) mesh.triangles.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1)});
            if (j < rings - 1) mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j + 1, i)});
        }
    return mesh;
}

// The most complex: a million triangles, caustics of glass and mirror beside them.
NeutralScene roomWithMeshAndSpheres() {
    NeutralScene room = neutralRoomWithMesh();
    room.spheres = {{"glass", {0.68, -0.7, 0.62}, 0.28, "glass"},
                    {"mirror", {-0.68, -0.7, 0.62}, 0.28, "mirror"}};
    return room;
}

}  // namespace

NeutralScene neutralBox() {
    NeutralScene box = emptyRoom();
    addStandingBox(box, {0.36, -1, 0.36}, 0.6, 17);
    addStandingBox(box, {-0.36, -1, -0.28}, 1.2, -18);
    return box;
}

NeutralScene neutralBoxWithSpheres() {
    NeutralScene box = neutralBox();
    box.spheres = {{"glass", {0.36, -0.15, 0.36}, 0.25, "glass"},
                   {"mirror", {-0.36, 0.45, -0.28}, 0.25, "mirror"}};
    return box;
}

NeutralScene neutralRoomWithMesh() {
    NeutralScene room = emptyRoom();
    room.meshes.push_back(bumpyBall({0, -0.2, 0}, 0.7, 500));
    return room;
}

std::vector<PaperScene> paperScenes() {
    return {{"scene-1", "box of 32 triangles, all diffuse", neutralBox(), 48, 88, 0.6},
            {"scene-2", "the same box with a glass and a mirror sphere", neutralBoxWithSpheres(),
             136, 96, 0.6},
            {"scene-3", "room with a million triangles, a glass and a mirror sphere",
             roomWithMeshAndSpheres(), 160, 160, 0.6}};
}

}  // namespace pm::bench
