// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/rays/shared_mesh.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "integrator/rays/shared_mesh_impl.h"

namespace pm {

namespace {

// Where more of a mesh than this lies at its rim, it is a soup of faces with gaps of its own.
constexpr double kMostOfRim = 0.5;
constexpr std::size_t kSmallMesh = 256;

// The triangles that have an edge which no other has.
std::vector<std::uint32_t> trianglesOfRim(std::span<const SharedMesh::Triangle> triangles) {
    using Edge = std::pair<std::uint64_t, std::uint32_t>;
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(triangles[i][k], triangles[i][(k + 1) % 3]);
            edges.emplace_back(std::uint64_t{a} << 32 | b, i);
        }
    std::ranges::sort(edges);
    std::vector<std::uint32_t> rim;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool isShared = (i > 0 && edges[i - 1].first == edges[i].first) ||
                              (i + 1 < edges.size() && edges[i + 1].first == edges[i].first);
        if (!isShared) rim.push_back(edges[i].second);
    }
    std::ranges::sort(rim);
    rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
    return rim;
}

}  // namespace

SharedMesh::SharedMesh(const std::string& isa, std::span<const Vec3f> positions,
                       std::span<const Triangle> triangles, double margin,
                       const CancelCheck& cancel)
    : m_impl(std::make_unique<Impl>()) {
    m_impl->device = RayDevice::of(isa);
    const RTCDevice device = m_impl->device->handle();
    m_impl->scene = m_impl->device->newScene();
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* const buffer = rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), positions.size());
    if (buffer) std::memcpy(buffer, positions.data(), positions.size_bytes());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, sizeof(Triangle), triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(m_impl->scene, geometry);
    rtcReleaseGeometry(geometry);
    m_impl->device->check("adding triangles");
    m_impl->rim.margin = margin;
    const std::vector<std::uint32_t> rim = trianglesOfRim(triangles);
    const auto share = static_cast<double>(rim.size()) / static_cast<double>(triangles.size());
    if (!rim.empty() && (share <= kMostOfRim || triangles.size() <= kSmallMesh)) {
        for (const std::uint32_t i : rim)
            m_impl->rim.triangles.push_back(
                {i,
                 {Vec3d(positions[triangles[i][0]]), Vec3d(positions[triangles[i][1]]),
                  Vec3d(positions[triangles[i][2]])}});
        attachUserGeometry(device, m_impl->scene, m_impl->rim, m_impl->rim.triangles.size());
    }
    m_impl->bytes = m_impl->device->commit(m_impl->scene, cancel) + positions.size_bytes() +
                    m_impl->rim.triangles.size() * sizeof(ExactTriangle);
}

SharedMesh::~SharedMesh() = default;

double SharedMesh::margin() const {
    return m_impl->rim.margin;
}

const std::string& SharedMesh::isa() const {
    return m_impl->device->isa();
}

std::uint64_t SharedMesh::memoryBytes() const {
    return m_impl->bytes;
}

}  // namespace pm
