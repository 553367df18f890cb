// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/bsdf.h"

#include <algorithm>
#include <variant>

#include "integrator/materials/material_lobes.h"
#include "integrator/materials/straight_share.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Nearly all surfaces have the first of the list, which is then called without a table.
template <typename OneOf, typename Call>
decltype(auto) visitMostly(const OneOf& lobe, const Call& call) {
    if (const auto* first = std::get_if<0>(&lobe)) return call(*first);
    return std::visit(call, lobe);
}

// Of a mixture, the part that is all there is at a point, where one is; else the mixture.
std::uint32_t aloneAt(const Materials& materials, const Surface& surface) {
    std::uint32_t index = surface.material;
    while (materials[index].kind == MaterialKind::kMixture) {
        const MaterialDescription& mixture = materials[index];
        const float second = weightAt(materials, mixture, contextAt(surface));
        if ((second > 0.0f && second < 1.0f) ||
            ownOpacityAt(materials, mixture, contextAt(surface)) < 1.0f)
            break;
        index = second > 0.0f ? mixture.second : mixture.first;
    }
    return index;
}

}  // namespace

Bsdf::Bsdf(const Materials& materials, const Surface& surface, const Vec3f& out,
           Transport transport, const Rgb& carried)
    : m_at(out, surface.geometricNormal, surface.shadingNormal, transport) {
    m_at.opacity = opacityAt(materials, surface.material, contextAt(surface));
    m_at.straight = pm::straightShare(materials, surface, m_at.opacity, m_at.isFront);
    m_at.straightEtaSquared =
        pm::straightEtaSquared(materials[surface.material], surface, m_at.isFront);
    const std::uint32_t alone = aloneAt(materials, surface);
    if (materials[alone].kind == MaterialKind::kMixture) {
        addParts(materials, alone, surface, 1.0f);
        addUp();
    } else {
        setLobes(materials, alone, surface, m_at, m_lobes);
    }
    m_lobes.of(Lobe::kStraight) = Straight::reflectance(m_at);
    // A camera path finds no light there, so a photon from there brings none.
    if (m_at.isBehindShading && transport == Transport::kPhotons)
        for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kGlossy, Lobe::kWide, Lobe::kBroad})
            m_lobes.of(lobe) = Rgb();
    m_diffuseOnly = !m_parts.any() && !m_lobes.isSmooth() && isBlack(m_at.straight) &&
                    m_at.opacity == 1.0f && isBlack(reflectance(m_lobes.glossyRole));
    if (m_diffuseOnly) {
        chooseDiffuse(carried);
        return;
    }
    // What goes straight into glass is more radiance, and no more energy.
    if (!m_parts.any() && !isSentByWays(m_lobes, m_at) && m_at.straightEtaSquared == 1.0f)
        limitEnergy(m_lobes, m_at.opacity);
    chooseProbabilities(carried);
}

Bsdf::Bsdf(const HenyeyGreenstein& phase, const Rgb& albedo, const Vec3f& out, Transport transport,
           const Rgb& carried)
    : m_at(out, out, out, transport) {
    m_lobes.glossyRole = Lobe::kBroad;
    m_lobes.glossy = phase;
    m_lobes.of(Lobe::kBroad) = albedo;
    chooseProbabilities(carried);
}

// What smooth lobes send by several ways is as much as the camera gets by each of them.
bool Bsdf::isSentByWays(const Lobes& lobes, const LobePoint& at) {
    return visitMostly(lobes.smooth, [&](const auto& model) { return model.sendsByWays(at); });
}

// What goes straight on is the share of the surface that is not there: none of it is taken.
void Bsdf::limitEnergy(Lobes& lobes, float opacity) {
    const float largest = maxChannel(lobes.sum());
    if (!(largest > 1.0f)) return;
    const Rgb straight = lobes.of(Lobe::kStraight);
    const float factor = opacity / (largest - straight.g);
    for (Rgb& reflectance : lobes.reflectance) reflectance *= factor;
    lobes.of(Lobe::kStraight) = straight;
}

// What chooseProbabilities comes to where there is one lobe; most surfaces are like that.
void Bsdf::chooseDiffuse(const Rgb& carried) {
    const float reflected = meanChannel(carried * reflectance(Lobe::kDiffuse));
    m_black = !(reflected > 0.0f);
    if (m_black) return;
    m_probability[index(Lobe::kDiffuse)] =
        m_at.transport == Transport::kPhotons
            ? reflected / std::max(reflected, meanChannel(carried))
            : 1.0f;
}

void Bsdf::chooseProbabilities(const Rgb& carried) {
    float sum = 0.0f;
    for (std::size_t i = 0; i < kLobeCount; ++i) {
        m_probability[i] = meanChannel(carried * m_lobes.reflectance[i]);
        sum += m_probability[i];
    }
    m_black = !(sum > 0.0f);
    if (m_black) return;
    // Photons die with what is left of their flux, so that the survivors keep its mean.
    const float total =
        m_at.transport == Transport::kPhotons ? std::max(sum, meanChannel(carried)) : sum;
    for (float& p : m_probability) p /= total;
}

Rgb Bsdf::albedo() const {
    return m_lobes.sum();
}

bool Bsdf::goesThrough() const {
    const auto isOne = [](const Lobes& lobes) {
        return std::holds_alternative<RoughGlass>(lobes.glossy) ||
               std::holds_alternative<DiffuseTransmission>(lobes.glossy) ||
               std::holds_alternative<HenyeyGreenstein>(lobes.glossy);
    };
    if (!m_parts.any()) return isOne(m_lobes);
    return std::ranges::any_of(m_parts.all(), [&](const Part& part) { return isOne(part.lobes); });
}

Rgb Bsdf::diffuse() const {
    if (m_parts.any()) return diffuseOfParts();
    const Rgb& ofLobe = reflectance(Lobe::kDiffuse);
    return visitMostly(m_lobes.diffuse,
                       [&](const auto& model) { return model.albedo(m_at, ofLobe); });
}

float Bsdf::arrival() const {
    if (m_parts.any()) return arrivalAtParts();
    return visitMostly(m_lobes.diffuse, [&](const auto& model) { return model.arrival(m_at); });
}

namespace {

std::optional<Admission> admissionOf(const DiffuseLobe& lobe) {
    if (std::holds_alternative<Lambertian>(lobe)) return Admission{};
    const auto* const below = std::get_if<Undercoat>(&lobe);
    if (!below) return std::nullopt;
    return Admission{below->cover, below->mean};
}

}  // namespace

// Of several lobes each has its own, so that only what is even is known of all.
std::optional<Admission> Bsdf::admission() const {
    if (!m_parts.any()) return admissionOf(m_lobes.diffuse);
    std::optional<Admission> found;
    for (const Part& part : m_parts.all()) {
        if (!part.has(Lobe::kDiffuse)) continue;
        const std::optional<Admission> one = admissionOf(part.lobes.diffuse);
        if (!one || (found && !(found->isEven() && one->isEven()))) return std::nullopt;
        found = one;
    }
    return found;
}

Rgb Bsdf::reflectedOf(const Rgb& irradiance) const {
    return irradiance * diffuse() * kInvPi;
}

Rgb Bsdf::evaluate(Lobe lobe, const Vec3f& in) const {
    if (m_parts.any()) return evaluateParts(lobe, in);
    const auto by = [&](const auto& model) { return model.evaluate(m_at, reflectance(lobe), in); };
    if (lobe == Lobe::kDiffuse) return visitMostly(m_lobes.diffuse, by);
    return std::visit(by, m_lobes.glossy);
}

Rgb Bsdf::evaluateSmooth(const Vec3f& in) const {
    if (m_parts.any()) return evaluatePartsSmooth(in);
    LobePoint at = m_at;
    at.ng = at.nd;
    return visitMostly(m_lobes.diffuse, [&](const auto& model) {
        return model.evaluate(at, reflectance(Lobe::kDiffuse), in);
    });
}

float Bsdf::pdfSolidAngle(Lobe lobe, const Vec3f& in) const {
    if (!has(lobe)) return 0.0f;
    const float choice = m_followsAll ? 1.0f : m_probability[index(lobe)];
    if (m_parts.any()) return pdfOfParts(lobe, in, choice);
    const auto by = [&](const auto& model) { return model.pdfSolidAngle(m_at, in, choice); };
    if (lobe == Lobe::kDiffuse) return visitMostly(m_lobes.diffuse, by);
    return std::visit(by, m_lobes.glossy);
}

bool Bsdf::sample(float uLobe, Vec2f u, BsdfSample& sample) const {
    std::size_t i = 0;
    while (i < kLobeCount && uLobe >= m_probability[i]) uLobe -= m_probability[i++];
    if (i == kLobeCount) {
        if (m_at.transport == Transport::kPhotons || m_black) return false;
        // Rounding left a crumb of [0,1) after the last lobe.
        i = static_cast<std::size_t>(std::max_element(m_probability.begin(), m_probability.end()) -
                                     m_probability.begin());
    }
    // What is left of the number that chose the lobe is as good as another.
    const float way = std::clamp(uLobe / m_probability[i], 0.0f, 1.0f - 0x1p-24f);
    return take(static_cast<Lobe>(i), m_probability[i], {u, way}, sample);
}

bool Bsdf::follow(Lobe lobe, BsdfSample& sample, LobeNumbers u) const {
    return has(lobe) && take(lobe, 1.0f, u, sample);
}

bool Bsdf::take(Lobe lobe, float probability, LobeNumbers u, BsdfSample& sample) const {
    sample.lobe = lobe;
    sample.pdfSolidAngle = probability;
    sample.weight = reflectance(lobe) / probability;
    sample.etaSquared = 1.0f;
    if (m_parts.any() && lobe != Lobe::kStraight) return takePart(lobe, probability, u, sample);
    switch (lobe) {
        case Lobe::kDiffuse:
            return takeBy(m_lobes.diffuse, u, sample);
        case Lobe::kGlossy:
        case Lobe::kWide:
        case Lobe::kBroad:
            return takeBy(m_lobes.glossy, u, sample);
        case Lobe::kReflection:
        case Lobe::kRefraction:
            return std::visit([&](const auto& model) { return model.sample(m_at, u.x, sample); },
                              m_lobes.smooth);
        case Lobe::kStraight:
            return Straight::sample(m_at, sample);
    }
    return false;
}

// By a lobe that is not delta.
template <typename OneOfModels>
bool Bsdf::takeBy(const OneOfModels& lobe, LobeNumbers u, BsdfSample& sample) const {
    const bool hasValue =
        visitMostly(lobe, [&](const auto& model) { return model.sample(m_at, u, sample); });
    if (!hasValue) return false;
    sample.pdfSolidAngle = pdfSolidAngle(sample.lobe, sample.direction);
    return sample.pdfSolidAngle > 0.0f;
}

}  // namespace pm
