// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/photons/trace/long_chains.h"
#include "integrator/scene/scene.h"

namespace pm {

// What became of the light that was emitted, as the photons carry it (of aimed ones that is what
// the lights give on the average only); flux in W, summed over the channels. emitted = absorbed +
// escaped + lost, to rounding, before photons are stored as floats.
struct PhotonBalance {
    std::uint64_t emitted = 0, stored = 0, lost = 0, rays = 0;
    double fluxEmitted = 0, fluxAbsorbed = 0, fluxEscaped = 0, fluxLost = 0;

    PhotonBalance& operator+=(const PhotonBalance& other);
    friend bool operator==(const PhotonBalance&, const PhotonBalance&) = default;
};

// Into so many a caustic photon divides at glass, at most as a rule.
inline constexpr double kCausticParts = 1.44;

enum class PhotonKind : std::uint8_t {
    kGlobal,       // every arrival at a diffuse surface
    kGlobalPilot,  // as kGlobal and kCaustic, with random numbers of their own: to find radii
    kCausticPilot,
    kCaustic,  // the first arrival at a diffuse surface, and only by way of at least one other lobe
};

constexpr bool isCaustic(PhotonKind kind) {
    return kind == PhotonKind::kCaustic || kind == PhotonKind::kCausticPilot;
}

struct PhotonTraceRequest {
    PhotonKind kind = PhotonKind::kGlobal;
    std::uint64_t count = 0;  // photons to emit, up to 2^32
    std::uint64_t seed = 1;
    std::uint32_t pass = 0;
    // Of the same scene, at casters or, for global photons, at a focus; null or empty: unaimed.
    const AimedEmission* aim = nullptr;
    // Caustic photons: the share of those that landed which is followed on, as light descended from
    // caustics, in [0, 1]; 0: none is. All are as far as to where they are refocused.
    float descent = 0.0f;
    // Global photons: light whose first diffuse surface comes by way of another lobe is somebody
    // else's business and ends there.
    bool withoutCaustics = false;
    bool keepRecords = false;  // for AimedEmission::refine
    // Caustic photons: whether those that glossy and broad lobes receive are asked for as well.
    bool received = false;
    // Where photons land very often: of those that landed, one in so many goes on (LongChains), a
    // power of two. 0: all go on, and all landings are stored.
    std::uint32_t oneInChains = 0;
};

struct PhotonTraceResult {
    BigVector<Photon> photons;  // flux of each already divided by the number emitted
    PhotonBalance balance;
    // Of caustic photons the arrivals after the first. Marked where light that a caustic sends out
    // comes by way of other lobes before it meets another diffuse surface: refocused.
    BigVector<Photon> descended;
    // Of caustic photons the arrivals at broad lobes and wide glossy ones before a diffuse one has
    // scattered them, but for those in frosted glass that came in through such: paths find those.
    // Marked, and at narrow glossy lobes, too: of lights that no ray meets, by way of delta lobes
    // alone, which no path from the camera finds.
    BigVector<ReceivedPhoton> received;
    BigVector<EmissionRecord> records;  // of each photon that carried something, if asked for
    Focus focus;                        // that global photons were aimed at
    // Of the caustic ones, those that began by another lobe than a diffuse one.
    std::uint64_t metCaster = 0;
};

// Traces photons from the lights, in parallel in the calling TBB arena: batches of fixed size, each
// photon's random numbers a function of (seed, kind, pass, index), the batches joined in order. So
// the result is the same bits for any number of threads. progress: fraction, one call at a time,
// may be empty. Throws Error(kCancelled) soon after `cancelled` is set.
PhotonTraceResult tracePhotons(const Scene& scene, const LightSampler& lights,
                               const PhotonTraceRequest& request,
                               const std::atomic<bool>& cancelled,
                               const std::function<void(double)>& progress);

// What was traced is taken in rounds.
struct TraceRounds {
    static constexpr std::uint64_t kAll = ~std::uint64_t{0};  // one round

    std::uint64_t bytes = kAll;  // about so many at once, copies included; at least 8192 photons'
    // Takes the photons and records of a round, which follow those of the round before.
    std::function<void(PhotonTraceResult part)> take;
};
// tracePhotons() in rounds; returns all but photons and records. The same bits for any rounds.
// Errors: those of take, too.
PhotonTraceResult traceInRounds(const Scene& scene, const LightSampler& lights,
                                const PhotonTraceRequest& request,
                                const std::atomic<bool>& cancelled,
                                const std::function<void(double)>& progress,
                                const TraceRounds& rounds);

}  // namespace pm
