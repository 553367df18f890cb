// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/aim_shadows.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// A shadow is wider than its caster by this share: light that missed it by rounding would arrive by
// the unaimed share alone, with a hundredfold flux.
constexpr double kWider = 1.0 + 1e-4;

double discArea(const Caster& caster) {
    const double r = caster.radius * kWider;
    return std::numbers::pi * r * r;
}

}  // namespace

AimShadows::AimShadows(std::span<const Caster> casters, std::span<const float> worth,
                       const Vec3f& direction, const Vec3d& halfSize, float unaimedShare)
    : m_direction(normalize(Vec3d(direction))), m_scene(halfSize, m_direction) {
    double total = 0.0;
    for (std::uint32_t i = 0; i < casters.size(); ++i) {
        Part part = partOf(casters[i], m_direction);
        part.index = i;
        part.share = static_cast<double>(worth[i]) * part.area;
        if (!(part.share > 0.0)) continue;
        std::construct_at(&m_slots[m_count++].part, part);
        total += part.share;
    }
    if (m_count == 0) return;
    m_unaimedShare = m_scene.area() > 0.0 ? static_cast<double>(unaimedShare) : 0.0;
    for (std::size_t i = 0; i < m_count; ++i)
        m_slots[i].part.share *= (1.0 - m_unaimedShare) / total;
}

AimShadows::Part AimShadows::partOf(const Caster& caster, const Vec3d& direction) {
    Part part{&caster, discArea(caster), 0.0, 0, false};
    if (!caster.useBox) return part;
    const double ofBox = BoxShadow(caster.halfSize * kWider, direction).area();
    part.isBox = ofBox > 0.0 && ofBox < part.area;
    if (part.isBox) part.area = ofBox;
    return part;
}

double AimShadows::areaOf(const Caster& caster, const Vec3d& direction) {
    return partOf(caster, direction).area;
}

bool AimShadows::holds(const Part& part, const Vec3d& point) const {
    const Vec3d off = point - part.caster->centre;
    if (part.isBox) return BoxShadow(part.caster->halfSize * kWider, m_direction).holds(off);
    const double r = part.caster->radius * kWider;
    return lengthSquared(off - m_direction * dot(off, m_direction)) <= r * r;
}

Vec3d AimShadows::pointIn(const Part& part, Vec2f u) const {
    if (part.isBox)
        return part.caster->centre +
               BoxShadow(part.caster->halfSize * kWider, m_direction).sample(u);
    const Frame frame{Vec3f(m_direction)};
    const double r = part.caster->radius * kWider * std::sqrt(static_cast<double>(u.x));
    const SinCos phi = sinCosTurns(u.y);
    return part.caster->centre + Vec3d(frame.tangent) * (r * static_cast<double>(phi.cos)) +
           Vec3d(frame.bitangent) * (r * static_cast<double>(phi.sin));
}

bool AimShadows::sample(float uChoice, Vec2f u, Sample& sample) const {
    const Part* chosen = nullptr;
    auto x = static_cast<double>(uChoice);
    for (std::size_t i = 0; i < m_count && !chosen; ++i) {
        if (x < m_slots[i].part.share) chosen = &m_slots[i].part;
        x -= m_slots[i].part.share;
    }
    if (!chosen && !(m_scene.area() > 0.0)) return false;
    sample.caster = chosen ? chosen->index : kNoCaster;
    sample.point = chosen ? pointIn(*chosen, u) : m_scene.sample(u);
    // What made the point is not asked again: at its edge rounding could answer 0.
    sample.pdfArea = chosen ? chosen->share / chosen->area + pdfOfOthers(sample.point, chosen)
                            : m_unaimedShare / m_scene.area() + pdfOfParts(sample.point, nullptr);
    return true;
}

double AimShadows::pdfArea(const Vec3d& point) const {
    return pdfOfOthers(point, nullptr);
}

double AimShadows::pdfOfOthers(const Vec3d& point, const Part* leftOut) const {
    const bool inScene = m_scene.area() > 0.0 && m_scene.holds(point);
    return (inScene ? m_unaimedShare / m_scene.area() : 0.0) + pdfOfParts(point, leftOut);
}

double AimShadows::pdfOfParts(const Vec3d& point, const Part* leftOut) const {
    double pdf = 0.0;
    for (std::size_t i = 0; i < m_count; ++i) {
        const Part& part = m_slots[i].part;
        if (&part != leftOut && holds(part, point)) pdf += part.share / part.area;
    }
    return pdf;
}

}  // namespace pm
