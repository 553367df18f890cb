// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_files.h"
#include "host_shim/formats/sidecar/name_table.h"
#include "host_shim/values/go_on.h"

namespace pm::host {

// SCENE.pm.json: what stands beside a scene's own file and adds to it what that can't say. docs/
// sidecar.md is for who writes one, docs/sidecar.schema.json for programs.

// Where the sidecar of a scene is: SCENE.pm.json of SCENE.obj.
std::filesystem::path sidecarOf(const std::filesystem::path& scene);

// Groups of the scene in another place. Names are numbers of Sidecar::names.
struct SidecarInstance {
    std::uint32_t index{};                     // in the file's list, for messages
    std::uint32_t of{NameTable::kNone};        // the groups of this name; none: all of the scene
    std::uint32_t material{NameTable::kNone};  // of all slots; none: see materials
    std::uint32_t hiddenFrom{};
    std::string name;  // empty: that of each group
    std::optional<Transform> transform;
    // In place of which, which; ordered by the first.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> materials;
};

struct SidecarMaterial {
    std::string name;  // of one that the scene's material libraries have
    std::vector<NamedValue> values;
    Boxed<TextureUse> weightTexture;  // of a mixture
};

struct SidecarSphere {
    std::uint32_t material{};  // a number of Sidecar::names
    std::uint32_t hiddenFrom{};
    SphereData sphere;
    std::optional<Transform> transform;
};

// A sidecar as it was read and checked by itself; nothing of the scene is known yet.
struct Sidecar {
    std::string file;
    NameTable names;
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

// What reading a sidecar may take.
struct SidecarLimits {
    GoOn goOn;                    // called again and again; what it throws ends the reading
    std::uint64_t memoryBytes{};  // that --memory-limit allows; 0: nothing was said
};

// The most instances of a scene.
inline constexpr std::size_t kMostInstances = std::size_t{16} << 20;

// file: for messages. Names of pictures begin in the scene's folder, where files looks. In time and
// memory that grow as the text does.
// Errors: kBadInput, "FILE: PLACE is VALUE; what is allowed", those of JsonBudget, what goOn
// throws.
Sidecar readSidecar(std::string_view text, const std::string& file, SceneFiles& files,
                    const SidecarLimits& limits = {});

// The same of a file. Errors: kFile when it can't be read; kBadInput also for more than 2 GiB.
Sidecar readSidecarFile(const std::filesystem::path& file, SceneFiles& files,
                        const SidecarLimits& limits = {});

// Adds what it says to the scene that it stands beside. Groups that an instance names are placed by
// instances alone. Errors: kBadInput for groups and materials that the scene has not, and for more
// than 16 million instances; those of JsonBudget, what goOn throws.
void addSidecar(const Sidecar& sidecar, SceneData& scene, const SidecarLimits& limits = {});

// What was found for a scene of which nobody had said it.
struct SidecarGuess {
    std::optional<CameraData> camera;
    std::optional<LightData> light;
};

// The text of a sidecar with a guess added to what it was before (empty: there was none). A camera
// is added only where there is none. before has been read without a fault.
std::string withGuess(std::string_view before, const SidecarGuess& guess);

}  // namespace pm::host
