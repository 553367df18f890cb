// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/aim_mixture.h"

#include <memory>

namespace pm {

AimMixture::AimMixture(std::span<const Caster> casters, std::span<const float> worth,
                       const EmissionPoint& from, float unaimedShare)
    : m_from(from) {
    float total = 0.0f;
    for (std::uint32_t i = 0; i < casters.size(); ++i) {
        AimCone cone;
        if (!cone.aim(casters[i], from)) continue;
        const float share = worth[i] * cone.solidAngle;
        std::construct_at(&m_slots[m_count++].part, Part{cone, share, i});
        total += share;
    }
    if (!(total > 0.0f)) {
        m_count = 0;
        return;
    }
    m_unaimedShare = unaimedShare;
    const float scale = (1.0f - unaimedShare) / total;
    for (std::size_t i = 0; i < m_count; ++i) {
        m_slots[i].part.share *= scale;
        if (m_slots[i].part.cone.all) m_unaimedShare += m_slots[i].part.share;
    }
}

bool AimMixture::sample(float uChoice, Vec2f u, Sample& sample) const {
    const Part* chosen = nullptr;
    for (std::size_t i = 0; i < m_count && !chosen; ++i) {
        if (uChoice < m_slots[i].part.share) chosen = &m_slots[i].part;
        uChoice -= m_slots[i].part.share;
    }
    sample.caster = chosen ? chosen->caster : kNoCaster;
    if (!chosen || chosen->cone.all) {
        float pdf;
        sample.direction = m_from.sample(u, pdf);
        sample.pdfSolidAngle = m_unaimedShare * pdf;
        if (!(sample.pdfSolidAngle > 0.0f)) return false;
        for (std::size_t i = 0; i < m_count; ++i)
            if (!m_slots[i].part.cone.all)
                sample.pdfSolidAngle +=
                    m_slots[i].part.share * m_slots[i].part.cone.pdfSolidAngle(sample.direction);
        return true;
    }
    // Not asked again: at the cone's edge rounding could answer 0.
    float pdf;
    sample.direction = chosen->cone.sample(u, pdf);
    sample.pdfSolidAngle = chosen->share * pdf + pdfOfOthers(sample.direction, chosen);
    return sample.pdfSolidAngle > 0.0f;
}

float AimMixture::pdfSolidAngle(const Vec3f& direction) const {
    return pdfOfOthers(direction, nullptr);
}

float AimMixture::pdfOfOthers(const Vec3f& direction, const Part* leftOut) const {
    float pdf = m_unaimedShare * m_from.pdfSolidAngle(direction);
    for (std::size_t i = 0; i < m_count; ++i) {
        const Part& part = m_slots[i].part;
        if (&part != leftOut && !part.cone.all)
            pdf += part.share * part.cone.pdfSolidAngle(direction);
    }
    return pdf;
}

}  // namespace pm
