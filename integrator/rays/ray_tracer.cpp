// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/rays/ray_tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "integrator/rays/group_shape.h"
#include "integrator/rays/ray_device.h"
#include "integrator/rays/ray_query.h"
#include "integrator/rays/shared_mesh_impl.h"
#include "integrator/rays/user_shapes.h"

namespace pm {

namespace {

// Of a ray that looks for all that it meets: told of each, which it then passes, or is stopped by.
void askForHit(const RTCFilterFunctionNArguments* args) {
    if (args->valid[0] != -1) return;
    RayQuery& query = RayQuery::of(args->context);
    const std::uint32_t instance = RTCHitN_instID(args->hit, 1, 0, 0),
                        geometry = RTCHitN_geomID(args->hit, 1, 0);
    if (!query.isStoppedBy({instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance,
                            RTCHitN_primID(args->hit, 1, 0), RTCRayN_tfar(args->ray, 1, 0)}))
        args->valid[0] = 0;
}

bool usable(const Ray& ray) {
    // NaN compares false, so that one test finds NaN, infinity and what is too far.
    return maxAbsComponent(ray.origin) <= RayTracer::kLargestCoordinate && isFinite(ray.origin) &&
           isFinite(ray.direction) &&
           maxAbsComponent(ray.direction) <= RayTracer::kLargestCoordinate && ray.tMax >= 0.0f;
}

void fill(RTCRay& out, const Ray& ray) {
    out.org_x = ray.origin.x;
    out.org_y = ray.origin.y;
    out.org_z = ray.origin.z;
    out.tnear = 0.0f;
    out.dir_x = ray.direction.x;
    out.dir_y = ray.direction.y;
    out.dir_z = ray.direction.z;
    out.time = ray.time;
    out.tfar = ray.tMax;
    out.mask = ray.viewer;
    out.id = 0;
    out.flags = 0;
}

// That has met nothing yet.
void fill(RTCRayHit& out, const Ray& ray) {
    fill(out.ray, ray);
    out.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    out.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

// Column by column, as Embree has it.
std::array<float, 12> toEmbree(const Transform& m) {
    std::array<float, 12> columns;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column)
            columns[3 * column + row] = static_cast<float>(m[4 * row + column]);
    return columns;
}

}  // namespace

struct RayTracer::Impl {
    std::shared_ptr<RayDevice> device;
    RTCScene scene = nullptr;
    // Deques: Embree keeps pointers to their elements.
    std::deque<UserCurved> curved;
    std::deque<GroupShape> groups;
    std::deque<ExactTriangles> exact;
    std::deque<std::vector<std::array<std::uint32_t, 3>>> othersThanExact;
    std::deque<Transform> transforms;
    std::vector<const Transform*> placements;  // of each shape, null where it is no instance
    std::vector<std::shared_ptr<const SharedMesh>> meshes;
    std::uint64_t bytes = 0;

    ~Impl() {
        if (scene) rtcReleaseScene(scene);
    }
    std::uint32_t added(std::uint32_t id, const Transform* placement) {
        placements.push_back(placement);
        return id;
    }
};

RayTracer::RayTracer(const std::string& isa) : m_impl(std::make_unique<Impl>()) {
    m_impl->device = RayDevice::of(isa);
    m_impl->scene = m_impl->device->newScene();
    m_impl->device->check("creating a scene");
}

RayTracer::~RayTracer() = default;

std::uint32_t RayTracer::addTriangles(std::span<const Vec3f> positions,
                                      std::span<const std::array<std::uint32_t, 3>> triangles,
                                      std::span<const ExactTriangle> exact, Viewers seenBy) {
    if (!exact.empty()) {
        // Embree passes over triangles without area.
        auto& others = m_impl->othersThanExact.emplace_back(triangles.begin(), triangles.end());
        for (const ExactTriangle& one : exact) others[one.primitive].fill(others[one.primitive][0]);
        triangles = others;
    }
    RTCGeometry geometry = rtcNewGeometry(m_impl->device->handle(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions.data(), 0, sizeof(Vec3f), positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, sizeof(triangles[0]), triangles.size());
    rtcSetGeometryMask(geometry, seenBy);
    rtcCommitGeometry(geometry);
    const std::uint32_t id = rtcAttachGeometry(m_impl->scene, geometry);
    rtcReleaseGeometry(geometry);
    m_impl->device->check("adding triangles");
    if (!exact.empty()) m_impl->exact.push_back({id, {exact.begin(), exact.end()}, seenBy});
    return m_impl->added(id, nullptr);
}

std::uint32_t RayTracer::addCurved(const CurvedShape& shape, Viewers seenBy) {
    m_impl->curved.push_back({shape});
    const std::uint32_t id = attachUserGeometry(m_impl->device->handle(), m_impl->scene,
                                                m_impl->curved.back(), 1, seenBy);
    m_impl->device->check("adding a curved shape");
    return m_impl->added(id, nullptr);
}

std::uint32_t RayTracer::addGroups(const LimitGroups& groups, Viewers seenBy) {
    m_impl->groups.push_back({&groups});
    const std::uint32_t id = attachUserGeometry<GroupShape, GroupShape>(
        m_impl->device->handle(), m_impl->scene, m_impl->groups.back(), groups.groupCount(),
        seenBy);
    m_impl->device->check("adding a limit surface");
    return m_impl->added(id, nullptr);
}

std::uint32_t RayTracer::addInstance(std::shared_ptr<const SharedMesh> mesh,
                                     const Transform& toScene, Viewers seenBy) {
    RTCGeometry geometry = rtcNewGeometry(m_impl->device->handle(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, mesh->m_impl->scene);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            toEmbree(toScene).data());
    rtcSetGeometryMask(geometry, seenBy);
    rtcCommitGeometry(geometry);
    const std::uint32_t id = rtcAttachGeometry(m_impl->scene, geometry);
    rtcReleaseGeometry(geometry);
    m_impl->device->check("adding an instance");
    m_impl->meshes.push_back(std::move(mesh));
    m_impl->transforms.push_back(toScene);
    return m_impl->added(id, &m_impl->transforms.back());
}

void RayTracer::commit(const CancelCheck& cancel) {
    // Last, so that shapes keep their numbers.
    for (ExactTriangles& one : m_impl->exact)
        attachUserGeometry(m_impl->device->handle(), m_impl->scene, one, one.triangles.size(),
                           one.seenBy);
    m_impl->bytes = m_impl->device->commit(m_impl->scene, cancel);
}

bool RayTracer::intersect(const Ray& ray, RayHit& hit) const {
    if (!usable(ray)) return false;
    alignas(16) RTCRayHit rayHit;
    fill(rayHit, ray);
    RayQuery query(ray, m_impl->placements);
    rtcIntersect1(m_impl->scene, &query.context, &rayHit);
    if (query.thrown) std::rethrow_exception(query.thrown);
    if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    const std::uint32_t instance = rayHit.hit.instID[0];
    hit = {instance == RTC_INVALID_GEOMETRY_ID ? rayHit.hit.geomID : instance, rayHit.hit.primID,
           rayHit.ray.tfar};
    return true;
}

bool RayTracer::occluded(const Ray& ray) const {
    if (!usable(ray)) return true;
    alignas(16) RTCRay rtcRay;
    fill(rtcRay, ray);
    RayQuery query(ray, m_impl->placements);
    rtcOccluded1(m_impl->scene, &query.context, &rtcRay);
    if (query.thrown) std::rethrow_exception(query.thrown);
    return rtcRay.tfar < 0.0f;
}

bool RayTracer::askEach(const Ray& ray, HitQuestion stops, void* user) const {
    if (!usable(ray)) return true;
    alignas(16) RTCRay rtcRay;
    fill(rtcRay, ray);
    RayQuery query(ray, m_impl->placements);
    query.stops = stops;
    query.user = user;
    query.context.filter = askForHit;
    rtcOccluded1(m_impl->scene, &query.context, &rtcRay);
    if (query.thrown) std::rethrow_exception(query.thrown);
    return rtcRay.tfar < 0.0f;
}

void RayTracer::visitHits(const Ray& ray, float tMin, HitQuestion visit, void* user) const {
    if (!usable(ray)) return;
    alignas(16) RTCRayHit rayHit;
    fill(rayHit, ray);
    rayHit.ray.tnear = std::max(0.0f, tMin);
    RayQuery query(ray, m_impl->placements);
    query.stops = visit;
    query.user = user;
    query.withCurved = false;
    query.context.filter = askForHit;
    rtcIntersect1(m_impl->scene, &query.context, &rayHit);
    if (query.thrown) std::rethrow_exception(query.thrown);
}

const std::string& RayTracer::isa() const {
    return m_impl->device->isa();
}

std::uint64_t RayTracer::memoryBytes() const {
    return m_impl->bytes;
}

}  // namespace pm
