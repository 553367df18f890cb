// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/rays/ray_tracer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <exception>
#include <vector>

#include "integrator/values/error.h"

namespace pm {

namespace {

struct Sphere {
    Vec3d centre;
    double radius;
};

bool processorHas(const std::string& isa) {
    if (isa == "sse2") return true;
    if (isa == "sse4.2") return __builtin_cpu_supports("sse4.2");
    if (isa == "avx") return __builtin_cpu_supports("avx");
    if (isa == "avx2") return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512cd");
}

std::string resolveIsa(const std::string& wanted) {
    static constexpr std::array kKnown = {"avx512", "avx2", "avx", "sse4.2", "sse2"};
    __builtin_cpu_init();
    if (wanted.empty() || wanted == "best") {
        for (const char* isa : kKnown)
            if (processorHas(isa)) return isa;
    }
    for (const char* isa : kKnown) {
        if (wanted != isa) continue;
        if (!processorHas(wanted))
            throw Error(
                Status::kInvalidArgument,
                "instruction set " + wanted + " is not offered by this processor; use best");
        return wanted;
    }
    throw Error(
        Status::kInvalidArgument,
        "instruction set is '" + wanted + "'; it must be best, sse2, sse4.2, avx, avx2 or avx512");
}

// Those of a shape's triangles that are intersected in double.
struct ExactTriangles {
    std::uint32_t shape;
    std::vector<ExactTriangle> triangles;
};

// Rounded outwards: the box must hold what it is of in double.
void setBounds(RTCBounds& bounds, const Vec3d& lo, const Vec3d& hi) {
    const auto down = [](double v) {
        return std::nextafter(static_cast<float>(v), -std::numeric_limits<float>::infinity());
    };
    const auto up = [](double v) {
        return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
    };
    bounds.lower_x = down(lo.x);
    bounds.lower_y = down(lo.y);
    bounds.lower_z = down(lo.z);
    bounds.upper_x = up(hi.x);
    bounds.upper_y = up(hi.y);
    bounds.upper_z = up(hi.z);
}

void sphereBounds(const RTCBoundsFunctionArguments* args) {
    const auto& sphere = *static_cast<const Sphere*>(args->geometryUserPtr);
    const Vec3d r(sphere.radius);
    setBounds(*args->bounds_o, sphere.centre - r, sphere.centre + r);
}

double intersectRtcRay(const Sphere& sphere, const RTCRay& ray) {
    return intersectSphere({ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z},
                           static_cast<double>(ray.tfar), sphere.centre, sphere.radius);
}

void setHit(RTCRayHit& rayHit, double t, std::uint32_t shape, std::uint32_t primitive) {
    rayHit.ray.tfar = static_cast<float>(t);
    rayHit.hit.geomID = shape;
    rayHit.hit.primID = primitive;
    rayHit.hit.u = rayHit.hit.v = 0.0f;
    rayHit.hit.Ng_x = 1.0f;
    rayHit.hit.Ng_y = rayHit.hit.Ng_z = 0.0f;
}

// What a ray that looks for all its hits tells of each; they are then passed over.
struct AllHits {
    RTCIntersectContext context;  // first: Embree hands a pointer to it back
    void (*visit)(const void* user, const RayHit& hit);
    const void* user;
};

void passOver(const RTCFilterFunctionNArguments* args) {
    if (args->valid[0] != -1) return;
    const auto& all = *reinterpret_cast<const AllHits*>(args->context);
    all.visit(all.user, {RTCHitN_geomID(args->hit, 1, 0), RTCHitN_primID(args->hit, 1, 0),
                         RTCRayN_tfar(args->ray, 1, 0)});
    args->valid[0] = 0;
}

// What asks each of a ray's hits whether it stops the ray.
struct HitQuestions {
    RTCIntersectContext context;  // first: Embree hands a pointer to it back
    bool (*stops)(void* user, const RayHit& hit);
    void* user;
    std::exception_ptr thrown;  // Embree's own functions can't be left by an exception

    bool areStopped(const RayHit& hit) {
        try {
            return thrown || stops(user, hit);
        } catch (...) {
            thrown = std::current_exception();
            return true;
        }
    }
};

void askForHit(const RTCFilterFunctionNArguments* args) {
    if (args->valid[0] != -1) return;
    auto& questions = *reinterpret_cast<HitQuestions*>(args->context);
    if (!questions.areStopped({RTCHitN_geomID(args->hit, 1, 0), RTCHitN_primID(args->hit, 1, 0),
                               RTCRayN_tfar(args->ray, 1, 0)}))
        args->valid[0] = 0;
}

void stop(RTCRay& ray) {
    ray.tfar = -std::numeric_limits<float>::infinity();
}

// Rays are traced one by one, so N is 1 and the packet is a plain RTCRayHit.
void sphereIntersect(const RTCIntersectFunctionNArguments* args) {
    if (args->valid[0] != -1 || args->context->filter == passOver) return;
    auto& rayHit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const double t =
        intersectRtcRay(*static_cast<const Sphere*>(args->geometryUserPtr), rayHit.ray);
    if (t < 0.0) return;
    setHit(rayHit, t, args->geomID, args->primID);
}

void sphereOccluded(const RTCOccludedFunctionNArguments* args) {
    if (args->valid[0] != -1) return;
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    const auto& sphere = *static_cast<const Sphere*>(args->geometryUserPtr);
    if (args->context->filter != askForHit) {
        if (intersectRtcRay(sphere, ray) >= 0.0) stop(ray);
        return;
    }
    auto& questions = *reinterpret_cast<HitQuestions*>(args->context);
    SphereRoots roots;
    if (!findSphereRoots({ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z},
                         sphere.centre, sphere.radius, roots))
        return;
    for (const double t : {roots.near, roots.far})
        if (t > 0.0 && t <= static_cast<double>(ray.tfar) &&
            questions.areStopped({args->geomID, args->primID, static_cast<float>(t)})) {
            stop(ray);
            return;
        }
}

void trianglesBounds(const RTCBoundsFunctionArguments* args) {
    const auto& of = *static_cast<const ExactTriangles*>(args->geometryUserPtr);
    const ExactTriangle& triangle = of.triangles[args->primID];
    Vec3d lo = triangle.corners[0], hi = lo;
    for (const Vec3d& corner : triangle.corners)
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], corner[axis]);
            hi[axis] = std::max(hi[axis], corner[axis]);
        }
    setBounds(*args->bounds_o, lo, hi);
}

// The nearest hit in (0, tMax], or a negative number. Which side of an edge the ray passes comes of
// the edge's two ends alone, so that nothing slips through between neighbours.
double intersectRtcRay(const ExactTriangle& triangle, const RTCRay& ray) {
    const Vec3d direction{ray.dir_x, ray.dir_y, ray.dir_z};
    const Vec3d origin{ray.org_x, ray.org_y, ray.org_z};
    const Vec3d a = triangle.corners[0] - origin, b = triangle.corners[1] - origin,
                c = triangle.corners[2] - origin;
    const double u = dot(direction, cross(c, b)), v = dot(direction, cross(a, c)),
                 w = dot(direction, cross(b, a));
    if (std::min({u, v, w}) < 0.0 && std::max({u, v, w}) > 0.0) return -1.0;
    const Vec3d normal =
        cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
    const double t = dot(normal, a) / dot(normal, direction);
    // NaN and infinity, of what is seen edge-on, are no hit.
    return t > 0.0 && t <= static_cast<double>(ray.tfar) ? t : -1.0;
}

void trianglesIntersect(const RTCIntersectFunctionNArguments* args) {
    if (args->valid[0] != -1) return;
    auto& rayHit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const auto& of = *static_cast<const ExactTriangles*>(args->geometryUserPtr);
    const ExactTriangle& triangle = of.triangles[args->primID];
    const double t = intersectRtcRay(triangle, rayHit.ray);
    if (t < static_cast<double>(rayHit.ray.tnear)) return;
    if (args->context->filter == passOver) {
        const auto& all = *reinterpret_cast<const AllHits*>(args->context);
        all.visit(all.user, {of.shape, triangle.primitive, static_cast<float>(t)});
        return;
    }
    setHit(rayHit, t, of.shape, triangle.primitive);
}

void trianglesOccluded(const RTCOccludedFunctionNArguments* args) {
    if (args->valid[0] != -1) return;
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    const auto& of = *static_cast<const ExactTriangles*>(args->geometryUserPtr);
    const ExactTriangle& triangle = of.triangles[args->primID];
    const double t = intersectRtcRay(triangle, ray);
    if (t < 0.0) return;
    if (args->context->filter != askForHit ||
        reinterpret_cast<HitQuestions*>(args->context)
            ->areStopped({of.shape, triangle.primitive, static_cast<float>(t)}))
        stop(ray);
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
    out.time = 0.0f;
    out.tfar = ray.tMax;
    out.mask = ~0u;
    out.id = 0;
    out.flags = 0;
}

// That has met nothing yet.
void fill(RTCRayHit& out, const Ray& ray) {
    fill(out.ray, ray);
    out.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    out.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
}

}  // namespace

bool findSphereRoots(const Vec3d& origin, const Vec3d& direction, const Vec3d& centre,
                     double radius, SphereRoots& roots) {
    const Vec3d f = origin - centre;
    const double a = lengthSquared(direction);
    if (!(a > 0.0)) return false;
    const double b = -dot(f, direction);
    const double f2 = lengthSquared(f), c = f2 - radius * radius;
    // Most misses need no division: the sphere lies behind, or the line passes it by more than
    // these few terms' roundings, 2^-52 each of a f2, can amount to.
    if (b < 0.0 && c > 0.0) return false;
    if (a * c - b * b > 0x1p-46 * a * f2) return false;
    // The squared distance of the ray's line from the centre, without cancellation for far spheres.
    const Vec3d nearest = f + direction * (b / a);
    const double discriminant = radius * radius - lengthSquared(nearest);
    if (discriminant < 0.0) return false;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    if (q == 0.0) return false;  // the origin is on the sphere and the ray touches it
    roots = {c / q, q / a};
    if (roots.near > roots.far) std::swap(roots.near, roots.far);
    return true;
}

double intersectSphere(const Vec3d& origin, const Vec3d& direction, double tMax,
                       const Vec3d& centre, double radius) {
    SphereRoots roots;
    if (!findSphereRoots(origin, direction, centre, radius, roots)) return -1.0;
    const double t = roots.near > 0.0 ? roots.near : roots.far;
    return t > 0.0 && t <= tMax ? t : -1.0;
}

struct RayTracer::Impl {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::string isa;
    // Deques: Embree keeps pointers to their elements.
    std::deque<Sphere> spheres;
    std::deque<ExactTriangles> exact;
    std::deque<std::vector<std::array<std::uint32_t, 3>>> othersThanExact;
    std::atomic<std::int64_t> bytes{0};

    ~Impl() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    // What is intersected by functions of ours.
    std::uint32_t attach(void* user, std::uint32_t primitives, RTCBoundsFunction bounds,
                         RTCIntersectFunctionN intersect, RTCOccludedFunctionN occluded) {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, primitives);
        rtcSetGeometryUserData(geometry, user);
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry, intersect);
        rtcSetGeometryOccludedFunction(geometry, occluded);
        rtcCommitGeometry(geometry);
        const std::uint32_t id = rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        return id;
    }
    // Without a device too: Embree then tells this thread why there is none.
    void check(const std::string& doing) const {
        const RTCError error = rtcGetDeviceError(device);
        if (error == RTC_ERROR_NONE) return;
        // Unknown is what becomes of an error that it has no memory to keep.
        if (error == RTC_ERROR_OUT_OF_MEMORY || error == RTC_ERROR_UNKNOWN)
            throw Error(Status::kOutOfMemory, "out of memory: Embree failed " + doing);
        throw Error(Status::kInternal,
                    "Embree failed " + doing + ", error " + std::to_string(error));
    }
};

RayTracer::RayTracer(const std::string& isa) : m_impl(std::make_unique<Impl>()) {
    m_impl->isa = resolveIsa(isa);
    // "threads=" is left out on purpose: it would set TBB's parallelism for the whole process.
    const std::string config = "isa=" + m_impl->isa;
    m_impl->device = rtcNewDevice(config.c_str());
    if (!m_impl->device) {
        m_impl->check("making a device for " + config);
        throw Error(Status::kOutOfMemory, "out of memory: Embree makes no device for " + config);
    }
    rtcSetDeviceMemoryMonitorFunction(
        m_impl->device,
        [](void* user, ssize_t bytes, bool) {
            static_cast<Impl*>(user)->bytes += bytes;
            return true;
        },
        m_impl.get());
    m_impl->scene = rtcNewScene(m_impl->device);
    if (!m_impl->scene) {
        m_impl->check("making a scene");
        throw Error(Status::kOutOfMemory, "out of memory: Embree makes no scene");
    }
    // A filter only comes with rays that look for all their hits; others pay nothing for it.
    rtcSetSceneFlags(m_impl->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    m_impl->check("creating a scene");
}

RayTracer::~RayTracer() = default;

std::uint32_t RayTracer::addTriangles(std::span<const Vec3f> positions,
                                      std::span<const std::array<std::uint32_t, 3>> triangles,
                                      std::span<const ExactTriangle> exact) {
    if (!exact.empty()) {
        // Embree passes over triangles without area.
        auto& others = m_impl->othersThanExact.emplace_back(triangles.begin(), triangles.end());
        for (const ExactTriangle& one : exact) others[one.primitive].fill(others[one.primitive][0]);
        triangles = others;
    }
    RTCGeometry geometry = rtcNewGeometry(m_impl->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions.data(), 0, sizeof(Vec3f), positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, sizeof(triangles[0]), triangles.size());
    rtcCommitGeometry(geometry);
    const std::uint32_t id = rtcAttachGeometry(m_impl->scene, geometry);
    rtcReleaseGeometry(geometry);
    m_impl->check("adding triangles");
    if (!exact.empty()) m_impl->exact.push_back({id, {exact.begin(), exact.end()}});
    return id;
}

std::uint32_t RayTracer::addSphere(const Vec3d& centre, double radius) {
    m_impl->spheres.push_back({centre, radius});
    const std::uint32_t id =
        m_impl->attach(&m_impl->spheres.back(), 1, sphereBounds, sphereIntersect, sphereOccluded);
    m_impl->check("adding a sphere");
    return id;
}

void RayTracer::commit(const CancelCheck& cancel) {
    // Last, so that shapes keep their numbers.
    for (ExactTriangles& one : m_impl->exact)
        m_impl->attach(&one, static_cast<std::uint32_t>(one.triangles.size()), trianglesBounds,
                       trianglesIntersect, trianglesOccluded);
    // Embree asks now and then whether to go on.
    CancelCheck check = cancel;
    rtcSetSceneProgressMonitorFunction(
        m_impl->scene,
        [](void* user, double) { return !static_cast<const CancelCheck*>(user)->isSet(); }, &check);
    rtcCommitScene(m_impl->scene);
    rtcSetSceneProgressMonitorFunction(m_impl->scene, nullptr, nullptr);
    cancel.throwIfSet("building the ray-tracing structure");
    m_impl->check("building the ray-tracing structure");
}

bool RayTracer::intersect(const Ray& ray, RayHit& hit) const {
    if (!usable(ray)) return false;
    alignas(16) RTCRayHit rayHit;
    fill(rayHit, ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(m_impl->scene, &context, &rayHit);
    if (rayHit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit = {rayHit.hit.geomID, rayHit.hit.primID, rayHit.ray.tfar};
    return true;
}

bool RayTracer::occluded(const Ray& ray) const {
    if (!usable(ray)) return true;
    alignas(16) RTCRay rtcRay;
    fill(rtcRay, ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(m_impl->scene, &context, &rtcRay);
    return rtcRay.tfar < 0.0f;
}

bool RayTracer::askEach(const Ray& ray, HitQuestion stops, void* user) const {
    if (!usable(ray)) return true;
    alignas(16) RTCRay rtcRay;
    fill(rtcRay, ray);
    HitQuestions questions{{}, stops, user, nullptr};
    rtcInitIntersectContext(&questions.context);
    questions.context.filter = askForHit;
    rtcOccluded1(m_impl->scene, &questions.context, &rtcRay);
    if (questions.thrown) std::rethrow_exception(questions.thrown);
    return rtcRay.tfar < 0.0f;
}

void RayTracer::visitHits(const Ray& ray, float tMin, HitVisitor visit, const void* user) const {
    if (!usable(ray)) return;
    alignas(16) RTCRayHit rayHit;
    fill(rayHit, ray);
    rayHit.ray.tnear = std::max(0.0f, tMin);
    AllHits all{{}, visit, user};
    rtcInitIntersectContext(&all.context);
    all.context.filter = passOver;
    rtcIntersect1(m_impl->scene, &all.context, &rayHit);
}

const std::string& RayTracer::isa() const {
    return m_impl->isa;
}

std::uint64_t RayTracer::memoryBytes() const {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, m_impl->bytes.load()));
}

}  // namespace pm
