// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_reader.h"

namespace pm::host {
namespace {

void addFilesOf(const TextureUse& use, std::vector<std::filesystem::path>& files) {
    if (use.tiles.empty()) files.emplace_back(use.file);
    for (const TileUse& tile : use.tiles) files.emplace_back(tile.file);
}

}  // namespace

std::vector<std::filesystem::path> filesOf(const SceneData& scene) {
    std::vector<std::filesystem::path> files;
    for (const MaterialFile& library : scene.materialFiles) files.emplace_back(library.file);
    for (const std::string& file : scene.files) files.emplace_back(file);
    for (const MaterialData& material : scene.materials) {
        for (const Boxed<TextureUse>* use : material.textures()) {
            if (*use) addFilesOf(**use, files);
        }
    }
    if (scene.environment && scene.environment->texture)
        addFilesOf(*scene.environment->texture, files);
    return files;
}

}  // namespace pm::host
