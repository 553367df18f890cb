// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/speed/bare_embree.h"

#include <embree3/rtcore.h>

#include <array>

namespace pm::bench {

namespace {

// Positions in the scene's own coordinates, as Scene has them. Benchmark scenes have no transforms.
std::vector<Vec3f> movedPositions(const TriangleMesh& mesh, const Vec3d& centre) {
    std::vector<Vec3f> positions;
    for (const Vec3f& p : mesh.positions) positions.push_back(Vec3f(Vec3d(p) - centre));
    return positions;
}

RTCRayHit rayHitOf(const Ray& ray) {
    RTCRayHit r;
    r.ray.org_x = ray.origin.x;
    r.ray.org_y = ray.origin.y;
    r.ray.org_z = ray.origin.z;
    r.ray.tnear = 0.0f;
    r.ray.dir_x = ray.direction.x;
    r.ray.dir_y = ray.direction.y;
    r.ray.dir_z = ray.direction.z;
    r.ray.time = 0.0f;
    r.ray.tfar = ray.tMax;
    r.ray.mask = ~0u;
    r.ray.id = r.ray.flags = 0;
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return r;
}

constexpr std::size_t kEight = 8;
alignas(32) constexpr std::array<int, kEight> kAll = {-1, -1, -1, -1, -1, -1, -1, -1};

void fill(RTCRay8& out, std::size_t i, const Ray& ray) {
    out.org_x[i] = ray.origin.x;
    out.org_y[i] = ray.origin.y;
    out.org_z[i] = ray.origin.z;
    out.tnear[i] = 0.0f;
    out.dir_x[i] = ray.direction.x;
    out.dir_y[i] = ray.direction.y;
    out.dir_z[i] = ray.direction.z;
    out.time[i] = 0.0f;
    out.tfar[i] = ray.tMax;
    out.mask[i] = ~0u;
    out.id[i] = out.flags[i] = 0;
}

RTCIntersectContext coherentContext() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}

}  // namespace

struct BareEmbree::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<Vec3f> positions;
    std::vector<TriangleMesh::Corners> triangles;
    std::vector<std::array<float, 4>> spheres;

    ~Impl() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    void attach(RTCGeometry geometry) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
};

BareEmbree::BareEmbree(const Scene& scene, bool robust) : m_impl(std::make_unique<Impl>()) {
    Impl& e = *m_impl;
    e.device = rtcNewDevice(("isa=" + scene.isa()).c_str());
    e.scene = rtcNewScene(e.device);
    rtcSetSceneFlags(e.scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    for (const InstanceDescription& instance : scene.description().instances) {
        if (const auto* sphere = std::get_if<SphereShape>(&instance.shape)) {
            const Vec3f c(sphere->centre - scene.centre());
            e.spheres.push_back({c.x, c.y, c.z, static_cast<float>(sphere->radius)});
            continue;
        }
        const TriangleMesh& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(instance.shape);
        const auto first = static_cast<std::uint32_t>(e.positions.size());
        for (const Vec3f& p : movedPositions(mesh, scene.centre())) e.positions.push_back(p);
        for (const auto& t : mesh.triangles)
            e.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    e.positions.emplace_back();  // Embree reads 16 bytes a vertex
    RTCGeometry mesh = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               e.positions.data(), 0, sizeof(Vec3f), e.positions.size() - 1);
    rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, e.triangles.data(),
                               0, sizeof(e.triangles[0]), e.triangles.size());
    e.attach(mesh);
    if (!e.spheres.empty()) {
        RTCGeometry spheres = rtcNewGeometry(e.device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
        rtcSetSharedGeometryBuffer(spheres, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                   e.spheres.data(), 0, sizeof(e.spheres[0]), e.spheres.size());
        e.attach(spheres);
    }
    rtcCommitScene(e.scene);
}

BareEmbree::~BareEmbree() = default;

std::uint64_t BareEmbree::countHits(std::span<const Ray> rays) const {
    std::uint64_t hits = 0;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const Ray& ray : rays) {
        alignas(16) RTCRayHit r = rayHitOf(ray);
        rtcIntersect1(m_impl->scene, &context, &r);
        hits += r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

std::uint64_t BareEmbree::countOccluded(std::span<const Ray> rays) const {
    std::uint64_t hits = 0;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const Ray& ray : rays) {
        alignas(16) RTCRayHit r = rayHitOf(ray);
        rtcOccluded1(m_impl->scene, &context, &r.ray);
        hits += r.ray.tfar < 0.0f;
    }
    return hits;
}

std::uint64_t BareEmbree::countHitsByEight(std::span<const Ray> rays) const {
    std::uint64_t hits = 0;
    RTCIntersectContext context = coherentContext();
    for (std::size_t first = 0; first + kEight <= rays.size(); first += kEight) {
        RTCRayHit8 r;
        for (std::size_t i = 0; i < kEight; ++i) {
            fill(r.ray, i, rays[first + i]);
            r.hit.geomID[i] = r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect8(kAll.data(), m_impl->scene, &context, &r);
        for (std::size_t i = 0; i < kEight; ++i) hits += r.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

std::uint64_t BareEmbree::countOccludedByEight(std::span<const Ray> rays) const {
    std::uint64_t hits = 0;
    RTCIntersectContext context = coherentContext();
    for (std::size_t first = 0; first + kEight <= rays.size(); first += kEight) {
        RTCRay8 r;
        for (std::size_t i = 0; i < kEight; ++i) fill(r, i, rays[first + i]);
        rtcOccluded8(kAll.data(), m_impl->scene, &context, &r);
        for (std::size_t i = 0; i < kEight; ++i) hits += r.tfar[i] < 0.0f;
    }
    return hits;
}

LoneRayTracer::LoneRayTracer(const Scene& scene) : m_tracer(scene.isa()) {
    for (const InstanceDescription& instance : scene.description().instances) {
        if (std::holds_alternative<SphereShape>(instance.shape)) {
            m_tracer.addCurved(CurvedShape(instance.shape, instance.transform, scene.centre(),
                                           false, instance.name));
            continue;
        }
        const TriangleMesh& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(instance.shape);
        std::vector<Vec3f> positions = movedPositions(mesh, scene.centre());
        positions.emplace_back();  // readable bytes behind the last
        m_positions.push_back(std::move(positions));
        m_tracer.addTriangles(std::span(m_positions.back()).first(mesh.positions.size()),
                              mesh.triangles);
    }
    m_tracer.commit();
}

}  // namespace pm::bench
