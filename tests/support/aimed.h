// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/trace/photon_tracer.h"

namespace pm::test {

inline const std::atomic<bool> kNotCancelled{false};

// Aimed emission that has learned from a pilot, unless told not to.
struct Aimed {
    std::shared_ptr<const Scene> scene;
    LightSampler lights;
    AimedEmission aim;

    explicit Aimed(std::shared_ptr<const Scene> scene_, bool learn = true)
        : scene(std::move(scene_)), lights(*scene), aim(*scene, lights) {
        if (learn) aim.refine(trace(PhotonKind::kCausticPilot, 20'000, 1, true).records);
    }
    PhotonTraceResult trace(PhotonKind kind, std::uint64_t count, std::uint64_t seed,
                            bool aimed) const {
        PhotonTraceRequest request{kind, count, seed, 0};
        request.aim = aimed ? &aim : nullptr;
        request.keepRecords = kind == PhotonKind::kCausticPilot;
        return tracePhotons(*scene, lights, request, kNotCancelled, {});
    }
};

}  // namespace pm::test
