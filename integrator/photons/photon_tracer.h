// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "integrator/photons/photon_map.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"

namespace pm {

// What became of the light that was emitted; flux in W, summed over the channels. emitted =
// absorbed
// + escaped + lost, to rounding, before photons are stored as floats.
struct PhotonBalance {
    std::uint64_t emitted = 0, stored = 0, lost = 0, rays = 0;
    double fluxEmitted = 0, fluxAbsorbed = 0, fluxEscaped = 0, fluxLost = 0;

    PhotonBalance& operator+=(const PhotonBalance& other);
};

enum class PhotonKind : std::uint8_t {
    kGlobal,       // every arrival at a diffuse surface
    kSites,        // as kGlobal, with random numbers of their own: where irradiance is kept
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
};

struct PhotonTraceResult {
    std::vector<Photon> photons;  // flux of each already divided by the number emitted
    PhotonBalance balance;
};

// Traces photons from the lights, in parallel in the calling TBB arena: batches of fixed size, each
// photon's random numbers a function of (seed, kind, pass, index), the batches joined in order. So
// the result is the same bits for any number of threads. progress: fraction, one call at a time,
// may be empty. Throws Error(kCancelled) soon after `cancelled` is set.
PhotonTraceResult tracePhotons(const Scene& scene, const LightSampler& lights,
                               const PhotonTraceRequest& request,
                               const std::atomic<bool>& cancelled,
                               const std::function<void(double)>& progress);

}  // namespace pm
