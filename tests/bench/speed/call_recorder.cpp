// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Each function that is recorded has two names here, by the linker's option --wrap: __wrap_NAME,
// which callers reach instead of it, and __real_NAME, which is the function itself. A member
// function is called like a free one whose first argument is the object. The assertions notice when
// a signature, and so the name, has changed.
#include "tests/bench/speed/call_recorder.h"

#include <type_traits>

#include "integrator/materials/bsdf.h"
#include "integrator/scene/camera.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/values/error.h"

namespace pm::bench {

namespace {

// Which part of a render is asking.
enum class Asking {
    kCameraPath,
    kGatherPoint,  // filling one, for the first that asked
    kSite,         // finding its surface, and the estimate there
    kEstimate,     // its short rays
    kCaustic,      // all that a look-up does
};

RecordedCalls* recorded = nullptr;
Asking asking = Asking::kCameraPath;
bool cameraRayComes = false;

// Says who is asking, for as long as it lives.
class Within {
  public:
    explicit Within(Asking now) : m_before(asking) { asking = now; }
    ~Within() { asking = m_before; }

  private:
    Asking m_before;
};

void recordNearest(const Ray& ray) {
    if (asking == Asking::kGatherPoint) recorded->gather.push_back(ray);
    if (asking != Asking::kCameraPath) return;
    (cameraRayComes ? recorded->camera : recorded->onward).push_back(ray);
    cameraRayComes = false;
}

}  // namespace

static_assert(std::is_same_v<decltype(&Scene::intersect),
                             bool (Scene::*)(const Ray&, Surface&, RayFootprint*) const>);
bool realIntersect(const Scene*, const Ray&, Surface&, RayFootprint*) __asm__(
    "__real__ZNK2pm5Scene9intersectERKNS_3RayERNS_7SurfaceEPNS_12RayFootprintE");
bool wrapIntersect(const Scene*, const Ray&, Surface&, RayFootprint*) __asm__(
    "__wrap__ZNK2pm5Scene9intersectERKNS_3RayERNS_7SurfaceEPNS_12RayFootprintE");
bool wrapIntersect(const Scene* scene, const Ray& ray, Surface& surface, RayFootprint* footprint) {
    if (recorded) recordNearest(ray);
    return realIntersect(scene, ray, surface, footprint);
}

static_assert(
    std::is_same_v<decltype(&RayTracer::occluded), bool (RayTracer::*)(const Ray&) const>);
bool realOccluded(const RayTracer*,
                  const Ray&) __asm__("__real__ZNK2pm9RayTracer8occludedERKNS_3RayE");
bool wrapOccluded(const RayTracer*,
                  const Ray&) __asm__("__wrap__ZNK2pm9RayTracer8occludedERKNS_3RayE");
bool wrapOccluded(const RayTracer* tracer, const Ray& ray) {
    if (recorded && asking == Asking::kCameraPath) recorded->shadow.push_back(ray);
    return realOccluded(tracer, ray);
}

static_assert(std::is_same_v<decltype(&Camera::ray), Ray (Camera::*)(const CameraSample&) const>);
Ray realCameraRay(const Camera*,
                  const CameraSample&) __asm__("__real__ZNK2pm6Camera3rayERKNS_12CameraSampleE");
Ray wrapCameraRay(const Camera*,
                  const CameraSample&) __asm__("__wrap__ZNK2pm6Camera3rayERKNS_12CameraSampleE");
Ray wrapCameraRay(const Camera* camera, const CameraSample& sample) {
    if (recorded) {
        cameraRayComes = true;
        ++recorded->samplers;
        ++recorded->pairs;  // the place within the pixel
    }
    return realCameraRay(camera, sample);
}

static_assert(
    std::is_same_v<decltype(&Bsdf::sample), bool (Bsdf::*)(float, Vec2f, BsdfSample&) const>);
bool realSample(const Bsdf*, float, Vec2f,
                BsdfSample&) __asm__("__real__ZNK2pm4Bsdf6sampleEfNS_5Vec2fERNS_10BsdfSampleE");
bool wrapSample(const Bsdf*, float, Vec2f,
                BsdfSample&) __asm__("__wrap__ZNK2pm4Bsdf6sampleEfNS_5Vec2fERNS_10BsdfSampleE");
bool wrapSample(const Bsdf* bsdf, float uLobe, Vec2f u, BsdfSample& sample) {
    if (recorded) {
        ++recorded->singles;
        ++recorded->pairs;
    }
    return realSample(bsdf, uLobe, u, sample);
}

using DirectFunction = DirectRadiance(const Scene&, const LightSampler&, const Surface&,
                                      const Bsdf&, DirectStrategy, bool, std::uint32_t,
                                      const Sampler&, std::uint32_t&);
static_assert(std::is_same_v<decltype(estimateDirect), DirectFunction>);
DirectFunction realDirect __asm__(
    "__real__ZN2pm14estimateDirectERKNS_5SceneERKNS_12LightSamplerERKNS_7SurfaceERKNS_"
    "4BsdfENS_14DirectStrategyEbjRKNS_7SamplerERj");
DirectFunction wrapDirect __asm__(
    "__wrap__ZN2pm14estimateDirectERKNS_5SceneERKNS_12LightSamplerERKNS_7SurfaceERKNS_"
    "4BsdfENS_14DirectStrategyEbjRKNS_7SamplerERj");
DirectRadiance wrapDirect(const Scene& scene, const LightSampler& lights, const Surface& surface,
                          const Bsdf& bsdf, DirectStrategy diffuse, bool isSeen,
                          std::uint32_t samples, const Sampler& sampler, std::uint32_t& rays) {
    if (recorded) recorded->pairs += samples;
    return realDirect(scene, lights, surface, bsdf, diffuse, isSeen, samples, sampler, rays);
}

static_assert(std::is_same_v<decltype(&GatherPoints::estimate),
                             bool (GatherPoints::*)(const GatherPoints::Place&,
                                                    GatherPoints::Estimate&) const>);
bool realPoint(const GatherPoints*, const GatherPoints::Place&, GatherPoints::Estimate&) __asm__(
    "__real__ZNK2pm12GatherPoints8estimateERKNS0_5PlaceERNS0_8EstimateE");
bool wrapPoint(const GatherPoints*, const GatherPoints::Place&, GatherPoints::Estimate&) __asm__(
    "__wrap__ZNK2pm12GatherPoints8estimateERKNS0_5PlaceERNS0_8EstimateE");
bool wrapPoint(const GatherPoints* points, const GatherPoints::Place& place,
               GatherPoints::Estimate& result) {
    if (!recorded) return realPoint(points, place, result);
    recorded->points.push_back({points, place});
    const Within within(Asking::kGatherPoint);
    const std::uint64_t before = points->raysTraced();
    const bool found = realPoint(points, place, result);
    // A sampler and a pair for each gather ray; those that go on by a mirror count double.
    recorded->samplers += points->raysTraced() - before;
    recorded->pairs += points->raysTraced() - before;
    return found;
}

static_assert(std::is_same_v<decltype(&CausticMap::irradiance),
                             TwoRadii (CausticMap::*)(const Vec3f&, const Vec3f&, NearestPhotons&,
                                                      float) const>);
TwoRadii realCaustic(const CausticMap*, const Vec3f&, const Vec3f&, NearestPhotons&, float) __asm__(
    "__real__ZNK2pm10CausticMap10irradianceERKNS_4Vec3IfEES4_RNS_14NearestPhotonsEf");
TwoRadii wrapCaustic(const CausticMap*, const Vec3f&, const Vec3f&, NearestPhotons&, float) __asm__(
    "__wrap__ZNK2pm10CausticMap10irradianceERKNS_4Vec3IfEES4_RNS_14NearestPhotonsEf");
TwoRadii wrapCaustic(const CausticMap* map, const Vec3f& position, const Vec3f& normal,
                     NearestPhotons& scratch, float pixelWidth) {
    if (!recorded) return realCaustic(map, position, normal, scratch, pixelWidth);
    recorded->caustics.push_back({map, position, normal, pixelWidth});
    const Within within(Asking::kCaustic);
    return realCaustic(map, position, normal, scratch, pixelWidth);
}

static_assert(std::is_same_v<decltype(&IrradianceSites::at),
                             TwoRadii (IrradianceSites::*)(const Vec3f&, const Vec3f&) const>);
TwoRadii realSite(const IrradianceSites*, const Vec3f&,
                  const Vec3f&) __asm__("__real__ZNK2pm15IrradianceSites2atERKNS_4Vec3IfEES4_");
TwoRadii wrapSite(const IrradianceSites*, const Vec3f&,
                  const Vec3f&) __asm__("__wrap__ZNK2pm15IrradianceSites2atERKNS_4Vec3IfEES4_");
TwoRadii wrapSite(const IrradianceSites* sites, const Vec3f& position, const Vec3f& normal) {
    if (!recorded) return realSite(sites, position, normal);
    recorded->sites.push_back({sites, position, normal});
    const Within within(Asking::kSite);
    return realSite(sites, position, normal);
}

static_assert(
    std::is_same_v<decltype(&SurfaceEstimate::at),
                   TwoRadii (SurfaceEstimate::*)(const Vec3f&, const Vec3f&, std::uint32_t) const>);
TwoRadii realEstimate(const SurfaceEstimate*, const Vec3f&, const Vec3f&, std::uint32_t) __asm__(
    "__real__ZNK2pm15SurfaceEstimate2atERKNS_4Vec3IfEES4_j");
TwoRadii wrapEstimate(const SurfaceEstimate*, const Vec3f&, const Vec3f&, std::uint32_t) __asm__(
    "__wrap__ZNK2pm15SurfaceEstimate2atERKNS_4Vec3IfEES4_j");
TwoRadii wrapEstimate(const SurfaceEstimate* estimate, const Vec3f& position, const Vec3f& normal,
                      std::uint32_t pattern) {
    if (!recorded || asking == Asking::kCaustic)
        return realEstimate(estimate, position, normal, pattern);
    recorded->estimates.push_back({*estimate, position, normal, pattern});
    const Within within(Asking::kEstimate);
    return realEstimate(estimate, position, normal, pattern);
}

CallRecorder::CallRecorder() {
    recorded = &m_calls;
}

CallRecorder::~CallRecorder() {
    recorded = nullptr;
}

const RecordedCalls& CallRecorder::calls() const {
    if (m_calls.camera.empty() || m_calls.shadow.empty() || m_calls.points.empty() ||
        m_calls.gather.empty() || m_calls.sites.empty() || m_calls.estimates.empty() ||
        m_calls.singles == 0)
        throw Error(Status::kInternal,
                    "the linker led no calls to the recorder: the names after --wrap in "
                    "tests/bench/CMakeLists.txt must be those of call_recorder.cpp");
    return m_calls;
}

}  // namespace pm::bench
