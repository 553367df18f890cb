// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_files.h"

namespace pm::host {

// SCENE.pm.json: what stands beside a scene's own file and adds to it what that can't say. docs/
// sidecar.md is for who writes one, docs/sidecar.schema.json for programs.

// Where the sidecar of a scene is: SCENE.pm.json of SCENE.obj.
std::filesystem::path sidecarOf(const std::filesystem::path& scene);

// Groups of the scene in another place.
struct SidecarInstance {
    std::string place;                // in the file, for messages
    std::string of;                   // the groups of this name; empty: all of the scene
    std::optional<std::string> name;  // none: that of each group
    std::optional<Transform> transform;
    std::string material;  // of all slots; empty: see materials
    std::vector<std::pair<std::string, std::string>> materials;  // in place of which, which
    std::uint32_t hiddenFrom{};
};

struct SidecarMaterial {
    std::string place;
    std::string name;  // of one that the scene's material libraries have
    std::vector<NamedValue> values;
};

struct SidecarSphere {
    std::string place;
    SphereData sphere;
    std::string material;
    std::optional<Transform> transform;
    std::uint32_t hiddenFrom{};
};

// A sidecar as it was read and checked by itself; nothing of the scene is known yet.
struct Sidecar {
    std::string file;
    std::vector<SidecarInstance> instances;
    std::vector<SidecarSphere> spheres;
    std::vector<SidecarMaterial> materials;
    std::vector<LightData> lights;
    std::optional<EnvironmentData> environment;
    std::optional<SkyData> sky;
    std::vector<CameraData> cameras;

    // Names of materials that it puts on something.
    std::vector<std::string> materialNames() const;
};

// file: for messages. Names of pictures begin in the scene's folder, where files looks.
// Errors: kBadInput, "FILE: PLACE is VALUE; what is allowed".
Sidecar readSidecar(std::string_view text, const std::string& file, SceneFiles& files);

// The same of a file. Errors: kFile when it can't be read; kBadInput also for more than 64 MiB.
Sidecar readSidecarFile(const std::filesystem::path& file, SceneFiles& files);

// Adds what it says to the scene that it stands beside. Groups that an instance names are placed by
// instances alone. Errors: kBadInput for groups and materials that the scene has not, and for more
// than 16 million instances.
void addSidecar(const Sidecar& sidecar, SceneData& scene);

// What was found for a scene of which nobody had said it.
struct SidecarGuess {
    std::optional<CameraData> camera;
    std::optional<LightData> light;
};

// The text of a sidecar with a guess added to what it was before (empty: there was none). A camera
// is added only where there is none. before has been read without a fault.
std::string withGuess(std::string_view before, const SidecarGuess& guess);

}  // namespace pm::host
