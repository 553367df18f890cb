// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>

#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/photons/trace/traced_photon.h"
#include "integrator/sampling/sampler.h"

namespace pm {

// The way of each photon of a request, from its light on. Threads: trace() from any, at once, each
// with a batch of its own.
class PhotonWalk {
  public:
    using Batch = PhotonBatch;

    // All must outlive this; request.count > 0.
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

    // Photon `index` of the request, added to the batch.
    void trace(std::uint64_t index, Batch& batch) const;
    // The ray on which it leaves its light; nothing where none does.
    std::optional<Ray> firstRay(std::uint64_t index) const;

  private:
    Sampler samplerOf(std::uint64_t index) const;
    bool emit(const Sampler& sampler, AimedPhoton& photon) const;
    // Returns the flux that landed as asked for, W, summed over the channels.
    double follow(const AimedPhoton& photon, std::uint32_t index, const Sampler& sampler,
                  Batch& batch) const;

    const Scene& m_scene;
    const LightSampler& m_lights;
    const PhotonTraceRequest& m_request;
    const AimedEmission* m_aim;
    LongChains m_chains;
    float m_scale;
};

}  // namespace pm
