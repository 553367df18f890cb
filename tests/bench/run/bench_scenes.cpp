// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/bench_scenes.h"

#include <map>
#include <memory>
#include <utility>

#include "tests/bench/paper/paper_scenes.h"

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

void addMesh(test::SceneMaker& maker, const NeutralMesh& neutral, std::uint32_t material) {
    TriangleMesh mesh;
    mesh.positions = neutral.positions;
    mesh.triangles = neutral.triangles;
    mesh.materials.resize(mesh.triangles.size());
    mesh.faces.resize(mesh.triangles.size());
    InstanceDescription instance;
    instance.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    instance.materials = {material};
    maker.description.instances.push_back(std::move(instance));
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
    for (const NeutralMesh& mesh : scene.meshes) addMesh(maker, mesh, materials.at(mesh.material));
    maker.quad(scene.lamp.p, scene.lamp.e0, scene.lamp.e1, maker.diffuse({}, scene.radiance));
    const NeutralCamera& camera = scene.camera;
    maker.camera(camera.position, camera.lookAt, camera.up, camera.verticalDegrees);
    return maker;
}

test::SceneMaker plainBox() {
    return makeNeutralScene(neutralBox());
}

test::SceneMaker boxWithSpheres() {
    return makeNeutralScene(neutralBoxWithSpheres());
}

test::SceneMaker roomWithMesh() {
    return makeNeutralScene(neutralRoomWithMesh());
}

}  // namespace pm::bench
