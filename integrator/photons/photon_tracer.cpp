// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/photon_tracer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

constexpr std::uint64_t kBatchSize = 4096;
// Light can be caught for ever between lossless surfaces; what is still on its way after this many
// events is counted as lost.
constexpr int kMaxEvents = 1000;
// Flux density on a surface counts by its geometric normal, the BSDF by its shading normal; their
// ratio is cut off where a photon arrives almost edge-on.
constexpr float kLargestNormalRatio = 20.0f;

double sum(const Rgb& c) {
    return static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b);
}

struct Batch {
    std::vector<Photon> photons;
    PhotonBalance balance;
};

class PhotonWalk {
  public:
    PhotonWalk(const Scene& scene, const LightSampler& lights, const PhotonTraceRequest& request)
        : m_scene(scene),
          m_lights(lights),
          m_request(request),
          m_scale(1.0f / static_cast<float>(request.count)) {}

    void trace(std::uint64_t index, Batch& batch) const {
        // Even streams are cameras'; see FrameRenderer.
        Sampler sampler(m_request.seed, 2 * std::uint64_t{m_request.pass} + 1,
                        static_cast<std::uint64_t>(m_request.kind),
                        static_cast<std::uint32_t>(index));
        const float uLight = sampler.next1D();
        const Vec2f uPoint = sampler.next2D(), uDirection = sampler.next2D();
        EmittedPhoton photon;
        ++batch.balance.emitted;
        if (!m_lights.emit(uLight, uPoint, uDirection, photon)) return;
        photon.flux *= m_scale;
        batch.balance.fluxEmitted += sum(photon.flux);
        walk(photon, sampler, batch);
    }

  private:
    void walk(const EmittedPhoton& photon, Sampler& sampler, Batch& batch) const {
        PhotonBalance& balance = batch.balance;
        Ray ray = photon.ray;
        Rgb flux = photon.flux;
        bool onlySpecular = true;
        for (int event = 0; event < kMaxEvents; ++event) {
            Surface surface;
            ++balance.rays;
            if (!m_scene.intersect(ray, surface)) {
                balance.fluxEscaped += sum(flux);
                return;
            }
            const Vec3f out = -ray.direction;
            const Bsdf bsdf(m_scene, surface, out, Transport::kPhotons, flux);
            const bool wanted = !isCaustic(m_request.kind) || (onlySpecular && event > 0);
            if (wanted && bsdf.has(Lobe::kDiffuse)) store(surface, bsdf, out, flux, batch);

            BsdfSample sample;
            const float uLobe = sampler.next1D();
            const Vec2f u = sampler.next2D();
            if (!bsdf.sample(uLobe, u, sample)) {
                balance.fluxAbsorbed += sum(flux);
                return;
            }
            if (sample.lobe == Lobe::kDiffuse) onlySpecular = false;
            if (isCaustic(m_request.kind) && !onlySpecular) {
                balance.fluxAbsorbed += sum(flux);
                return;
            }
            const Rgb scattered = flux * sample.weight;
            if (!isFinite(scattered)) break;
            balance.fluxAbsorbed += sum(flux) - sum(scattered);
            flux = scattered;
            ray = rayFrom(surface, sample.direction);
        }
        ++balance.lost;
        balance.fluxLost += sum(flux);
    }

    static void store(const Surface& surface, const Bsdf& bsdf, const Vec3f& out, const Rgb& flux,
                      Batch& batch) {
        const float cosineGeometric = dot(out, bsdf.facingGeometricNormal());
        const float cosineShading = dot(out, bsdf.facingShadingNormal());
        const float ratio = cosineShading >= kLargestNormalRatio * cosineGeometric
                                ? kLargestNormalRatio
                                : cosineShading / cosineGeometric;
        batch.photons.push_back(
            {surface.position, flux * ratio, PackedNormal(bsdf.facingGeometricNormal())});
        ++batch.balance.stored;
    }

    const Scene& m_scene;
    const LightSampler& m_lights;
    const PhotonTraceRequest& m_request;
    float m_scale;
};

}  // namespace

PhotonBalance& PhotonBalance::operator+=(const PhotonBalance& other) {
    emitted += other.emitted;
    stored += other.stored;
    lost += other.lost;
    rays += other.rays;
    fluxEmitted += other.fluxEmitted;
    fluxAbsorbed += other.fluxAbsorbed;
    fluxEscaped += other.fluxEscaped;
    fluxLost += other.fluxLost;
    return *this;
}

PhotonTraceResult tracePhotons(const Scene& scene, const LightSampler& lights,
                               const PhotonTraceRequest& request,
                               const std::atomic<bool>& cancelled,
                               const std::function<void(double)>& progress) {
    PhotonTraceResult result;
    if (request.count == 0 || lights.empty()) return result;
    const PhotonWalk walk(scene, lights, request);
    const std::size_t batchCount = (request.count + kBatchSize - 1) / kBatchSize;
    std::vector<Batch> batches(batchCount);
    std::mutex progressMutex;
    std::size_t done = 0;
    tbb::parallel_for(std::size_t{0}, batchCount, [&](std::size_t b) {
        if (cancelled.load(std::memory_order_relaxed)) return;
        const std::uint64_t end = std::min(request.count, (b + 1) * kBatchSize);
        for (std::uint64_t i = b * kBatchSize; i < end; ++i) walk.trace(i, batches[b]);
        if (!progress) return;
        const std::lock_guard lock(progressMutex);
        progress(static_cast<double>(++done) / static_cast<double>(batchCount));
    });
    if (cancelled.load()) throw Error(Status::kCancelled, "cancelled while tracing photons");
    std::size_t total = 0;
    for (const Batch& batch : batches) total += batch.photons.size();
    result.photons.reserve(total);
    for (Batch& batch : batches) {
        result.photons.insert(result.photons.end(), batch.photons.begin(), batch.photons.end());
        result.balance += batch.balance;
        std::vector<Photon>().swap(batch.photons);
    }
    return result;
}

}  // namespace pm
