// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/formats/scene_data.h"

namespace pm::host {

// options.reading, and the folder of the colour config that they name among what may be read.
ReadRules readRules(const Options& options);

// The sidecar that the command line reads: that of its scene, where there is one. Empty: none.
std::filesystem::path sidecarInUse(const Options& options);

// Reads the scene of the command line, by the reader of its kind, and its sidecar; interrupts end
// it. eye: the camera's place, where it is known. takes: see ReadRules. Errors: as
// SceneReader::read, readSidecarFile and addSidecar; kUsage for a --camera that is not there;
// Interrupted.
SceneData readScene(const Options& options, const WarningSink& warn,
                    const std::optional<std::array<double, 3>>& eye, const MemoryNote& takes = {});

// The camera that the scene describes and the command line means; null where there is none.
// Errors: kUsage for a --camera that is not there.
const CameraData* cameraInUse(const Options& options, const std::vector<CameraData>& cameras);

// Lines of --explain: which dialect was taken for each library, and why. Empty without libraries.
std::string explainMaterials(std::span<const MaterialFile> libraries);

}  // namespace pm::host
