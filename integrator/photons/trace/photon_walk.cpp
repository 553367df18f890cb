// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/photon_walk.h"

namespace pm {

Sampler PhotonWalk::samplerOf(std::uint64_t index) const {
    // Even streams are cameras'; see FrameRenderer.
    return {m_request.seed, 2 * std::uint64_t{m_request.pass} + 1,
            static_cast<std::uint64_t>(m_request.kind), static_cast<std::uint32_t>(index)};
}

std::optional<Ray> PhotonWalk::firstRay(std::uint64_t index) const {
    const Sampler sampler = samplerOf(index);
    AimedPhoton photon;
    if (!emit(sampler, photon)) return std::nullopt;
    return photon.ray;
}

void PhotonWalk::trace(std::uint64_t index, Batch& batch) const {
    const Sampler sampler = samplerOf(index);
    AimedPhoton photon;
    ++batch.balance.emitted;
    if (!emit(sampler, photon)) return;
    photon.flux *= m_scale;
    batch.balance.fluxEmitted += channelSum(photon.flux);
    const double landed = follow(photon, static_cast<std::uint32_t>(index), sampler, batch);
    if (m_aim && m_request.keepRecords)
        batch.records.push_back({photon.light, photon.caster,
                                 static_cast<float>(channelSum(photon.flux)),
                                 static_cast<float>(landed), photon.part});
}

bool PhotonWalk::emit(const Sampler& sampler, AimedPhoton& photon) const {
    const Vec2f uPoint = sampler.get2D(Purpose::kPlace);
    const Vec2f uDirection = sampler.get2D(Purpose::kDirection);
    return m_aim ? m_aim->emit(sampler.get2D(Purpose::kLight), uPoint, uDirection, photon)
                 : m_lights.emit(sampler.get1D(Purpose::kLight), uPoint, uDirection, photon);
}

double PhotonWalk::follow(const AimedPhoton& photon, std::uint32_t index, const Sampler& sampler,
                          Batch& batch) const {
    PhotonStep first{{photon.ray, {}, sampler, photon.flux}};
    first.random.nextEvent();
    first.chain.index = index;
    first.isUnmet = !photon.isMet;
    first.light = photon.light;
    if (m_scene.viewersDiffer()) first.ray.viewer = kShadowRays | kReflectionRays;
    TracedPhoton traced(m_scene, m_request, m_aim, m_chains, batch);
    walk(m_scene, traced, first);
    return traced.landed();
}

}  // namespace pm
