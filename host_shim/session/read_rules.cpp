// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/session/read_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "host_shim/formats/all/scene_readers.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/formats/sidecar/sidecar_parts.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/render/picture_alpha.h"
#include "host_shim/render/scene_memory.h"

namespace pm::host {

namespace fs = std::filesystem;

ReadRules readRules(const Options& options) {
    ReadRules rules = options.reading;
    rules.threads = options.threads;
    rules.size = {options.width, options.height};
    rules.pov.say = [](const std::string& text) { std::fputs(text.c_str(), stderr); };
    std::string config = options.colour.ocioFile;
    if (const char* const variable = std::getenv("OCIO"); config.empty() && variable != nullptr)
        config = variable;
    std::error_code ignored;
    if (!config.empty() && fs::is_regular_file(config, ignored))
        rules.files.alsoAllowed.push_back(fs::path(config).parent_path());
    return rules;
}

fs::path sidecarInUse(const Options& options) {
    if (options.noSidecar || options.scene.empty()) return {};
    const fs::path file = sidecarOf(options.scene);
    std::error_code ignored;
    return fs::exists(file, ignored) ? file : fs::path();
}

const CameraData* cameraInUse(const Options& options, const std::vector<CameraData>& cameras) {
    if (options.cameraName.empty()) return cameras.empty() ? nullptr : &cameras.front();
    std::string names;
    for (const CameraData& camera : cameras) {
        if (camera.name == options.cameraName) return &camera;
        names += (names.empty() ? "" : ", ") + camera.name;
    }
    throw HostError(ExitCode::kUsage,
                    fmt::format("--camera '{}': {}", options.cameraName,
                                names.empty() ? "no sidecar of the scene describes a camera"
                                              : "the cameras of the scene are " + names));
}

namespace {

// The command line's in place of the scene's.
void addSky(const SkyOptions& asked, SceneData& scene) {
    if (!asked.environment.empty()) {
        checkSceneFile(asked.environment, "a picture");
        scene.sky.reset();
        EnvironmentData& environment = scene.environment.emplace();
        environment.texture.emplace();
        environment.texture->file = asked.environment.string();
        environment.texture->place = "--environment";
        environment.radiance.fill(static_cast<float>(asked.strength.value_or(1)));
        if (asked.rotation) environment.transform = rotationOf({0, *asked.rotation, 0});
    } else if (asked.sun) {
        scene.environment.reset();
        scene.sky = {(*asked.sun)[0], (*asked.sun)[1],
                     asked.turbidity.value_or(SkyData{}.turbidity), asked.strength.value_or(1),
                     false};
    }
}

// A material that has both keeps both.
void takeBumpAsNormal(std::vector<MaterialData>& materials) {
    constexpr float kMost = 100.0f;
    for (MaterialData& material : materials)
        if (material.bumpTexture && !material.normalTexture) {
            std::swap(material.bumpTexture, material.normalTexture);
            float& strength = material.normalTexture->strength;
            strength = std::clamp(strength, 0.0f, kMost);
        }
}

}  // namespace

SceneData readScene(const Options& options, const WarningSink& warn,
                    const std::optional<std::array<double, 3>>& eye, const MemoryNote& takes) {
    ReadRules rules = readRules(options);
    rules.takes = takes;
    const GoOn goOn = throwIfInterrupted;
    const std::uint64_t room = memoryForText(options);
    const SidecarLimits limits{goOn, room == 0 ? 0 : std::max(room, kTellingBytes)};
    std::optional<Sidecar> sidecar;
    if (const fs::path file = sidecarInUse(options); !file.empty()) {
        SceneFiles files(options.scene.parent_path(), rules.files);
        sidecar = readSidecarFile(file, files, limits);
        rules.materials = sidecar->materialNames();
    }
    const CameraData* camera =
        cameraInUse(options, sidecar ? sidecar->cameras : std::vector<CameraData>{});
    std::optional<std::array<double, 3>> place = eye;
    if (!place && camera != nullptr) place = placeOf(*camera);
    SceneData scene = sceneReaderFor(options.scene).read({options.scene, warn, goOn, place, rules});
    if (sidecar) addSidecar(*sidecar, scene, limits);
    addSky(options.sky, scene);
    if (options.bumpIsNormal) takeBumpAsNormal(scene.materials);
    if (options.alphaOfPictures) takeAlphaOfPictures(scene.materials);
    return scene;
}

std::string explainMaterials(std::span<const MaterialFile> libraries) {
    std::string text;
    for (const MaterialFile& library : libraries)
        text += fmt::format("materials: {} is read as {}, since {}\n", library.file,
                            library.dialect, library.reason);
    return text;
}

}  // namespace pm::host
