// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/photon_walk.h"

#include <algorithm>

#include "integrator/paths/segment.h"

namespace pm {

namespace {

// Glass reflects 4 % of most light, often to where it is all there is: there so little flux would
// lie in a few bright photons. So the smaller part of a photon that divides goes on at least so
// often. See docs/decisions.md.
constexpr float kLeastShare = 0.2f;

}  // namespace

Sampler PhotonWalk::samplerOf(std::uint64_t index) const {
    // Even streams are cameras'; see FrameRenderer.
    return {m_request.seed, 2 * std::uint64_t{m_request.pass} + 1,
            static_cast<std::uint64_t>(m_request.kind), static_cast<std::uint32_t>(index)};
}

std::optional<Ray> PhotonWalk::firstRay(std::uint64_t index) const {
    Sampler sampler = samplerOf(index);
    AimedPhoton photon;
    if (!emit(sampler, photon)) return std::nullopt;
    return photon.ray;
}

void PhotonWalk::trace(std::uint64_t index, Batch& batch) const {
    Sampler sampler = samplerOf(index);
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

bool PhotonWalk::emit(Sampler& sampler, AimedPhoton& photon) const {
    Vec2f uChoice;
    if (m_aim)
        uChoice = sampler.next2D();
    else
        uChoice.x = sampler.next1D();
    const Vec2f uPoint = sampler.next2D(), uDirection = sampler.next2D();
    return m_aim ? m_aim->emit(uChoice, uPoint, uDirection, photon)
                 : m_lights.emit(uChoice.x, uPoint, uDirection, photon);
}

double PhotonWalk::walk(const EmittedPhoton& photon, std::uint32_t index, Sampler& sampler,
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

double PhotonWalk::walk(Part part, Sampler& sampler, Waiting& waiting, Batch& batch) const {
    PhotonBalance& balance = batch.balance;
    auto& [ray, flux, chain, way, events, width, of] = part;
    double landed = 0;
    while (true) {
        Surface surface;
        ++balance.rays;
        RayFootprint footprint = m_scene.coneAround(ray.direction, width);
        const double before = channelSum(flux);
        if (!meet(m_scene, ray, surface, &footprint, flux)) {
            balance.fluxEscaped += channelSum(flux);
            return landed;
        }
        balance.fluxAbsorbed += before - channelSum(flux);
        width = footprint.width();
        if (m_scene.viewersDiffer() && way.stage == Stage::kStraight &&
            passesHidden(part, surface, sampler, balance)) {
            events.add(1.0f);
            if (events.isOver()) break;
            continue;
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
                                       sample.direction, surface.time)
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

bool PhotonWalk::passesHidden(Part& part, const Surface& surface, Sampler& sampler,
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

float PhotonWalk::probabilityOfAll(const Bsdf& bsdf) {
    if (bsdf.isDiffuseOnly()) return bsdf.probability(Lobe::kDiffuse);
    float sum = 0.0f;
    for (std::size_t i = 0; i < kLobeCount; ++i) sum += bsdf.probability(static_cast<Lobe>(i));
    return std::min(sum, 1.0f);
}

bool PhotonWalk::isDiffuseOrStraight(const Bsdf& bsdf) {
    return bsdf.isDiffuseOnly() ||
           !(bsdf.isShiny() || bsdf.has(Lobe::kReflection) || bsdf.has(Lobe::kRefraction));
}

bool PhotonWalk::aimScattered(const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                              BsdfSample& sample) const {
    if (!m_aim || !m_aim->scattersFrom(surface.position)) return true;
    float pdf;
    const float uChoice = sampler.next1D();
    if (!m_aim->scatter(surface.position, bsdf.diffuseAxis(), uChoice, sampler.next2D(),
                        sample.direction, pdf))
        return false;
    sample.weight =
        bsdf.evaluate(Lobe::kDiffuse, sample.direction) / (pdf * bsdf.probability(Lobe::kDiffuse));
    return !isBlack(sample.weight);
}

bool PhotonWalk::divides(const Part& part, const Bsdf& bsdf) const {
    return isCaustic(m_request.kind) && part.events.count() < kDividedEvents &&
           part.way.stage <= Stage::kSpecular && bsdf.has(Lobe::kReflection) &&
           bsdf.has(Lobe::kRefraction) && !bsdf.has(Lobe::kStraight) && !m_scene.viewersDiffer();
}

bool PhotonWalk::divide(Part& part, const Surface& surface, const Bsdf& bsdf, Vec2f u,
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

bool PhotonWalk::advance(Part& part, Lobe lobe, Sampler& sampler, Rgb& flux) const {
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

bool PhotonWalk::endsAtDiffuse(const Way& way) const {
    if (isCaustic(m_request.kind))
        return way.stage == Stage::kStraight || m_request.descent == 0.0f || !way.isFollowed;
    return way.stage == Stage::kSpecular && m_request.withoutCaustics;
}

bool PhotonWalk::endsAtBroad(const Way& way) const {
    return isCaustic(m_request.kind) && way.stage == Stage::kStraight;
}

double PhotonWalk::land(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                        Batch& batch) const {
    const Way& way = part.way;
    const Rgb& flux = part.flux;
    if (isCaustic(m_request.kind)) {
        if (way.stage == Stage::kSpecular)
            store(part, surface, bsdf, flux, batch, batch.photons);
        else if (way.stage != Stage::kStraight)
            landDescended(part, surface, bsdf, sampler, batch);
        return way.stage == Stage::kSpecular ? channelSum(flux) : 0;
    }
    if (way.stage == Stage::kSpecular && m_request.withoutCaustics) return 0;
    storeOfChain(part, surface, bsdf, sampler, batch, batch.photons);
    return channelSum(flux);
}

double PhotonWalk::receive(const Part& part, const Surface& surface, const Bsdf& bsdf,
                           Batch& batch) {
    const Way& way = part.way;
    if (way.stage != Stage::kSpecular || !bsdf.isShiny()) return 0;
    if (!bsdf.has(Lobe::kWide) && !bsdf.has(Lobe::kBroad) && !way.isUnmet) return 0;
    batch.received.push_back(
        {{surface.position, part.flux, PackedNormal(bsdf.facingGeometricNormal())},
         PackedDirection(-part.ray.direction)});
    if (way.isUnmet) batch.received.back().photon.normal.mark();
    ++batch.balance.stored;
    return bsdf.has(Lobe::kDiffuse) ? 0 : channelSum(part.flux);
}

void PhotonWalk::landDescended(Part& part, const Surface& surface, const Bsdf& bsdf,
                               Sampler& sampler, Batch& batch) const {
    const Way& way = part.way;
    if (way.stage == Stage::kLater)
        return storeOfChain(part, surface, bsdf, sampler, batch, batch.descended);
    const bool isStraight = way.stage == Stage::kDescended || way.stage == Stage::kBroadened;
    if (isStraight && !way.isFollowed) return;
    store(part, surface, bsdf, isStraight ? part.flux * (1.0f / m_request.descent) : part.flux,
          batch, batch.descended);
    if (way.stage == Stage::kRefocused) batch.descended.back().normal.mark();
}

void PhotonWalk::storeOfChain(Part& part, const Surface& surface, const Bsdf& bsdf,
                              Sampler& sampler, Batch& batch, std::vector<Photon>& photons) const {
    if (!m_chains.areOn()) return store(part, surface, bsdf, part.flux, batch, photons);
    const auto flux = static_cast<float>(channelSum(part.flux));
    LongChains::land(part.chain, flux);
    const float probability = m_chains.storing(part.chain, flux);
    if (probability < 1.0f && !(sampler.next1D() < probability)) return;
    store(part, surface, bsdf, part.flux * (1.0f / probability), batch, photons);
}

void PhotonWalk::store(const Part& part, const Surface& surface, const Bsdf& bsdf, const Rgb& flux,
                       Batch& batch, std::vector<Photon>& photons) {
    photons.push_back({surface.position, flux * (bsdf.normalRatio() * bsdf.arrival()),
                       PackedNormal(bsdf.facingGeometricNormal())});
    photons.back().normal.setClass(part.of);
    ++batch.balance.stored;
}

}  // namespace pm
