// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_size.h"

#include <algorithm>

namespace pm::host {
namespace {

// What the allocator adds to a block, at most.
constexpr std::uint64_t kBlock = 16;

std::uint64_t block(std::uint64_t bytes) {
    return bytes == 0 ? 0 : bytes + kBlock;
}

template <typename T>
std::uint64_t block(const std::vector<T>& values) {
    return block(values.capacity() * sizeof(T));
}

std::uint64_t block(const std::string& text) {
    constexpr std::size_t kInside = 15;
    return text.capacity() <= kInside ? 0 : block(text.capacity() + 1);
}

std::uint64_t beside(const Boxed<TextureUse>& use) {
    if (!use) return 0;
    std::uint64_t bytes = block(sizeof(TextureUse)) + block(use->file) + block(use->place) +
                          block(use->colourSpace) + block(use->tiles);
    for (const TileUse& tile : use->tiles) bytes += block(tile.file);
    return bytes;
}

std::uint64_t beside(const MaterialData& material) {
    std::uint64_t bytes = block(material.name) + block(material.byName);
    for (const NamedValue& value : material.byName)
        bytes += block(value.name) + block(value.numbers) + block(value.text) + block(value.place);
    for (const Boxed<TextureUse>* use : material.textures()) bytes += beside(*use);
    bytes += block(material.parts);
    for (const MaterialData& part : material.parts) bytes += block(part.name) + block(part.byName);
    return bytes;
}

std::uint64_t beside(const MeshData& mesh) {
    std::uint64_t bytes = block(mesh.name);
    for (const auto* values : {&mesh.positions, &mesh.normals, &mesh.uvs}) bytes += block(*values);
    for (const auto* values : {&mesh.faceSizes, &mesh.indices, &mesh.normalIndices, &mesh.uvIndices,
                               &mesh.faceSlots, &mesh.slotMaterials})
        bytes += block(*values);
    if (!mesh.tags) return bytes;
    return bytes + block(mesh.tags->creases) + block(mesh.tags->creaseSharpness) +
           block(mesh.tags->corners) + block(mesh.tags->cornerSharpness) + block(mesh.tags->holes);
}

std::uint64_t beside(const InstanceData& instance) {
    return block(instance.name) + block(instance.materials);
}

std::uint64_t beside(const auto& named) {
    return block(named.name);
}

template <typename T>
std::uint64_t all(const std::vector<T>& values) {
    std::uint64_t bytes = block(values);
    for (const T& value : values) bytes += beside(value);
    return bytes;
}

}  // namespace

std::uint64_t bytesOf(const SceneData& scene) {
    return all(scene.materials) + all(scene.meshes) + all(scene.spheres) + all(scene.instances) +
           all(scene.lights) + all(scene.cameras);
}

}  // namespace pm::host
