// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_reader.h"

namespace pm::host {

std::vector<std::filesystem::path> filesOf(const SceneData& scene) {
    std::vector<std::filesystem::path> files;
    for (const MaterialFile& library : scene.materialFiles) files.emplace_back(library.file);
    for (const std::string& file : scene.files) files.emplace_back(file);
    for (const MaterialData& material : scene.materials) {
        for (const auto* use :
             {&material.diffuseTexture, &material.glossyTexture, &material.glossyExponentTexture,
              &material.roughnessTexture, &material.transmissionTexture, &material.emissionTexture,
              &material.opacityTexture, &material.normalTexture, &material.bumpTexture,
              &material.displacementTexture}) {
            if (*use) files.emplace_back((*use)->file);
        }
    }
    if (scene.environment && scene.environment->texture)
        files.emplace_back(scene.environment->texture->file);
    return files;
}

}  // namespace pm::host
