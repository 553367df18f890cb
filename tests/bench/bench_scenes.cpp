// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/bench_scenes.h"

#include <cmath>
#include <map>
#include <numbers>

namespace pm::bench {

namespace {

std::uint32_t addMirror(test::SceneMaker& maker) {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = Rgb(1.0f);
    return maker.material(m);
}

std::uint32_t addGlass(test::SceneMaker& maker) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.ior = 1.5f;
    return maker.material(m);
}

// Five walls around the origin, from -1 to 1, open towards +z, and a light under the ceiling.
std::uint32_t addRoom(test::SceneMaker& maker) {
    const auto white = maker.diffuse({0.725f, 0.71f, 0.68f});
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, white);
    maker.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);
    maker.quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, maker.diffuse({0.63f, 0.065f, 0.05f}));
    maker.quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, maker.diffuse({0.14f, 0.45f, 0.091f}));
    maker.quad({-0.25, 0.99, -0.25}, {0.5, 0, 0}, {0, 0, 0.5}, maker.diffuse({}, {30, 24, 12}));
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    return white;
}

// Four sides and a top, standing on the floor, turned about the vertical.
void addStandingBox(test::SceneMaker& maker, Vec3d centre, double height, double degrees,
                    std::uint32_t material) {
    const double a = degrees * std::numbers::pi / 180, h = 0.3;
    const Vec3d x{2 * h * std::cos(a), 0, -2 * h * std::sin(a)};
    const Vec3d z{2 * h * std::sin(a), 0, 2 * h * std::cos(a)};
    const Vec3d y{0, height, 0};
    const Vec3d p = centre - x * 0.5 - z * 0.5;
    maker.quad(p + z + y, x, -z, material);
    maker.quad(p + z, x, y, material);
    maker.quad(p + z + x, -z, y, material);
    maker.quad(p + x, -x, y, material);
    maker.quad(p, z, y, material);
}

}  // namespace

test::SceneMaker makeNeutralScene(const NeutralScene& scene) {
    test::SceneMaker maker;
    std::map<std::string, std::uint32_t> materials = {{"mirror", addMirror(maker)},
                                                      {"glass", addGlass(maker)}};
    for (const auto& [name, rgb] : scene.reflectances) materials[name] = maker.diffuse(rgb);
    for (const NeutralQuad& quad : scene.quads)
        maker.quad(quad.p, quad.e0, quad.e1, materials.at(quad.material));
    for (const NeutralSphere& sphere : scene.spheres)
        maker.sphere(sphere.centre, sphere.radius, materials.at(sphere.material));
    maker.quad(scene.lamp.p, scene.lamp.e0, scene.lamp.e1, maker.diffuse({}, scene.radiance));
    const NeutralCamera& camera = scene.camera;
    maker.camera(camera.position, camera.lookAt, camera.up, camera.verticalDegrees);
    return maker;
}

test::SceneMaker plainBox() {
    test::SceneMaker maker;
    const auto white = addRoom(maker);
    addStandingBox(maker, {0.36, -1, 0.36}, 0.6, 17, white);
    addStandingBox(maker, {-0.36, -1, -0.28}, 1.2, -18, white);
    return maker;
}

test::SceneMaker boxWithSpheres() {
    test::SceneMaker maker = plainBox();
    maker.sphere({0.36, -0.15, 0.36}, 0.25, addGlass(maker));
    maker.sphere({-0.36, 0.45, -0.28}, 0.25, addMirror(maker));
    return maker;
}

test::SceneMaker roomWithMesh() {
    test::SceneMaker maker;
    const auto white = addRoom(maker);
    // 2 x 500 x 1000 triangles, but for the two caps.
    maker.meshSphere({0, -0.2, 0}, 0.7, white, false, 500);
    auto& shape = maker.description.instances.back().shape;
    TriangleMesh mesh = *std::get<std::shared_ptr<const TriangleMesh>>(shape);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3f n = mesh.normals[i];
        const float bump = std::sin(23 * n.x) * std::sin(19 * n.y) * std::sin(29 * n.z);
        mesh.positions[i] += n * (0.08f * bump);
    }
    // Flat triangles: what bounces off them must not see the ball's smooth normals.
    mesh.normals.clear();
    mesh.normalIndices.clear();
    shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    return maker;
}

}  // namespace pm::bench
