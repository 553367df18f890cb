// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/scene_memory.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr int kOutOfMemory = 5;
constexpr double kGib = 1024.0 * 1024.0 * 1024.0;
// Of a triangle of a cage: vertices, normals, their numbers, and the ray tracer's tree; measured.
constexpr double kBytesOfTriangle = 150;
// Of a byte of text: itself, cleaned, parsed, and the arrays; at most, of faces of bare numbers.
constexpr double kBytesOfText = 8;

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

void check(const Options& options, double gib, const std::string& what) {
    const double limit = memoryLimitGib(options);
    if (limit <= 0 || gib <= limit) return;
    throw HostError(static_cast<ExitCode>(kOutOfMemory),
                    fmt::format("{}: {} about {:.2f} GiB; the memory limit is {:g} GiB "
                                "(--memory-limit)",
                                options.scene.string(), what, gib, limit));
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

void checkFileFits(const Options& options) {
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(options.scene, unknown);
    if (!unknown)
        check(options, kBytesOfText * static_cast<double>(bytes) / kGib, "to read it takes");
}

void checkSceneFits(const Options& options, const SceneData& data) {
    if (options.subdivide == Subdivide::kNone) return;
    std::uint64_t triangles = 0;
    for (const MeshData& mesh : data.meshes) {
        const bool isCage = options.subdivide == Subdivide::kAll || mesh.tags;
        if (isCage && isCutWhole(mesh, data)) triangles += trianglesOf(mesh);
    }
    check(options, kBytesOfTriangle * static_cast<double>(triangles) / kGib,
          fmt::format("subdivided it has {} triangles of", triangles));
}

}  // namespace pm::host
