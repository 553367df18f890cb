// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/photon_tracer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <utility>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/event_count.h"
#include "integrator/sampling/sampler.h"
#include "integrator/values/cancel_check.h"

namespace pm {

namespace {

// Small enough for a pass's photons to be shared evenly among many threads: eight batches of 4096
// left two of these at 1.83 times the speed of one.
constexpr std::uint64_t kBatchSize = 512;
// Glass reflects 4 % of most light, often to where it is all there is: there so little flux would
// lie in a few bright photons. A caustic photon divides at the first of its events, and its smaller
// part goes on at least so often. See docs/decisions.md.
constexpr float kLeastShare = 0.2f;
constexpr int kDividedEvents = 2;

struct Batch {
    std::vector<Photon> photons;
    PhotonBalance balance;
    std::vector<Photon> descended;
    std::vector<ReceivedPhoton> received;
    std::vector<EmissionRecord> records;
    std::uint64_t metCaster = 0;
};

class PhotonWalk {
  public:
    PhotonWalk(const Scene& scene, const LightSampler& lights, const PhotonTraceRequest& request)
        : m_scene(scene),
          m_lights(lights),
          m_request(request),
          m_aim(request.aim && !request.aim->empty() ? request.aim : nullptr),
          m_chains(request.oneInChains, request.count,
                   isCaustic(request.kind) ? request.descent : 1.0f,
                   combineBits(combineBits(request.seed, request.pass),
                               static_cast<std::uint64_t>(request.kind))),
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
        const double landed = walk(photon, static_cast<std::uint32_t>(index), sampler, batch);
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
        kStraight,   // by no lobe yet, or straight on, which is as if nothing were there
        kSpecular,   // no diffuse surface yet, but other lobes, the first one not broad
        kDiffuse,    // scattered diffusely, or broadly, at first where it came straight from the
                     // light
        kDescended,  // diffusely where it came by way of other lobes
        kBroadened,  // the same, and on by broad lobes
        kRefocused,  // descended, and on by other lobes before it met another diffuse surface
        kLater,      // descended, and has met another since
    };
    struct Way {
        Stage stage = Stage::kStraight;
        bool isFollowed = true;  // of the share that carries on what descends from caustics
        // It has passed, on its way from the light, what shadow rays pass and others do not, or the
        // other way round; see passesHidden().
        bool pastShadowless = false, pastMirrorless = false;
        bool isUnmet = false;  // by delta lobes alone, from a light that no ray meets

        bool isVoid() const { return pastShadowless && pastMirrorless; }
        bool mayGoOnBy(Lobe lobe) const {
            if (lobe == Lobe::kStraight) return true;
            return isDelta(lobe) ? !pastShadowless : !pastMirrorless;
        }
    };

    // A photon, or what goes on of it where it has divided.
    struct Part {
        Ray ray;
        Rgb flux;
        LongChains::Chain chain{};
        Way way{};
        EventCount events{};
        float width = 0.0f;  // of the footprint that the ray starts from, scene units
    };
    // Parts of one photon that wait to be followed.
    struct Waiting {
        std::array<Part, kDividedEvents + 1> parts;
        std::size_t count = 0;
    };

    // Returns the flux that landed as asked for, W, summed over the channels.
    double walk(const EmittedPhoton& photon, std::uint32_t index, Sampler& sampler,
                Batch& batch) const {
        const CacheWatch::As as(CacheUser::kPhoton);
        Waiting waiting;
        Part& first = waiting.parts[waiting.count++];
        first = {photon.ray, photon.flux, {.index = index}};
        first.way.isUnmet = !photon.isMet;
        if (m_scene.viewersDiffer()) first.ray.viewer = kShadowRays | kReflectionRays;
        double landed = 0;
        while (waiting.count > 0) {
            const Part part = waiting.parts[--waiting.count];
            landed += walk(part, sampler, waiting, batch);
        }
        return landed;
    }

    double walk(Part part, Sampler& sampler, Waiting& waiting, Batch& batch) const {
        PhotonBalance& balance = batch.balance;
        auto& [ray, flux, chain, way, events, width] = part;
        double landed = 0;
        while (true) {
            Surface surface;
            ++balance.rays;
            RayFootprint footprint = m_scene.coneAround(ray.direction, width);
            if (!m_scene.intersect(ray, surface, &footprint)) {
                balance.fluxEscaped += channelSum(flux);
                return landed;
            }
            width = footprint.width();
            if (m_scene.viewersDiffer() && way.stage == Stage::kStraight &&
                passesHidden(part, surface, sampler, balance)) {
                events.add(1.0f);
                if (events.isOver()) break;
                continue;
            }
            const Rgb left = m_scene.leftAlong(ray, surface);
            if (left != Rgb(1.0f)) {
                balance.fluxAbsorbed += channelSum(flux);
                flux *= left;
                balance.fluxAbsorbed -= channelSum(flux);
            }
            const Vec3f out = -ray.direction;
            const Bsdf bsdf(m_scene.materials(), surface, out, Transport::kPhotons, flux);
            if (bsdf.has(Lobe::kDiffuse) && !way.pastMirrorless) {
                surface.position =
                    m_scene.pointUnderRay(surface.position, ray, bsdf.facingGeometricNormal());
                landed += land(part, surface, bsdf, sampler, batch);
            }
            if (m_request.received) landed += receive(part, surface, bsdf, batch);
            BsdfSample sample;
            float uLobe = sampler.next1D();
            const Vec2f u = sampler.next2D();
            if (divides(part, bsdf)) {
                batch.metCaster += way.stage == Stage::kStraight;
                if (divide(part, surface, bsdf, {uLobe, u.x}, waiting, balance)) continue;
                return landed;
            }
            batch.metCaster += way.stage == Stage::kStraight && !isDiffuseOrStraight(bsdf);
            const float survival = probabilityOfAll(bsdf);
            const bool keeps =
                LongChains::keeps(chain, static_cast<float>(channelSum(flux)) * survival);
            if (keeps) uLobe *= survival;
            if ((bsdf.isDiffuseOnly() && endsAtDiffuse(way)) || way.isVoid() ||
                !bsdf.sample(uLobe, u, sample) || !way.mayGoOnBy(sample.lobe) ||
                (sample.lobe == Lobe::kBroad && endsAtBroad(way)) ||
                (sample.lobe == Lobe::kDiffuse &&
                 (endsAtDiffuse(way) || !aimScattered(surface, bsdf, sampler, sample)))) {
                balance.fluxAbsorbed += channelSum(flux);
                return landed;
            }
            Rgb scattered = flux * sample.weight * (keeps ? survival : 1.0f);
            way.isUnmet = way.isUnmet && isDelta(sample.lobe);
            if (!advance(part, sample.lobe, sampler, scattered)) {
                balance.fluxAbsorbed += channelSum(flux);
                return landed;
            }
            if (!isFinite(scattered)) break;
            balance.fluxAbsorbed += channelSum(flux) - channelSum(scattered);
            flux = scattered;
            const Viewers viewer = ray.viewer;
            ray = sample.lobe == Lobe::kDiffuse
                      ? m_scene.rayOnwards(surface.position, bsdf.facingGeometricNormal(),
                                           sample.direction)
                      : rayFrom(surface, sample.direction);
            if (sample.lobe == Lobe::kStraight)
                ray.viewer = viewer;
            else
                way.pastShadowless = way.pastMirrorless = false;
            const float goesOn = events.add(survival);
            if (goesOn < survival) {
                balance.fluxAbsorbed += channelSum(flux);
                if (!(sampler.next1D() * survival < goesOn)) return landed;
                flux *= survival / goesOn;
                balance.fluxAbsorbed -= channelSum(flux);
            }
            if (events.isOver()) break;
        }
        ++balance.lost;
        balance.fluxLost += channelSum(flux);
        return landed;
    }

    // On its way from a light, where a surface is hidden from shadow rays or from others. What a
    // shadow ray would go by, from where light is scattered to the lamp, is other than what a ray
    // by way of a mirror would; a photon goes by both until it is scattered. What is hidden from
    // shadow rays alone it meets, for rays of mirrors, and passes, for those of shadows: by
    // chance one, for both. Hidden from others alone it stops at it, but for mirrors beyond.
    bool passesHidden(Part& part, const Surface& surface, Sampler& sampler,
                      PhotonBalance& balance) const {
        const bool isShadowless = m_scene.isHiddenFrom(surface.shape, kShadowRays);
        if (!isShadowless && !m_scene.isHiddenFrom(surface.shape, kReflectionRays)) return false;
        if (isShadowless) {
            balance.fluxAbsorbed -= channelSum(part.flux);
            part.flux *= 2.0f;
            if (sampler.next1D() < 0.5f) return false;
            part.way.pastShadowless = true;
        } else {
            part.way.pastMirrorless = true;
        }
        const Viewers viewer = part.ray.viewer;
        part.ray = rayFrom(surface, part.ray.direction);
        part.ray.viewer = viewer;
        return true;
    }

    static float probabilityOfAll(const Bsdf& bsdf) {
        if (bsdf.isDiffuseOnly()) return bsdf.probability(Lobe::kDiffuse);
        float sum = 0.0f;
        for (std::size_t i = 0; i < kLobeCount; ++i) sum += bsdf.probability(static_cast<Lobe>(i));
        return std::min(sum, 1.0f);
    }

    static bool isDiffuseOrStraight(const Bsdf& bsdf) {
        return bsdf.isDiffuseOnly() ||
               !(bsdf.has(bsdf.glossyLobe()) || bsdf.has(Lobe::kReflection) ||
                 bsdf.has(Lobe::kRefraction));
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
        return isCaustic(m_request.kind) && part.events.count() < kDividedEvents &&
               part.way.stage <= Stage::kSpecular && bsdf.has(Lobe::kReflection) &&
               bsdf.has(Lobe::kRefraction) && !bsdf.has(Lobe::kStraight) &&
               !m_scene.viewersDiffer();
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
            next.events.add(survival);
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
    bool advance(Part& part, Lobe lobe, Sampler& sampler, Rgb& flux) const {
        Way& way = part.way;
        if (lobe == Lobe::kStraight) return true;
        if (lobe == Lobe::kBroad) {
            if (way.stage == Stage::kStraight) way.stage = Stage::kDiffuse;
            if (way.stage == Stage::kDescended) way.stage = Stage::kBroadened;
        } else if (lobe != Lobe::kDiffuse) {
            if (way.stage == Stage::kStraight) way.stage = Stage::kSpecular;
            if (way.stage == Stage::kDescended || way.stage == Stage::kBroadened)
                way.stage = Stage::kRefocused;
        } else if (way.stage == Stage::kStraight) {
            way.stage = Stage::kDiffuse;
        } else if (way.stage == Stage::kSpecular) {
            way.stage = Stage::kDescended;
            if (isCaustic(m_request.kind))
                way.isFollowed = m_chains.areOn() ? m_chains.begins(part.chain.index)
                                                  : sampler.next1D() < m_request.descent;
        } else if (way.stage == Stage::kDescended || way.stage == Stage::kBroadened ||
                   way.stage == Stage::kRefocused) {
            way.stage = Stage::kLater;
            if (isCaustic(m_request.kind)) flux *= 1.0f / m_request.descent;
            if (!way.isFollowed) return false;
        }
        if (lobe != Lobe::kDiffuse || part.chain.landings == 0) return true;
        const float factor = m_chains.goOn(part.chain);
        flux *= factor;
        return factor > 0.0f;
    }

    // Nothing that comes after a diffuse scattering on this way is asked for.
    bool endsAtDiffuse(const Way& way) const {
        if (isCaustic(m_request.kind))
            return way.stage == Stage::kStraight || m_request.descent == 0.0f || !way.isFollowed;
        return way.stage == Stage::kSpecular && m_request.withoutCaustics;
    }

    // The same by a broad lobe: light that comes straight from there is no caustic.
    bool endsAtBroad(const Way& way) const {
        return isCaustic(m_request.kind) && way.stage == Stage::kStraight;
    }

    // Stores a photon where its way is asked for. Returns its flux if so; of light that descends
    // from caustics 0.
    double land(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                Batch& batch) const {
        const Way& way = part.way;
        const Rgb& flux = part.flux;
        if (isCaustic(m_request.kind)) {
            if (way.stage == Stage::kSpecular)
                store(surface, bsdf, flux, batch, batch.photons);
            else if (way.stage != Stage::kStraight)
                landDescended(part, surface, bsdf, sampler, batch);
            return way.stage == Stage::kSpecular ? channelSum(flux) : 0;
        }
        if (way.stage == Stage::kSpecular && m_request.withoutCaustics) return 0;
        storeOfChain(part, surface, bsdf, sampler, batch, batch.photons);
        return channelSum(flux);
    }

    // Stores a photon where a lobe that is neither diffuse nor delta receives it as a caustic.
    // Returns its flux if so.
    static double receive(const Part& part, const Surface& surface, const Bsdf& bsdf,
                          Batch& batch) {
        const Way& way = part.way;
        const Lobe lobe = bsdf.glossyLobe();
        if (way.stage != Stage::kSpecular || !bsdf.has(lobe)) return 0;
        if (!bsdf.isWide(lobe) && !way.isUnmet) return 0;
        batch.received.push_back(
            {{surface.position, part.flux, PackedNormal(bsdf.facingGeometricNormal())},
             PackedDirection(-part.ray.direction)});
        if (way.isUnmet) batch.received.back().photon.normal.mark();
        ++batch.balance.stored;
        return bsdf.has(Lobe::kDiffuse) ? 0 : channelSum(part.flux);
    }

    // What caustics send straight to a surface, or by broad lobes, is even: the share that is
    // followed carries it.
    void landDescended(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                       Batch& batch) const {
        const Way& way = part.way;
        if (way.stage == Stage::kLater)
            return storeOfChain(part, surface, bsdf, sampler, batch, batch.descended);
        const bool isStraight = way.stage == Stage::kDescended || way.stage == Stage::kBroadened;
        if (isStraight && !way.isFollowed) return;
        store(surface, bsdf, isStraight ? part.flux * (1.0f / m_request.descent) : part.flux, batch,
              batch.descended);
        if (way.stage == Stage::kRefocused) batch.descended.back().normal.mark();
    }

    void storeOfChain(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                      Batch& batch, std::vector<Photon>& photons) const {
        if (!m_chains.areOn()) return store(surface, bsdf, part.flux, batch, photons);
        const auto flux = static_cast<float>(channelSum(part.flux));
        LongChains::land(part.chain, flux);
        const float probability = m_chains.storing(part.chain, flux);
        if (probability < 1.0f && !(sampler.next1D() < probability)) return;
        store(surface, bsdf, part.flux * (1.0f / probability), batch, photons);
    }

    static void store(const Surface& surface, const Bsdf& bsdf, const Rgb& flux, Batch& batch,
                      std::vector<Photon>& photons) {
        photons.push_back({surface.position, flux * (bsdf.normalRatio() * bsdf.arrival()),
                           PackedNormal(bsdf.facingGeometricNormal())});
        ++batch.balance.stored;
    }

    const Scene& m_scene;
    const LightSampler& m_lights;
    const PhotonTraceRequest& m_request;
    const AimedEmission* m_aim;
    LongChains m_chains;
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

// The first round's batches, and the fewest of any.
constexpr std::size_t kFirstRound = 16;
// Of what a round gave there are its batches, which have grown, and what is joined of them.
constexpr std::uint64_t kCopies = 3;

// Those of the request from batch `first` on, in parallel.
void traceBatches(const PhotonWalk& walk, const PhotonTraceRequest& request, std::size_t first,
                  std::vector<Batch>& batches, const std::atomic<bool>& cancelled,
                  const std::function<void(double)>& progress) {
    const auto all = static_cast<double>((request.count + kBatchSize - 1) / kBatchSize);
    std::mutex progressMutex;
    std::size_t done = first;
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
        if (cancelled.load(std::memory_order_relaxed)) return;
        const std::uint64_t end = std::min(request.count, (first + b + 1) * kBatchSize);
        // Where next to nothing is absorbed a single photon takes its time.
        for (std::uint64_t i = (first + b) * kBatchSize;
             i < end && !cancelled.load(std::memory_order_relaxed); ++i)
            walk.trace(i, batches[b]);
        if (!progress) return;
        const std::lock_guard lock(progressMutex);
        progress(static_cast<double>(++done) / all);
    });
}

PhotonTraceResult joined(std::vector<Batch>& batches, const CancelCheck& check) {
    PhotonTraceResult part;
    join(batches, &Batch::photons, part.photons, check);
    join(batches, &Batch::descended, part.descended, check);
    join(batches, &Batch::received, part.received, check);
    join(batches, &Batch::records, part.records, check);
    return part;
}

std::uint64_t bytesOf(const PhotonTraceResult& part) {
    return (part.photons.size() + part.descended.size()) * sizeof(Photon) +
           part.received.size() * sizeof(ReceivedPhoton) +
           part.records.size() * sizeof(EmissionRecord);
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

PhotonTraceResult traceInRounds(const Scene& scene, const LightSampler& lights,
                                const PhotonTraceRequest& request,
                                const std::atomic<bool>& cancelled,
                                const std::function<void(double)>& progress,
                                const TraceRounds& rounds) {
    PhotonTraceResult sums;
    if (request.aim) sums.focus = request.aim->focus();
    if (request.count == 0 || lights.empty()) return sums;
    const PhotonWalk walk(scene, lights, request);
    const CancelCheck check(cancelled);
    const std::size_t batchCount = (request.count + kBatchSize - 1) / kBatchSize;
    std::size_t size = rounds.bytes == TraceRounds::kAll ? batchCount : kFirstRound;
    for (std::size_t first = 0; first < batchCount;) {
        std::vector<Batch> batches(std::min(size, batchCount - first));
        traceBatches(walk, request, first, batches, cancelled, progress);
        check.throwIfSet("tracing photons");
        PhotonTraceResult part = joined(batches, check);
        for (const Batch& batch : batches) {
            sums.balance += batch.balance;
            sums.metCaster += batch.metCaster;
        }
        first += batches.size();
        // Where next to nothing landed that is more than any number can hold.
        const double fitting = static_cast<double>(rounds.bytes / kCopies) *
                               static_cast<double>(batches.size()) /
                               static_cast<double>(bytesOf(part) + 1);
        size =
            std::max(kFirstRound,
                     static_cast<std::size_t>(std::min(fitting, static_cast<double>(batchCount))));
        rounds.take(std::move(part));
    }
    return sums;
}

PhotonTraceResult tracePhotons(const Scene& scene, const LightSampler& lights,
                               const PhotonTraceRequest& request,
                               const std::atomic<bool>& cancelled,
                               const std::function<void(double)>& progress) {
    PhotonTraceResult all;
    const PhotonTraceResult sums =
        traceInRounds(scene, lights, request, cancelled, progress,
                      {TraceRounds::kAll, [&](PhotonTraceResult part) { all = std::move(part); }});
    all.balance = sums.balance;
    all.focus = sums.focus;
    all.metCaster = sums.metCaster;
    return all;
}

}  // namespace pm
