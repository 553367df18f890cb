// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/session/session_files.h"

#include <algorithm>
#include <utility>

#include "host_shim/formats/scene_reader.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/session/read_rules.h"

namespace pm::host {

namespace fs = std::filesystem;

std::vector<fs::path> inputsOf(const Options& options, const SceneData* scene) {
    std::vector<fs::path> inputs = options.merge;
    if (!options.scene.empty()) inputs.push_back(options.scene);
    if (fs::path file = sidecarInUse(options); !file.empty()) inputs.push_back(std::move(file));
    if (!options.reference.empty()) inputs.push_back(options.reference);
    if (!options.photonMap.empty() && !options.photonsOnly) inputs.push_back(options.photonMap);
    if (!options.colour.ocioFile.empty()) inputs.emplace_back(options.colour.ocioFile);
    if (scene == nullptr) return inputs;
    for (fs::path& file : filesOf(*scene)) inputs.push_back(std::move(file));
    return inputs;
}

std::vector<fs::path> otherOutputs(const Options& options) {
    std::vector<fs::path> files;
    if (!options.statistics.empty() && options.statistics != "-") {
        files.emplace_back(options.statistics);
    }
    for (const fs::path& file :
         {options.log, options.report, options.bucketTimes, options.part, options.checkpoint})
        if (!file.empty()) files.push_back(file);
    if (options.writeSidecar && sidecarInUse(options).empty())
        files.push_back(sidecarOf(options.scene));
    if (options.photonsOnly) files.push_back(options.photonMap);
    return files;
}

bool isDisplayReference(const Options& options) {
    return isDisplayPictureName(options.reference);
}

bool wantsDisplay(const Options& options) {
    return !options.report.empty() || isDisplayReference(options) ||
           std::ranges::any_of(options.outputs, [](const fs::path& file) {
               return isDisplayReferred(pictureFormat(file));
           });
}

std::vector<fs::path> allOutputs(const Options& options) {
    std::vector<fs::path> files = options.outputs;
    for (fs::path& file : otherOutputs(options)) files.push_back(std::move(file));
    return files;
}

}  // namespace pm::host
