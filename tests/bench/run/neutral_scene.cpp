// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/neutral_scene.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "integrator/values/error.h"

namespace pm::bench {

namespace {

using nlohmann::json;

Vec3d point(const json& j) {
    return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

Rgb colour(const json& j) {
    return {j.at(0).get<float>(), j.at(1).get<float>(), j.at(2).get<float>()};
}

}  // namespace

NeutralScene readNeutralScene(const std::filesystem::path& file, const std::string& key) {
    std::ifstream in(file);
    if (!in) throw Error(Status::kIo, file.string() + ": can't be read");
    const json scene = json::parse(in).at(key);
    NeutralScene result;
    result.key = key;
    result.name = scene.at("name");
    result.size = scene.at("res");
    for (const auto& [name, rgb] : scene.at("mat").items()) result.reflectances[name] = colour(rgb);
    for (const json& quad : scene.at("quads"))
        result.quads.push_back(
            {quad.at(0), point(quad.at(1)), point(quad.at(2)), point(quad.at(3)), quad.at(4)});
    for (const json& sphere : scene.at("spheres"))
        result.spheres.push_back({sphere.at(0), point(sphere.at(1)), sphere.at(2), sphere.at(3)});
    const json& light = scene.at("light");
    result.lamp = {"lamp", point(light.at(0)), point(light.at(1)), point(light.at(2)), "lamp"};
    result.radiance = colour(scene.at("L"));
    const json& camera = scene.at("cam");
    result.camera = {point(camera.at("pos")), point(camera.at("look")), point(camera.at("up")),
                     camera.at("vfov")};
    return result;
}

CameraAxes axesOf(const NeutralCamera& camera) {
    const Vec3d back = normalize(camera.position - camera.lookAt);
    const Vec3d right = normalize(cross(camera.up, back));
    return {right, cross(back, right), back};
}

}  // namespace pm::bench
