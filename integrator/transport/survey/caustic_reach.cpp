// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/caustic_reach.h"

#include <atomic>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/survey/pilot_passes.h"

namespace pm {

namespace {

// Unaimed ones come first: to find what is to be aimed at takes longer.
constexpr std::uint64_t kUnaimed = 1 << 12, kFirstAimed = 1 << 9;

}  // namespace

bool findsCaustics(const Scene& scene, std::uint64_t seed, const std::atomic<bool>& cancelled) {
    const LightSampler lights = LightSampler::forPhotons(scene);
    PhotonTraceRequest request{PhotonKind::kCausticPilot, kUnaimed, seed, kPilotOfReach};
    request.received = true;
    // Where they land it may be rare, far from where the camera looks: that they go on is enough.
    const auto goOn = [&] {
        const PhotonTraceResult traced = tracePhotons(scene, lights, request, cancelled, {});
        return traced.balance.stored > 0 ||
               (request.keepRecords && traced.balance.rays > traced.records.size());
    };
    if (goOn()) return true;
    const AimedEmission aim(scene, lights);
    if (aim.empty()) return false;
    request.aim = &aim;
    request.keepRecords = true;
    for (request.count = kFirstAimed; request.count < kCausticReachPhotons; request.count *= 8)
        if (goOn()) return true;
    request.count = kCausticReachPhotons;
    return goOn();
}

}  // namespace pm
