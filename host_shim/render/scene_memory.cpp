// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/scene_memory.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "host_shim/formats/scene_size.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
constexpr double kGib = 1024.0 * 1024.0 * 1024.0;
// Of the program and its libraries before anything is rendered; 127 are measured.
constexpr std::uint64_t kProgramBytes = 134 * kMib;

// Of a triangle of a cage: vertices, normals, their numbers, and the ray tracer's tree; measured.
constexpr std::uint64_t kBytesOfTriangle = 150;
// The same of a corner of a plain face.
constexpr std::uint64_t kBytesOfCorner = 55;
// Of a byte of text: itself, parsed, and the arrays; at most, of faces of bare numbers.
constexpr std::uint64_t kBytesOfText = 8;
// Of a byte of a sidecar; 13 are measured of instances.
constexpr std::uint64_t kBytesOfSidecar = 14;

double gib(std::uint64_t bytes) {
    return static_cast<double>(bytes) / kGib;
}

std::uint64_t sizeOf(const std::filesystem::path& file) {
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(file, unknown);
    return unknown ? 0 : bytes;
}

// Catmull-Clark patches are quads: of other faces each corner has one, of half the rate.
std::uint64_t trianglesOf(const MeshData& mesh) {
    constexpr std::uint64_t kHalf = kTessellationRate / 2;
    std::uint64_t triangles = 0;
    for (const std::uint32_t size : mesh.faceSizes)
        triangles += size == 4 ? std::uint64_t{2} * kTessellationRate * kTessellationRate
                               : 2 * kHalf * kHalf * size;
    return triangles;
}

// What is displaced is cut where rays meet it.
bool isCutWhole(const MeshData& mesh, const SceneData& data) {
    return std::ranges::none_of(mesh.slotMaterials, [&](std::uint32_t material) {
        return data.materials[material].displacementTexture.has_value();
    });
}

std::uint64_t trianglesOfCages(const Options& options, const SceneData& data) {
    if (options.subdivide == Subdivide::kNone) return 0;
    std::uint64_t triangles = 0;
    for (const MeshData& mesh : data.meshes) {
        const bool isCage = options.subdivide == Subdivide::kAll || mesh.tags;
        if (isCage && isCutWhole(mesh, data)) triangles += trianglesOf(mesh);
    }
    return triangles;
}

std::size_t pictureCount(const SceneData& data) {
    std::set<std::string_view> files;
    const auto add = [&](const Boxed<TextureUse>& use) {
        if (!use) return;
        if (use->tiles.empty()) files.insert(use->file);
        for (const TileUse& tile : use->tiles) files.insert(tile.file);
    };
    for (const MaterialData& material : data.materials)
        for (const Boxed<TextureUse>* use : material.textures()) add(*use);
    if (data.environment) add(data.environment->texture);
    return files.size();
}

// Of what the library makes of a scene while the host still has it. Measured, of 100,000 and more.
std::uint64_t bytesHandedOver(const SceneData& data) {
    constexpr std::uint64_t kOfLight = 720, kOfInstance = 1800, kOfMaterial = 1750,
                            kOfPicture = 24 << 10;
    // A first look at it by few photons.
    constexpr std::uint64_t kPilot = 8 * kMib;
    std::uint64_t corners = 0;
    for (const MeshData& mesh : data.meshes) corners += mesh.indices.size();
    return kPilot + data.lights.size() * kOfLight + data.instances.size() * kOfInstance +
           data.materials.size() * kOfMaterial + pictureCount(data) * kOfPicture +
           corners * kBytesOfCorner;
}

}  // namespace

double memoryLimitGib(const Options& options) {
    double limit = 0;
    for (const GivenSetting& setting : options.settings) {
        double value = 0;
        if (setting.name == "memoryLimitGib" && parseNumber(setting.value, value) && value > 0)
            limit = value;
    }
    return limit;
}

std::uint64_t memoryLimitBytes(const Options& options) {
    constexpr double kMost = 9e18;
    return static_cast<std::uint64_t>(std::min(memoryLimitGib(options) * kGib, kMost));
}

std::uint64_t memoryForText(const Options& options) {
    constexpr std::uint64_t kAlways = 4 * kMib;
    const std::uint64_t limit = memoryLimitBytes(options);
    return limit == 0 ? 0 : std::max(limit, kProgramBytes + kAlways) - kProgramBytes;
}

HostMemory::HostMemory(const Options& options, const PmrApi& api)
    : m_scene(options.scene.string()),
      m_limit(memoryLimitBytes(options)),
      m_machine(api.memoryLeft(0)),
      m_peak(kProgramBytes) {}

std::uint64_t HostMemory::leftOf(std::uint64_t limit) const {
    const std::uint64_t ofMachine = m_machine - std::min(m_machine, m_held);
    if (m_limit == 0) return ofMachine;
    const std::uint64_t used = kProgramBytes + m_held;
    return std::min(ofMachine, limit - std::min(limit, used));
}

std::uint64_t HostMemory::left() const {
    return leftOf(m_limit);
}

std::uint64_t HostMemory::room() const {
    return leftOf(std::max(m_limit, kTellingBytes));
}

double HostMemory::peakGib() const {
    return gib(m_peak);
}

std::string HostMemory::refused() const {
    return m_limit > 0 && m_peak > m_limit ? m_largest : std::string();
}

void HostMemory::take(std::uint64_t bytes, const std::string& what) {
    const std::uint64_t all = kProgramBytes + m_held + bytes;
    const std::string step = fmt::format("{}: {} about {:.2f} GiB", m_scene, what, gib(bytes));
    if (bytes > room()) {
        const std::string limit =
            m_limit == 0 ? fmt::format("this machine has {:.2f} GiB left", gib(room() + m_held))
                         : fmt::format("the memory limit is {:g} GiB", gib(m_limit));
        throw HostError(ExitCode::kMemory,
                        fmt::format("{}; {}, the smallest that works {:.3f} GiB or more "
                                    "(--memory-limit)",
                                    step, limit, std::ceil(1000 * gib(all)) / 1000));
    }
    if (all <= m_peak) return;
    m_peak = all;
    m_largest = step;
}

MemoryNote takeForReading(const std::filesystem::path& scene, const std::filesystem::path& sidecar,
                          HostMemory& memory) {
    const std::uint64_t bytes = kBytesOfText * sizeOf(scene) + kBytesOfSidecar * sizeOf(sidecar);
    const std::string what = "to read it takes";
    memory.take(bytes, what);
    return [&memory, bytes, what](std::uint64_t more) { memory.take(bytes + more, what); };
}

void takeForBuilding(const Options& options, const SceneData& data, HostMemory& memory) {
    memory.hold(bytesOf(data));
    memory.take(bytesHandedOver(data), "to hand it over takes");
    if (const std::uint64_t triangles = trianglesOfCages(options, data); triangles > 0)
        memory.take(kBytesOfTriangle * triangles,
                    fmt::format("subdivided it has {} triangles of", triangles));
}

void giveBackFreed() {
    ::malloc_trim(0);
}

}  // namespace pm::host
