// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Bsdf: of mixtures, whose lobes of one role are sampled as one.
#include <algorithm>
#include <variant>

#include "integrator/materials/bsdf.h"
#include "integrator/materials/material_lobes.h"
#include "integrator/materials/opacity.h"

namespace pm {

// Calls with the lobe's model.
template <typename Call>
decltype(auto) Bsdf::Part::visit(Lobe lobe, const Call& call) const {
    return lobe == Lobe::kDiffuse ? std::visit(call, lobes.diffuse)
                                  : std::visit(call, lobes.glossy);
}

Rgb Bsdf::Part::evaluate(Lobe lobe, const Vec3f& in) const {
    return visit(lobe, [&](const auto& model) { return model.evaluate(at, lobes.of(lobe), in); });
}

float Bsdf::Part::pdfSolidAngle(Lobe lobe, const Vec3f& in, float choice) const {
    return visit(lobe, [&](const auto& model) { return model.pdfSolidAngle(at, in, choice); });
}

bool Bsdf::Part::sample(Lobe lobe, LobeNumbers u, BsdfSample& sample) const {
    if (isDelta(lobe))
        return std::visit([&](const auto& model) { return model.sample(at, u.x, sample); },
                          lobes.smooth);
    return visit(lobe, [&](const auto& model) { return model.sample(at, u, sample); });
}

void Bsdf::addParts(const Materials& materials, std::uint32_t index, const Surface& surface,
                    float share) {
    const MaterialDescription& material = materials[index];
    share *= ownOpacityAt(materials, material, contextAt(surface));
    if (!(share > 0.0f)) return;
    if (material.kind == MaterialKind::kMixture) {
        const float second = weightAt(materials, material, contextAt(surface));
        if (second < 1.0f) addParts(materials, material.first, surface, share * (1.0f - second));
        if (second > 0.0f) addParts(materials, material.second, surface, share * second);
        return;
    }
    LobePoint at = m_at;
    at.opacity = share;
    Part& part = m_parts.add(at);
    setLobes(materials, index, surface, part.at, part.lobes);
    if (isSentByWays(part.lobes, part.at)) return;
    const float largest = maxChannel(part.lobes.sum());
    if (largest > share)
        for (Rgb& reflectance : part.lobes.reflectance) reflectance *= share / largest;
}

void Bsdf::addUp() {
    for (const Part& part : m_parts.all())
        for (std::size_t i = 0; i < kLobeCount; ++i)
            m_lobes.reflectance[i] += part.lobes.reflectance[i];
}

float Bsdf::shareOf(const Part& part, Lobe lobe) const {
    const float all = meanChannel(m_lobes.of(lobe));
    return all > 0.0f ? meanChannel(part.lobes.of(lobe)) / all : 0.0f;
}

Rgb Bsdf::evaluateParts(Lobe lobe, const Vec3f& in) const {
    Rgb sum;
    if (isBlack(m_lobes.of(lobe))) return sum;
    for (const Part& part : m_parts.all())
        if (part.has(lobe)) sum += part.evaluate(lobe, in);
    return sum;
}

Rgb Bsdf::evaluatePartsSmooth(const Vec3f& in) const {
    Rgb sum;
    for (const Part& part : m_parts.all()) {
        if (!part.has(Lobe::kDiffuse)) continue;
        Part smooth = part;
        smooth.at.ng = smooth.at.nd;
        sum += smooth.evaluate(Lobe::kDiffuse, in);
    }
    return sum;
}

float Bsdf::pdfOfParts(Lobe lobe, const Vec3f& in, float choice) const {
    float sum = 0.0f;
    for (const Part& part : m_parts.all())
        if (part.has(lobe)) sum += part.pdfSolidAngle(lobe, in, choice * shareOf(part, lobe));
    return sum;
}

Rgb Bsdf::diffuseOfParts() const {
    Rgb sum;
    for (const Part& part : m_parts.all())
        if (part.has(Lobe::kDiffuse))
            sum += std::visit(
                [&](const auto& model) {
                    return model.albedo(part.at, part.lobes.of(Lobe::kDiffuse));
                },
                part.lobes.diffuse);
    return sum;
}

// The mean over what they reflect: an irradiance is one number.
float Bsdf::arrivalAtParts() const {
    float sum = 0.0f;
    for (const Part& part : m_parts.all())
        sum += shareOf(part, Lobe::kDiffuse) *
               std::visit([&](const auto& model) { return model.arrival(part.at); },
                          part.lobes.diffuse);
    return sum;
}

// One of the parts by its share; what is not delta counts by the densities of all.
bool Bsdf::takePart(Lobe lobe, float probability, LobeNumbers u, BsdfSample& sample) const {
    const Part* chosen = nullptr;
    float share = 0.0f;
    for (const Part& part : m_parts.all()) {
        if (!part.has(lobe)) continue;
        if (chosen && u.x < share) break;
        u.x -= share;
        chosen = &part;
        share = shareOf(part, lobe);
    }
    if (!chosen) return false;
    u.x = std::clamp(u.x / share, 0.0f, 0x1.fffffep-1f);
    if (isDelta(lobe)) {
        // Ways of photons divide by the choice's probability themselves.
        sample.pdfSolidAngle = probability * share;
        sample.weight = chosen->lobes.of(lobe) / sample.pdfSolidAngle;
        const bool hasValue = chosen->sample(lobe, u, sample);
        sample.pdfSolidAngle = probability;
        return hasValue;
    }
    if (!chosen->sample(lobe, u, sample)) return false;
    const float density = pdfOfParts(lobe, sample.direction, 1.0f);
    if (!(density > 0.0f)) return false;
    sample.weight = evaluateParts(lobe, sample.direction) / (probability * density);
    sample.pdfSolidAngle = (m_followsAll ? 1.0f : probability) * density;
    return true;
}

}  // namespace pm
