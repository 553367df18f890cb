// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/aim_caps.h"

#include <algorithm>
#include <cmath>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Share of the points that are chosen evenly.
constexpr float kEvenPoints = 0.1f;

}  // namespace

AimCaps::AimCaps(const SphereShape& sphere, std::span<const Caster> casters,
                 std::span<const float> worth) {
    float total = 0.0f, even = 0.0f;
    for (std::size_t i = 0; i < casters.size(); ++i) {
        const Vec3d to = casters[i].centre - sphere.centre;
        const double d = length(to);
        if (sphere.radius - casters[i].radius >= d) continue;  // inside the light
        const double ratio = casters[i].radius / d;
        const float share = worth[i] * static_cast<float>(std::min(1.0, ratio * ratio));
        total += share;
        if (casters[i].radius - sphere.radius >= d)
            even += share;  // seen from everywhere
        else
            m_caps[m_count++] = {Vec3f(to / d),
                                 static_cast<float>(std::min(sphere.radius / d - ratio, 1 - 1e-6)),
                                 share};
    }
    if (!(total > 0.0f)) return;
    const float scale = (1.0f - kEvenPoints) / total;
    m_evenShare = kEvenPoints + even * scale;
    for (std::size_t i = 0; i < m_count; ++i) m_caps[i].share *= scale;
}

Vec3f AimCaps::sample(float& uChoice, Vec2f u, float& pdfSolidAngle) const {
    float share = m_evenShare;
    std::size_t chosen = m_count;
    for (std::size_t i = 0; uChoice >= share && i < m_count; ++i) {
        uChoice -= share;
        share = m_caps[i].share;
        chosen = i;
    }
    uChoice = std::min(uChoice / share, 1.0f - 0x1p-24f);
    pdfSolidAngle = m_evenShare / (4.0f * kPi);
    Vec3f normal;
    if (chosen == m_count) {
        normal = sampleUniformSphere(u);
    } else {
        const Cap& cap = m_caps[chosen];
        const float z = cap.t + (1.0f - cap.t) * std::sqrt(u.x);
        const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
        const SinCos phi = sinCosTurns(u.y);
        normal = normalize(Frame(cap.axis).toWorld({r * phi.cos, r * phi.sin, z}));
        pdfSolidAngle += cap.share * cap.density(z);
    }
    for (std::size_t i = 0; i < m_count; ++i)
        if (i != chosen)
            pdfSolidAngle += m_caps[i].share * m_caps[i].density(dot(normal, m_caps[i].axis));
    return normal;
}

float AimCaps::pdfSolidAngle(const Vec3f& normal) const {
    float pdf = m_evenShare / (4.0f * kPi);
    for (std::size_t i = 0; i < m_count; ++i)
        pdf += m_caps[i].share * m_caps[i].density(dot(normal, m_caps[i].axis));
    return pdf;
}

float AimCaps::Cap::density(float cosine) const {
    return cosine > t ? (cosine - t) / (kPi * (1.0f - t) * (1.0f - t)) : 0.0f;
}

}  // namespace pm
