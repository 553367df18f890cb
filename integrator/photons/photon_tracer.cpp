// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/photon_tracer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <utility>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/values/cancel_check.h"

namespace pm {

namespace {

// Small enough for a pass's photons to be shared evenly among many threads: eight batches of 4096
// left two of these at 1.83 times the speed of one.
constexpr std::uint64_t kBatchSize = 512;
// Light can be caught for ever between lossless surfaces; what is still on its way after this many
// events is counted as lost.
constexpr int kMaxEvents = 1000;
// Glass reflects 4 % of most light, often to where it is all there is: there so little flux would
// lie in a few bright photons. A caustic photon divides at the first of its events, and its smaller
// part goes on at least so often. See docs/decisions.md.
constexpr float kLeastShare = 0.2f;
constexpr int kDividedEvents = 2;

struct Batch {
    std::vector<Photon> photons;
    PhotonBalance balance;
    std::vector<Photon> descended;
    std::vector<EmissionRecord> records;
};

class PhotonWalk {
  public:
    PhotonWalk(const Scene& scene, const LightSampler& lights, const PhotonTraceRequest& request)
        : m_scene(scene),
          m_lights(lights),
          m_request(request),
          m_aim(request.aim && !request.aim->empty() ? request.aim : nullptr),
          m_scale(1.0f / static_cast<float>(request.count)) {}

    void trace(std::uint64_t index, Batch& batch) const {
        // Even streams are cameras'; see FrameRenderer.
        Sampler sampler(m_request.seed, 2 * std::uint64_t{m_request.pass} + 1,
                        static_cast<std::uint64_t>(m_request.kind),
                        static_cast<std::uint32_t>(index));
        AimedPhoton photon;
        ++batch.balance.emitted;
        if (!emit(sampler, photon)) return;
        photon.flux *= m_scale;
        batch.balance.fluxEmitted += channelSum(photon.flux);
        const double landed = walk(photon, sampler, batch);
        if (m_aim && m_request.keepRecords)
            batch.records.push_back({photon.light, photon.caster,
                                     static_cast<float>(channelSum(photon.flux)),
                                     static_cast<float>(landed), photon.part});
    }

  private:
    bool emit(Sampler& sampler, AimedPhoton& photon) const {
        Vec2f uChoice;
        if (m_aim)
            uChoice = sampler.next2D();
        else
            uChoice.x = sampler.next1D();
        const Vec2f uPoint = sampler.next2D(), uDirection = sampler.next2D();
        return m_aim ? m_aim->emit(uChoice, uPoint, uDirection, photon)
                     : m_lights.emit(uChoice.x, uPoint, uDirection, photon);
    }

    // How far a photon has come.
    enum class Stage : std::uint8_t {
        kStraight,   // no diffuse surface yet, and no other lobe either
        kSpecular,   // no diffuse surface yet, but other lobes
        kDiffuse,    // scattered diffusely, at first where it came straight from the light
        kDescended,  // ... where it came by way of other lobes
        kRefocused,  // the same, and on by other lobes before it met another diffuse surface
        kLater,      // descended, and has met another since
    };
    struct Way {
        Stage stage = Stage::kStraight;
        bool isFollowed = true;  // of the share that carries on what descends from caustics
    };

    // A photon, or what goes on of it where it has divided.
    struct Part {
        Ray ray;
        Rgb flux;
        Way way{};
        int events = 0;
    };
    // Parts of one photon that wait to be followed.
    struct Waiting {
        std::array<Part, kDividedEvents + 1> parts;
        std::size_t count = 0;
    };

    // Returns the flux that landed as asked for, W, summed over the channels.
    double walk(const EmittedPhoton& photon, Sampler& sampler, Batch& batch) const {
        Waiting waiting;
        waiting.parts[waiting.count++] = {photon.ray, photon.flux};
        double landed = 0;
        while (waiting.count > 0) {
            const Part part = waiting.parts[--waiting.count];
            landed += walk(part, sampler, waiting, batch);
        }
        return landed;
    }

    double walk(Part part, Sampler& sampler, Waiting& waiting, Batch& batch) const {
        PhotonBalance& balance = batch.balance;
        auto& [ray, flux, way, events] = part;
        double landed = 0;
        while (events < kMaxEvents) {
            Surface surface;
            ++balance.rays;
            if (!m_scene.intersect(ray, surface)) {
                balance.fluxEscaped += channelSum(flux);
                return landed;
            }
            const Vec3f out = -ray.direction;
            const Bsdf bsdf(m_scene, surface, out, Transport::kPhotons, flux);
            if (bsdf.has(Lobe::kDiffuse)) {
                surface.position =
                    pointUnderRay(surface.position, ray, bsdf.facingGeometricNormal(),
                                  m_scene.liftOfRays(surface.position));
                landed += land(way, surface, bsdf, flux, batch);
            }
            BsdfSample sample;
            const float uLobe = sampler.next1D();
            const Vec2f u = sampler.next2D();
            if (divides(part, bsdf)) {
                if (divide(part, surface, bsdf, {uLobe, u.x}, waiting, balance)) continue;
                return landed;
            }
            if ((bsdf.isDiffuseOnly() && endsAtDiffuse(way)) || !bsdf.sample(uLobe, u, sample) ||
                (sample.lobe == Lobe::kDiffuse &&
                 (endsAtDiffuse(way) || !aimScattered(surface, bsdf, sampler, sample)))) {
                balance.fluxAbsorbed += channelSum(flux);
                return landed;
            }
            Rgb scattered = flux * sample.weight;
            if (!advance(way, sample.lobe, sampler, scattered)) {
                balance.fluxAbsorbed += channelSum(flux);
                return landed;
            }
            if (!isFinite(scattered)) break;
            balance.fluxAbsorbed += channelSum(flux) - channelSum(scattered);
            flux = scattered;
            ray = sample.lobe == Lobe::kDiffuse
                      ? rayOnwards(surface.position, bsdf.facingGeometricNormal(), sample.direction,
                                   m_scene.liftOfRays(surface.position))
                      : rayFrom(surface, sample.direction);
            ++events;
        }
        ++balance.lost;
        balance.fluxLost += channelSum(flux);
        return landed;
    }

    // Of what is scattered diffusely where photons are aimed at a focus far away. False: nothing
    // goes on.
    bool aimScattered(const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                      BsdfSample& sample) const {
        if (!m_aim || !m_aim->scattersFrom(surface.position)) return true;
        float pdf;
        const float uChoice = sampler.next1D();
        if (!m_aim->scatter(surface.position, bsdf.diffuseAxis(), uChoice, sampler.next2D(),
                            sample.direction, pdf))
            return false;
        sample.weight = bsdf.evaluate(Lobe::kDiffuse, sample.direction) /
                        (pdf * bsdf.probability(Lobe::kDiffuse));
        return !isBlack(sample.weight);
    }

    // At glass and nothing else, on the way to a caustic.
    bool divides(const Part& part, const Bsdf& bsdf) const {
        return isCaustic(m_request.kind) && part.events < kDividedEvents &&
               part.way.stage <= Stage::kSpecular && bsdf.has(Lobe::kReflection) &&
               bsdf.has(Lobe::kRefraction) && !bsdf.has(Lobe::kStraight);
    }

    // The reflected part waits, the refracted one takes the place of `part`. The smaller of both
    // goes on with the probability of its share, or a little more, the larger always, but for what
    // tinted glass absorbs. False: the refracted one does not go on.
    static bool divide(Part& part, const Surface& surface, const Bsdf& bsdf, Vec2f u,
                       Waiting& waiting, PhotonBalance& balance) {
        const float all = bsdf.probability(Lobe::kReflection) + bsdf.probability(Lobe::kRefraction);
        const auto goesOn = [&](Lobe lobe, float uSurvival, Part& next) {
            const float share = bsdf.probability(lobe) / all;
            const float survival = all * (share < 0.5f ? std::max(share, kLeastShare) : 1.0f);
            BsdfSample sample;
            if (!(uSurvival < survival) || !bsdf.follow(lobe, sample, {uSurvival / survival, 0}))
                return false;
            next.ray = rayFrom(surface, sample.direction);
            next.flux *= sample.weight * (1.0f / survival);
            next.way.stage = Stage::kSpecular;
            ++next.events;
            balance.fluxAbsorbed -= channelSum(next.flux);
            return true;
        };
        balance.fluxAbsorbed += channelSum(part.flux);
        Part reflection = part;
        if (goesOn(Lobe::kReflection, u.x, reflection)) waiting.parts[waiting.count++] = reflection;
        return goesOn(Lobe::kRefraction, u.y, part);
    }

    // By a lobe, with the flux that it carries on. False: the photon is not of the share that is
    // followed.
    bool advance(Way& way, Lobe lobe, Sampler& sampler, Rgb& flux) const {
        if (lobe != Lobe::kDiffuse) {
            if (way.stage == Stage::kStraight) way.stage = Stage::kSpecular;
            if (way.stage == Stage::kDescended) way.stage = Stage::kRefocused;
        } else if (way.stage == Stage::kStraight) {
            way.stage = Stage::kDiffuse;
        } else if (way.stage == Stage::kSpecular) {
            way.stage = Stage::kDescended;
            if (isCaustic(m_request.kind)) way.isFollowed = sampler.next1D() < m_request.descent;
        } else if (way.stage == Stage::kDescended || way.stage == Stage::kRefocused) {
            way.stage = Stage::kLater;
            if (isCaustic(m_request.kind)) flux *= 1.0f / m_request.descent;
            return way.isFollowed;
        }
        return true;
    }

    // Nothing that comes after a diffuse scattering on this way is asked for.
    bool endsAtDiffuse(const Way& way) const {
        if (isCaustic(m_request.kind))
            return way.stage == Stage::kStraight || m_request.descent == 0.0f || !way.isFollowed;
        return way.stage == Stage::kSpecular && m_request.withoutCaustics;
    }

    // Stores a photon where its way is asked for. Returns its flux if so; of light that descends
    // from caustics 0.
    double land(const Way& way, const Surface& surface, const Bsdf& bsdf, const Rgb& flux,
                Batch& batch) const {
        if (isCaustic(m_request.kind)) {
            if (way.stage == Stage::kSpecular)
                store(surface, bsdf, flux, batch, batch.photons);
            else if (way.stage != Stage::kStraight)
                landDescended(way, surface, bsdf, flux, batch);
            return way.stage == Stage::kSpecular ? channelSum(flux) : 0;
        }
        if (way.stage == Stage::kSpecular && m_request.withoutCaustics) return 0;
        store(surface, bsdf, flux, batch, batch.photons);
        return channelSum(flux);
    }

    // What caustics send straight to a surface is even: the share that is followed carries it.
    void landDescended(const Way& way, const Surface& surface, const Bsdf& bsdf, const Rgb& flux,
                       Batch& batch) const {
        const bool isStraight = way.stage == Stage::kDescended;
        if (isStraight && !way.isFollowed) return;
        store(surface, bsdf, isStraight ? flux * (1.0f / m_request.descent) : flux, batch,
              batch.descended);
        if (way.stage == Stage::kRefocused) batch.descended.back().normal.mark();
    }

    static void store(const Surface& surface, const Bsdf& bsdf, const Rgb& flux, Batch& batch,
                      std::vector<Photon>& photons) {
        photons.push_back({surface.position, flux * bsdf.normalRatio(),
                           PackedNormal(bsdf.facingGeometricNormal())});
        ++batch.balance.stored;
    }

    const Scene& m_scene;
    const LightSampler& m_lights;
    const PhotonTraceRequest& m_request;
    const AimedEmission* m_aim;
    float m_scale;
};

// Those of all batches, in order; empties them.
template <typename T>
void join(std::vector<Batch>& batches, std::vector<T> Batch::*member, BigVector<T>& joined,
          const CancelCheck& cancel) {
    std::vector<std::size_t> begins{0};
    for (const Batch& batch : batches) begins.push_back(begins.back() + (batch.*member).size());
    joined.resize(begins.back());
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
        cancel.throwIfSet("joining photons");
        const std::vector<T> from = std::exchange(batches[b].*member, {});
        std::ranges::copy(from, joined.begin() + static_cast<std::ptrdiff_t>(begins[b]));
    });
}

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
    if (request.aim) result.focus = request.aim->focus();
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
    const CancelCheck check(cancelled);
    check.throwIfSet("tracing photons");
    join(batches, &Batch::photons, result.photons, check);
    join(batches, &Batch::descended, result.descended, check);
    join(batches, &Batch::records, result.records, check);
    for (const Batch& batch : batches) result.balance += batch.balance;
    return result;
}

}  // namespace pm
