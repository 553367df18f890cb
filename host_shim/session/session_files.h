// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/formats/scene_data.h"

namespace pm::host {

// The files that a command line reads; of the scene (null: not read yet) those that it names.
std::vector<std::filesystem::path> inputsOf(const Options& options, const SceneData* scene);

// The files that it writes and that are no pictures: statistics, log, report, part,
// checkpoint, sidecar.
std::vector<std::filesystem::path> otherOutputs(const Options& options);

// Whether --reference names a display picture, by its extension; an EXR has any other.
bool isDisplayReference(const Options& options);

// Whether something that it writes or compares goes through display and view.
bool wantsDisplay(const Options& options);

// All files that it writes.
std::vector<std::filesystem::path> allOutputs(const Options& options);

}  // namespace pm::host
