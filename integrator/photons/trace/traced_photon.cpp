// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/traced_photon.h"

#include <algorithm>
#include <cmath>

namespace pm {

namespace {

// Glass reflects 4 % of most light, often to where it is all there is: there so little flux would
// lie in a few bright photons. So the smaller part of a photon that divides goes on at least so
// often. See docs/decisions.md.
constexpr float kLeastShare = 0.2f;
// Branches of a photon's numbers: what comes before is for the lobes that it divides by.
constexpr std::uint32_t kFirstCopy = 16;
// What corrections for shading normals may come to before a photon is evened out.
constexpr float kLeastExcess = 0.5f, kMostExcess = 2.0f;

}  // namespace

void TracedPhoton::setOut(PhotonStep& photon) {
    ++m_batch.balance.rays;
    photon.footprint = m_scene.coneAround(photon.ray.direction, photon.width);
    m_before = channelSum(photon.carried);
}

void TracedPhoton::meetNothing(const PhotonStep& photon) {
    m_batch.balance.fluxEscaped += channelSum(photon.carried);
}

Verdict TracedPhoton::meet(PhotonStep& photon, const Surface& surface) {
    m_batch.balance.fluxAbsorbed += m_before - channelSum(photon.carried);
    photon.width = photon.footprint.width();
    if (!m_scene.viewersDiffer() || photon.stage != PhotonStage::kStraight ||
        !passesHidden(photon, surface))
        return Verdict::kScatter;
    photon.events.add(1.0f);
    if (!photon.events.isOver()) return Verdict::kPass;
    lose(photon);
    return Verdict::kEnd;
}

bool TracedPhoton::scatter(PhotonStep& photon, Surface& surface, const Bsdf& bsdf,
                           Waiting<PhotonStep>& waiting) {
    if (bsdf.has(Lobe::kDiffuse) && !photon.pastMirrorless) {
        surface.position =
            m_scene.pointUnderRay(surface.position, photon.ray, bsdf.facingGeometricNormal());
        m_landed += land(photon, surface, bsdf);
    }
    if (m_request.received) m_landed += receive(photon, surface, bsdf);
    const bool fromLight = photon.stage == PhotonStage::kStraight;
    if (divides(photon, bsdf)) {
        m_batch.metCaster += fromLight;
        return divide(photon, surface, bsdf, waiting);
    }
    m_batch.metCaster += fromLight && !isDiffuseOrStraight(bsdf);
    return goOn(photon, surface, bsdf, waiting);
}

int TracedPhoton::evenOut(PhotonStep& photon, float factor, Rgb& flux) {
    photon.excess *= factor;
    if (photon.excess > kLeastExcess && photon.excess < kMostExcess) return 1;
    const float copies = std::floor(photon.excess + photon.random.get1D(Purpose::kCopies));
    flux *= 1.0f / photon.excess;
    photon.excess = 1.0f;
    return static_cast<int>(copies);
}

bool TracedPhoton::goOn(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                        Waiting<PhotonStep>& waiting) {
    PhotonBalance& balance = m_batch.balance;
    Rgb& flux = photon.carried;
    const float survival = probabilityOfAll(bsdf);
    const bool keeps =
        LongChains::keeps(photon.chain, static_cast<float>(channelSum(flux)) * survival);
    if ((bsdf.isDiffuseOnly() && endsAtDiffuse(photon)) || photon.isVoid()) return absorb(photon);
    BsdfSample sample;
    const float uLobe = photon.random.get1D(Purpose::kLobe) * (keeps ? survival : 1.0f);
    if (!bsdf.sample(uLobe, photon.random.get2D(Purpose::kDirection), sample) ||
        !mayLeave(photon, surface, bsdf, sample))
        return absorb(photon);
    Rgb scattered = flux * sample.weight;
    const float factor = sample.lobe == Lobe::kDiffuse
                             ? 1.0f
                             : static_cast<float>(channelSum(scattered) / channelSum(flux));
    if (keeps) scattered *= survival;
    photon.isUnmet = photon.isUnmet && isDelta(sample.lobe);
    if (photon.stage == PhotonStage::kStraight && sample.lobe == Lobe::kWide)
        photon.beganFrosted = bsdf.isFrosted();
    if (!advance(photon, sample.lobe, scattered)) return absorb(photon);
    if (!isFinite(scattered)) return lose(photon);
    const int copies = evenOut(photon, factor, scattered);
    if (copies == 0) return absorb(photon);
    balance.fluxAbsorbed += channelSum(flux) - copies * channelSum(scattered);
    flux = scattered;
    if (!outlives(photon, survival, copies)) return false;
    if (photon.events.isOver()) return lose(photon);
    if (sample.lobe != Lobe::kStraight) photon.pastShadowless = photon.pastMirrorless = false;
    photon.goOn(sample.lobe == Lobe::kDiffuse
                    ? m_scene.rayOnwards(surface.position, bsdf.facingGeometricNormal(),
                                         sample.direction, surface.time)
                    : rayFrom(surface, sample.direction),
                sample.lobe);
    for (int i = 1; i < copies; ++i) {
        PhotonStep copy = photon;
        copy.random = photon.random.branch(kFirstCopy + static_cast<std::uint32_t>(i));
        waiting.add(copy);
    }
    return true;
}

bool TracedPhoton::outlives(PhotonStep& photon, float survival, int copies) {
    const float goesOn = photon.events.add(survival);
    if (!(goesOn < survival)) return true;
    double& absorbed = m_batch.balance.fluxAbsorbed;
    absorbed += copies * channelSum(photon.carried);
    if (!(photon.random.get1D(Purpose::kRoulette) * survival < goesOn)) return false;
    photon.carried *= survival / goesOn;
    absorbed -= copies * channelSum(photon.carried);
    return true;
}

bool TracedPhoton::mayLeave(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                            BsdfSample& sample) const {
    if (!photon.mayGoOnBy(sample.lobe)) return false;
    if (sample.lobe == Lobe::kBroad) return !endsAtBroad(photon);
    return sample.lobe != Lobe::kDiffuse ||
           (!endsAtDiffuse(photon) && aimScattered(photon, surface, bsdf, sample));
}

bool TracedPhoton::absorb(const PhotonStep& photon) {
    m_batch.balance.fluxAbsorbed += channelSum(photon.carried);
    return false;
}

bool TracedPhoton::lose(const PhotonStep& photon) {
    ++m_batch.balance.lost;
    m_batch.balance.fluxLost += channelSum(photon.carried);
    return false;
}

bool TracedPhoton::passesHidden(PhotonStep& photon, const Surface& surface) {
    const bool isShadowless = m_scene.isHiddenFrom(surface.shape, kShadowRays);
    if (!isShadowless && !m_scene.isHiddenFrom(surface.shape, kReflectionRays)) return false;
    if (isShadowless) {
        m_batch.balance.fluxAbsorbed -= channelSum(photon.carried);
        photon.carried *= 2.0f;
        if (photon.random.get1D(Purpose::kHidden) < 0.5f) return false;
        photon.pastShadowless = true;
    } else {
        photon.pastMirrorless = true;
    }
    photon.goOn(rayFrom(surface, photon.ray.direction), Lobe::kStraight);
    return true;
}

float TracedPhoton::probabilityOfAll(const Bsdf& bsdf) {
    if (bsdf.isDiffuseOnly()) return bsdf.probability(Lobe::kDiffuse);
    float sum = 0.0f;
    for (std::size_t i = 0; i < kLobeCount; ++i) sum += bsdf.probability(static_cast<Lobe>(i));
    return std::min(sum, 1.0f);
}

bool TracedPhoton::isDiffuseOrStraight(const Bsdf& bsdf) {
    return bsdf.isDiffuseOnly() ||
           !(bsdf.isShiny() || bsdf.has(Lobe::kReflection) || bsdf.has(Lobe::kRefraction));
}

bool TracedPhoton::aimScattered(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                                BsdfSample& sample) const {
    if (!m_aim || !m_aim->scattersFrom(surface.position)) return true;
    float pdf;
    if (!m_aim->scatter(surface.position, bsdf.diffuseAxis(), photon.random.get1D(Purpose::kAim),
                        photon.random.get2D(Purpose::kAimedDirection), sample.direction, pdf))
        return false;
    sample.weight =
        bsdf.evaluate(Lobe::kDiffuse, sample.direction) / (pdf * bsdf.probability(Lobe::kDiffuse));
    return !isBlack(sample.weight);
}

bool TracedPhoton::divides(const PhotonStep& photon, const Bsdf& bsdf) const {
    return isCaustic(m_request.kind) && photon.events.count() < kDividedEvents &&
           photon.stage <= PhotonStage::kSpecular && bsdf.has(Lobe::kReflection) &&
           bsdf.has(Lobe::kRefraction) && !bsdf.has(Lobe::kStraight) && !m_scene.viewersDiffer();
}

bool TracedPhoton::divide(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                          Waiting<PhotonStep>& waiting) {
    PhotonBalance& balance = m_batch.balance;
    const float all = bsdf.probability(Lobe::kReflection) + bsdf.probability(Lobe::kRefraction);
    const auto goesOn = [&](Lobe lobe, PhotonStep& next) {
        const float share = bsdf.probability(lobe) / all;
        const float survival = all * (share < 0.5f ? std::max(share, kLeastShare) : 1.0f);
        const float u = next.random.get1D(Purpose::kLobe);
        BsdfSample sample;
        if (!(u < survival) || !bsdf.follow(lobe, sample, {{u / survival, 0.0f}, 0.0f}))
            return false;
        next.carried *= sample.weight * (1.0f / survival);
        next.stage = PhotonStage::kSpecular;
        next.events.add(survival);
        next.goOn(rayFrom(surface, sample.direction), lobe);
        balance.fluxAbsorbed -= channelSum(next.carried);
        return true;
    };
    balance.fluxAbsorbed += channelSum(photon.carried);
    PhotonStep reflection = photon;
    reflection.random = photon.random.branch(static_cast<std::uint32_t>(Lobe::kReflection));
    if (goesOn(Lobe::kReflection, reflection)) waiting.add(reflection);
    return goesOn(Lobe::kRefraction, photon);
}

bool TracedPhoton::advance(PhotonStep& photon, Lobe lobe, Rgb& flux) const {
    const PhotonStage before = photon.stage;
    photon.stage = stageAfter(before, lobe);
    if (lobe != Lobe::kDiffuse) return true;
    if (isCaustic(m_request.kind)) {
        if (before == PhotonStage::kSpecular)
            photon.isFollowed = m_chains.areOn()
                                    ? m_chains.begins(photon.chain.index)
                                    : photon.random.get1D(Purpose::kDescent) < m_request.descent;
        else if (photon.stage == PhotonStage::kLater && before != PhotonStage::kLater)
            flux *= 1.0f / m_request.descent;
    }
    if (photon.stage == PhotonStage::kLater && before != PhotonStage::kLater && !photon.isFollowed)
        return false;
    if (photon.chain.landings == 0) return true;
    const float factor = m_chains.goOn(photon.chain);
    flux *= factor;
    return factor > 0.0f;
}

bool TracedPhoton::endsAtDiffuse(const PhotonStep& photon) const {
    if (isCaustic(m_request.kind))
        return photon.stage == PhotonStage::kStraight || m_request.descent == 0.0f ||
               !photon.isFollowed;
    return photon.stage == PhotonStage::kSpecular && m_request.withoutCaustics;
}

bool TracedPhoton::endsAtBroad(const PhotonStep& photon) const {
    return isCaustic(m_request.kind) && photon.stage == PhotonStage::kStraight;
}

double TracedPhoton::land(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf) {
    const Rgb& flux = photon.carried;
    if (isCaustic(m_request.kind)) {
        if (photon.stage == PhotonStage::kSpecular)
            store(photon, surface, bsdf, flux, m_batch.photons);
        else if (photon.stage != PhotonStage::kStraight)
            landDescended(photon, surface, bsdf);
        return photon.stage == PhotonStage::kSpecular ? channelSum(flux) : 0;
    }
    if (photon.stage == PhotonStage::kSpecular && m_request.withoutCaustics) return 0;
    storeOfChain(photon, surface, bsdf, m_batch.photons);
    return channelSum(flux);
}

double TracedPhoton::receive(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf) {
    if (photon.stage != PhotonStage::kSpecular || !bsdf.isShiny()) return 0;
    if (!bsdf.has(Lobe::kWide) && !bsdf.has(Lobe::kBroad) && !photon.isUnmet) return 0;
    if (photon.beganFrosted && bsdf.isFrosted()) return 0;
    m_batch.received.push_back(
        {{surface.position, photon.carried, PackedNormal(bsdf.facingGeometricNormal())},
         PackedDirection(-photon.ray.direction)});
    if (photon.isUnmet) m_batch.received.back().photon.normal.mark();
    ++m_batch.balance.stored;
    return bsdf.has(Lobe::kDiffuse) ? 0 : channelSum(photon.carried);
}

void TracedPhoton::landDescended(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf) {
    if (photon.stage == PhotonStage::kLater)
        return storeOfChain(photon, surface, bsdf, m_batch.descended);
    const bool isStraight =
        photon.stage == PhotonStage::kDescended || photon.stage == PhotonStage::kBroadened;
    if (isStraight && !photon.isFollowed) return;
    store(photon, surface, bsdf,
          isStraight ? photon.carried * (1.0f / m_request.descent) : photon.carried,
          m_batch.descended);
    if (photon.stage == PhotonStage::kRefocused) m_batch.descended.back().normal.mark();
}

void TracedPhoton::storeOfChain(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                                std::vector<Photon>& photons) {
    if (!m_chains.areOn()) return store(photon, surface, bsdf, photon.carried, photons);
    const auto flux = static_cast<float>(channelSum(photon.carried));
    LongChains::land(photon.chain, flux);
    const float probability = m_chains.storing(photon.chain, flux);
    if (probability < 1.0f && !(photon.random.get1D(Purpose::kStore) < probability)) return;
    store(photon, surface, bsdf, photon.carried * (1.0f / probability), photons);
}

void TracedPhoton::store(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                         const Rgb& flux, std::vector<Photon>& photons) {
    photons.push_back({surface.position, flux * (bsdf.normalRatio() * bsdf.arrival()),
                       PackedNormal(bsdf.facingGeometricNormal())});
    photons.back().normal.setClass(photon.of);
    ++m_batch.balance.stored;
}

}  // namespace pm
