// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>

#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/formats/sidecar/sidecar_parts.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;

std::uint32_t readHiddenFrom(const JsonPlace& at) {
    std::uint32_t bits = 0;
    for (const JsonPlace& word : at.entriesOf("hiddenFrom")) {
        constexpr std::uint32_t kBits[] = {kHiddenFromCamera, kHiddenFromShadow,
                                           kHiddenFromReflection};
        bits |= kBits[word.choice({"camera", "shadow", "reflection"})];
    }
    return bits;
}

SidecarInstance readInstance(const JsonPlace& at) {
    at.allowKeys(
        {"of", "name", "matrix", "translate", "rotate", "scale", "materials", "hiddenFrom"});
    SidecarInstance instance;
    instance.place = at.path();
    if (at.has("of")) instance.of = at.member("of").text();
    if (at.has("name")) instance.name = at.member("name").text();
    instance.transform = readPlacement(at);
    instance.hiddenFrom = readHiddenFrom(at);
    if (!at.has("materials")) return instance;
    const JsonPlace materials = at.member("materials");
    if (materials.isText()) {
        instance.material = materials.text();
    } else if (materials.isObject()) {
        for (const auto& [old, name] : materials.members())
            instance.materials.emplace_back(old, name.text());
    } else {
        materials.refuse(
            " must be the name of a material, or an object with names in place of names");
    }
    return instance;
}

SidecarSphere readSphere(const JsonPlace& at) {
    at.allowKeys({"name", "centre", "radius", "material", "matrix", "translate", "rotate", "scale",
                  "hiddenFrom"});
    SidecarSphere sphere;
    sphere.place = at.path();
    sphere.sphere.name = at.has("name") ? at.member("name").text() : at.path();
    if (at.has("centre")) sphere.sphere.centre = at.member("centre").triple();
    sphere.sphere.radius = at.member("radius").number({0, 1e30, false, true, "scene units"});
    sphere.material = at.member("material").text();
    sphere.transform = readPlacement(at);
    sphere.hiddenFrom = readHiddenFrom(at);
    return sphere;
}

SidecarMaterial readMaterial(const std::string& name, const JsonPlace& at) {
    SidecarMaterial material;
    material.place = at.path();
    material.name = name;
    for (const auto& [key, value] : at.members()) {
        NamedValue& named = material.values.emplace_back();
        named.name = key;
        named.place = fmt::format("{}: {}", value.file(), value.path());
        if (value.isText())
            named.text = value.text();
        else if (value.isNumber())
            named.numbers = {value.number()};
        else
            for (const JsonPlace& entry : value.entries()) named.numbers.push_back(entry.number());
    }
    return material;
}

TextureUse readPicture(const JsonPlace& at, SceneFiles& files) {
    const std::string name = at.text();
    const auto file = files.find(files.folder(), name);
    if (!file) at.refuse(": " + files.whyNone(files.folder(), name));
    TextureUse use;
    use.file = file->string();
    use.place = fmt::format("{}: {}", at.file(), at.path());
    return use;
}

EnvironmentData readEnvironment(const JsonPlace& at, SceneFiles& files) {
    at.allowKeys({"radiance", "texture", "rotate", "matrix"});
    EnvironmentData environment;
    if (at.has("texture")) environment.texture = readPicture(at.member("texture"), files);
    environment.radiance = {1, 1, 1};
    if (at.has("radiance") || !environment.texture) {
        const auto value = at.member("radiance")
                               .oneOrThree({0, std::numeric_limits<float>::max(), true, true, ""});
        for (std::size_t i = 0; i < 3; ++i) environment.radiance[i] = static_cast<float>(value[i]);
    }
    if (at.has("rotate") && at.has("matrix"))
        at.refuse(" has rotate and matrix; it is one of them");
    if (at.has("rotate")) environment.transform = rotationOf(at.member("rotate").triple());
    if (at.has("matrix")) environment.transform = readRotation(at.member("matrix"));
    return environment;
}

SkyData readSky(const JsonPlace& at) {
    at.allowKeys({"azimuth", "elevation", "turbidity", "strength"});
    SkyData sky;
    sky.azimuth = at.member("azimuth").number({-360, 360, true, true, "degrees"});
    sky.elevation = at.member("elevation").number({0, 90, false, true, "degrees"});
    if (at.has("turbidity"))
        sky.turbidity = at.member("turbidity").number({1.7, 10, true, true, ""});
    if (at.has("strength")) sky.strength = at.member("strength").number({0, 1e6, true, true, ""});
    return sky;
}

}  // namespace

fs::path sidecarOf(const fs::path& scene) {
    fs::path file = scene;
    return file.replace_extension(".pm.json");
}

std::vector<std::string> Sidecar::materialNames() const {
    std::vector<std::string> names;
    for (const SidecarInstance& instance : instances) {
        if (!instance.material.empty()) names.push_back(instance.material);
        for (const auto& [old, name] : instance.materials) names.push_back(name);
    }
    for (const SidecarSphere& sphere : spheres) names.push_back(sphere.material);
    for (const SidecarMaterial& material : materials) names.push_back(material.name);
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

Sidecar readSidecar(std::string_view text, const std::string& file, SceneFiles& files) {
    const nlohmann::ordered_json json = parseJson(text, file);
    const JsonPlace all(json, file);
    all.allowKeys({"$schema", "schema", "instances", "spheres", "materials", "lights",
                   "environment", "sky", "cameras"});
    all.member("schema").choice({kSidecarSchema});
    Sidecar sidecar;
    sidecar.file = file;
    for (const JsonPlace& at : all.entriesOf("instances"))
        sidecar.instances.push_back(readInstance(at));
    for (const JsonPlace& at : all.entriesOf("spheres")) sidecar.spheres.push_back(readSphere(at));
    if (all.has("materials"))
        for (const auto& [name, at] : all.member("materials").members())
            sidecar.materials.push_back(readMaterial(name, at));
    for (const JsonPlace& at : all.entriesOf("lights")) sidecar.lights.push_back(readLight(at));
    if (all.has("environment") && all.has("sky"))
        all.refuse(" has environment and sky; it is one of them");
    if (all.has("sky")) sidecar.sky = readSky(all.member("sky"));
    if (all.has("environment"))
        sidecar.environment = readEnvironment(all.member("environment"), files);
    for (const JsonPlace& at : all.entriesOf("cameras")) {
        CameraData camera = readCamera(at);
        if (std::ranges::any_of(sidecar.cameras,
                                [&](const CameraData& other) { return other.name == camera.name; }))
            at.refuse(fmt::format(" is named '{}' like one before it", camera.name));
        sidecar.cameras.push_back(std::move(camera));
    }
    return sidecar;
}

Sidecar readSidecarFile(const fs::path& file, SceneFiles& files) {
    std::error_code unknown;
    const auto bytes = fs::file_size(file, unknown);
    if (!unknown && bytes > kMostBytes)
        throw HostError(ExitCode::kBadInput, fmt::format("{}: has {} bytes; at most {} are read",
                                                         file.string(), bytes, kMostBytes));
    return readSidecar(readWholeFile(file), file.string(), files);
}

}  // namespace pm::host
