// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/session_files.h"

#include "host_shim/pictures/picture_io.h"

#include <algorithm>
#include <array>
#include <utility>

namespace pm::host {

namespace fs = std::filesystem;

std::vector<fs::path> inputsOf(const Options& options, const SceneData* scene) {
    std::vector<fs::path> inputs = options.merge;
    if (!options.scene.empty()) inputs.push_back(options.scene);
    if (!options.reference.empty()) inputs.push_back(options.reference);
    if (!options.photonMap.empty() && !options.photonsOnly) inputs.push_back(options.photonMap);
    if (!options.colour.ocioFile.empty()) inputs.emplace_back(options.colour.ocioFile);
    if (scene == nullptr) return inputs;
    for (const MaterialFile& library : scene->materialFiles) inputs.emplace_back(library.file);
    for (const MaterialData& material : scene->materials) {
        for (const auto* use :
             {&material.diffuseTexture, &material.glossyTexture, &material.glossyExponentTexture,
              &material.transmissionTexture, &material.emissionTexture, &material.opacityTexture}) {
            if (*use) inputs.emplace_back((*use)->file);
        }
    }
    return inputs;
}

std::vector<fs::path> otherOutputs(const Options& options) {
    std::vector<fs::path> files;
    if (!options.statistics.empty() && options.statistics != "-") {
        files.emplace_back(options.statistics);
    }
    for (const fs::path& file : {options.log, options.report, options.part, options.checkpoint})
        if (!file.empty()) files.push_back(file);
    if (options.photonsOnly) files.push_back(options.photonMap);
    return files;
}

bool isDisplayReference(const Options& options) {
    constexpr std::array kEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff"};
    return std::ranges::find(kEndings, lowerCaseExtension(options.reference)) != kEndings.end();
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
