// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/bsdf.h"

#include <algorithm>
#include <cmath>

#include "integrator/materials/opacity.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// The correction for shading normals grows without bound at grazing angles; beyond this it is cut.
// Only photons that arrive within about 1/20 of the horizon can lose something by it.
constexpr float kLargestCorrection = 20.0f;

float mean(const Rgb& c) {
    return (c.r + c.g + c.b) * (1.0f / 3.0f);
}

float clamp01(float v) {
    return v > 0.0f ? std::min(v, 1.0f) : 0.0f;
}

Rgb clamp01(const Rgb& c) {
    return {clamp01(c.r), clamp01(c.g), clamp01(c.b)};
}

Texel lookUp(const Materials& materials, std::int32_t texture, const Surface& surface) {
    return texture == kNoTexture ? Texel{1.0f, 1.0f, 1.0f, 1.0f}
                                 : materials.textures->lookUp(texture, surface.uv, 0.0f);
}

Rgb textured(const Materials& materials, const Rgb& number, std::int32_t texture,
             const Surface& surface) {
    if (texture == kNoTexture) return number;
    const Texel t = lookUp(materials, texture, surface);
    return number * Rgb(t.r, t.g, t.b);
}

Vec3f reflect(const Vec3f& out, const Vec3f& normal) {
    return normalize(normal * (2.0f * dot(out, normal)) - out);
}

}  // namespace

float fresnelDielectric(float cosine, float eta) {
    const float sin2Inside = (1.0f - cosine * cosine) / (eta * eta);
    if (sin2Inside >= 1.0f) return 1.0f;
    const float cosineInside = std::sqrt(1.0f - sin2Inside);
    const float parallel = (eta * cosine - cosineInside) / (eta * cosine + cosineInside);
    const float perpendicular = (cosine - eta * cosineInside) / (cosine + eta * cosineInside);
    return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

namespace {

// Where light from `out`, on the side of n, goes beyond it; eta: index there over that here. False
// where it is all reflected.
bool refractBy(const Vec3f& n, const Vec3f& out, float eta, Vec3f& direction) {
    const float cosine = dot(out, n);
    const float sin2Inside = (1.0f - cosine * cosine) / (eta * eta);
    if (sin2Inside >= 1.0f) return false;
    const float cosineInside = std::sqrt(1.0f - sin2Inside);
    direction = normalize(n * (cosine / eta - cosineInside) - out * (1.0f / eta));
    return true;
}

}  // namespace

Bsdf::Bsdf(const Materials& materials, const Surface& surface, const Vec3f& out,
           Transport transport, const Rgb& carried)
    : m_material(materials[surface.material]),
      m_out(out),
      m_ng(surface.geometricNormal),
      m_ns(surface.shadingNormal),
      m_frontSide(dot(out, surface.geometricNormal) >= 0.0f),
      m_transport(transport),
      m_phong(isBroad(m_material) ? Lobe::kBroad : Lobe::kGlossy) {
    if (!m_frontSide) {
        m_ng = -m_ng;
        m_ns = -m_ns;
    }
    m_nd = m_ns;
    // Seen from behind its shading normal a surface would have no front to be a mirror with. What
    // is Lambertian does not ask where it is seen from.
    const bool behindShading = dot(m_out, m_ns) <= 0.0f;
    if (behindShading) m_ns = m_ng;
    m_opacity = opacityAt(materials, m_material, surface.uv);
    switch (m_material.kind) {
        case MaterialKind::kSurface:
            setSurface(materials, surface);
            break;
        case MaterialKind::kMirror:
            setMirror(materials, surface);
            break;
        case MaterialKind::kDielectric:
            setDielectric(materials, surface);
            break;
    }
    m_reflectance[index(Lobe::kStraight)] = Rgb(1.0f - m_opacity);
    // A camera path finds no light there (see evaluate), so a photon from there brings none.
    if (behindShading && transport == Transport::kPhotons)
        m_reflectance[index(Lobe::kDiffuse)] = m_reflectance[index(m_phong)] = Rgb();
    m_diffuseOnly = m_material.kind == MaterialKind::kSurface && m_opacity == 1.0f &&
                    isBlack(m_reflectance[index(m_phong)]);
    if (m_diffuseOnly) {
        chooseDiffuse(carried);
        return;
    }
    if (m_hasPhotonWays)
        setPhotonWays();
    else
        limitEnergy();
    chooseProbabilities(carried);
}

void Bsdf::setSurface(const Materials& materials, const Surface& surface) {
    m_reflectance[index(Lobe::kDiffuse)] =
        clamp01(textured(materials, m_material.diffuse, m_material.diffuseTexture, surface)) *
        m_opacity;
    if (isBlack(m_material.glossy)) return;
    m_reflectance[index(m_phong)] =
        clamp01(textured(materials, m_material.glossy, m_material.glossyTexture, surface)) *
        m_opacity;
    m_exponent = std::max(0.0f, m_material.glossyExponent *
                                    lookUp(materials, m_material.glossyExponentTexture, surface).r);
}

void Bsdf::setMirror(const Materials& materials, const Surface& surface) {
    m_tint = clamp01(textured(materials, m_material.glossy, m_material.glossyTexture, surface));
    m_exponent = m_material.glossyExponent;
    if (m_exponent > 0.0f) {
        m_reflectance[index(m_phong)] = m_tint * m_opacity;
        return;
    }
    m_hasPhotonWays = m_transport == Transport::kPhotons && m_nd != m_ng;
    m_reflectance[index(Lobe::kReflection)] = shareSeenFrom(m_out, Lobe::kReflection);
}

Rgb Bsdf::mirrorColour(float cosine) const {
    if (!m_material.fresnelMirror) return m_tint;
    // Schlick 1994: the reflectance rises to 1 at grazing angles.
    const float m = 1.0f - cosine;
    return m_tint + (Rgb(1.0f) - m_tint) * (m * m * m * m * m);
}

void Bsdf::setDielectric(const Materials& materials, const Surface& surface) {
    m_eta = m_frontSide ? m_material.ior : 1.0f / m_material.ior;
    const float reflected = fresnelDielectric(clamp01(dot(m_out, m_ns)), m_eta);
    m_tint = clamp01(
        textured(materials, m_material.transmission, m_material.transmissionTexture, surface));
    if (surface.isPane) {
        setPane(reflected);
        return;
    }
    m_hasPhotonWays = m_transport == Transport::kPhotons && m_nd != m_ng;
    m_reflectance[index(Lobe::kReflection)] = Rgb(reflected * m_opacity);
    m_reflectance[index(Lobe::kRefraction)] = m_tint * ((1.0f - reflected) * m_opacity);
}

// With R of one boundary, and the tint at each passage: (1 - R)^2 goes through both, and of the
// (1 - R) inside R^2, R^4 ... are sent to and fro before they leave.
void Bsdf::setPane(float reflected) {
    const float through = (1.0f - reflected) / (1.0f + reflected);
    m_eta = 1.0f;
    m_reflectance[index(Lobe::kRefraction)] = m_tint * m_tint * through;
    m_reflectance[index(Lobe::kReflection)] =
        Rgb(reflected) + m_tint * m_tint * (reflected * through);
}

void Bsdf::setPhotonWays() {
    for (const Lobe lobe : {Lobe::kReflection, Lobe::kRefraction}) {
        if (lobe == Lobe::kRefraction && m_material.kind == MaterialKind::kMirror) continue;
        const std::array<PhotonWay, 2> ways = photonWays(lobe);
        m_reflectance[index(lobe)] = ways[0].share + ways[1].share;
    }
}

// What goes straight on is the share of the surface that is not there: none of it is taken.
void Bsdf::limitEnergy() {
    const float largest = maxChannel(albedo());
    if (!(largest > 1.0f)) return;
    const Rgb straight = reflectance(Lobe::kStraight);
    const float factor = m_opacity / (largest - straight.g);
    for (Rgb& reflectance : m_reflectance) reflectance *= factor;
    m_reflectance[index(Lobe::kStraight)] = straight;
}

// What chooseProbabilities comes to where there is one lobe; most surfaces are like that.
void Bsdf::chooseDiffuse(const Rgb& carried) {
    const float reflected = mean(carried * diffuse());
    m_black = !(reflected > 0.0f);
    if (m_black) return;
    m_probability[index(Lobe::kDiffuse)] =
        m_transport == Transport::kPhotons ? reflected / std::max(reflected, mean(carried)) : 1.0f;
}

void Bsdf::chooseProbabilities(const Rgb& carried) {
    float sum = 0.0f;
    for (std::size_t i = 0; i < kLobeCount; ++i) {
        m_probability[i] = mean(carried * m_reflectance[i]);
        sum += m_probability[i];
    }
    m_black = !(sum > 0.0f);
    if (m_black) return;
    // Photons die with what is left of their flux, so that the survivors keep its mean.
    const float total = m_transport == Transport::kPhotons ? std::max(sum, mean(carried)) : sum;
    for (float& p : m_probability) p /= total;
}

Rgb Bsdf::albedo() const {
    Rgb sum;
    for (const Rgb& reflectance : m_reflectance) sum += reflectance;
    return sum;
}

bool Bsdf::isReflection(const Vec3f& in) const {
    return dot(in, m_ng) > 0.0f && dot(in, m_ns) > 0.0f;
}

// [Veach 1997, eq. 5.19]: what turns the radiance's BSDF into the photons' where the shading normal
// is not the geometric one.
float Bsdf::adjointCorrection(const Vec3f& in) const {
    if (m_transport == Transport::kRadiance) return 1.0f;
    const float numerator = std::abs(dot(m_out, m_ns) * dot(in, m_ng));
    const float denominator = std::abs(dot(m_out, m_ng) * dot(in, m_ns));
    return numerator >= kLargestCorrection * denominator ? kLargestCorrection
                                                         : numerator / denominator;
}

float Bsdf::normalRatio() const {
    const float shading = dot(m_out, m_nd), geometric = dot(m_out, m_ng);
    return shading >= kLargestCorrection * geometric ? kLargestCorrection
                                                     : std::max(0.0f, shading / geometric);
}

// Light counts by its cosine to the shading normal, and photons that it sends off leave by that to
// the geometric one: eq. 5.19 with one side of it used up where they arrived.
Rgb Bsdf::evaluateDiffuse(const Vec3f& in) const {
    const float geometric = dot(in, m_ng), shading = dot(in, m_nd);
    if (!(geometric > 0.0f)) return {};
    if (m_transport == Transport::kPhotons) return diffuse() * (kInvPi * geometric * normalRatio());
    return shading > 0.0f ? diffuse() * (kInvPi * shading) : Rgb();
}

Rgb Bsdf::evaluate(Lobe lobe, const Vec3f& in) const {
    if (lobe == Lobe::kDiffuse) return evaluateDiffuse(in);
    if (!isReflection(in)) return {};
    const float cosine = dot(in, m_ns);
    // Lafortune & Willems 1994: rho (n+2)/(2 pi) cos^n(alpha), reciprocal and never above rho.
    const float cosAlpha = dot(in, reflect(m_out, m_ns));
    if (!(cosAlpha > 0.0f)) return {};
    const float lobeValue =
        (m_exponent + 2.0f) * (0.5f * kInvPi) * pinnedPow(std::min(cosAlpha, 1.0f), m_exponent);
    return m_reflectance[index(m_phong)] * (lobeValue * cosine * adjointCorrection(in));
}

float Bsdf::pdfSolidAngle(Lobe lobe, const Vec3f& in) const {
    if (!has(lobe)) return 0.0f;
    const float probability = m_followsAll ? 1.0f : m_probability[index(lobe)];
    if (lobe == Lobe::kDiffuse)
        return probability * std::max(0.0f, dot(in, diffuseAxis())) * kInvPi;
    const float cosAlpha = dot(in, reflect(m_out, m_ns));
    if (!(cosAlpha > 0.0f)) return 0.0f;
    return probability * (m_exponent + 1.0f) * (0.5f * kInvPi) *
           pinnedPow(std::min(cosAlpha, 1.0f), m_exponent);
}

bool Bsdf::refract(Vec3f& direction, float& correction) const {
    // With the shading normal first, with the geometric one where that leads to the wrong side.
    for (const Vec3f& n : {m_ns, m_ng}) {
        if (!refractBy(n, m_out, m_eta, direction)) continue;
        correction = n == m_ns ? adjointCorrection(direction) : 1.0f;
        if (dot(direction, m_ng) < 0.0f) return true;
    }
    return false;
}

Rgb Bsdf::shareSeenFrom(const Vec3f& eye, Lobe lobe) const {
    const bool isBeyond = lobe == Lobe::kRefraction;
    const float side = isBeyond ? -1.0f : 1.0f;
    const float shading = side * dot(eye, m_nd);
    const float cosine = clamp01(shading > 0.0f ? shading : side * dot(eye, m_ng));
    if (m_material.kind == MaterialKind::kMirror) return mirrorColour(cosine) * m_opacity;
    const float reflected = fresnelDielectric(cosine, isBeyond ? 1.0f / m_eta : m_eta);
    return isBeyond ? m_tint * ((1.0f - reflected) * m_opacity) : Rgb(reflected * m_opacity);
}

std::array<Bsdf::PhotonWay, 2> Bsdf::photonWays(Lobe lobe) const {
    std::array<PhotonWay, 2> ways{};
    Vec3f &byShading = ways[0].direction, &byGeometric = ways[1].direction;
    bool isFirst = dot(m_out, m_nd) > 0.0f, isSecond = true;
    if (lobe == Lobe::kReflection) {
        byShading = reflect(m_out, m_nd);
        byGeometric = reflect(m_out, m_ng);
        isFirst = isFirst && dot(byShading, m_ng) > 0.0f;
        isSecond = dot(byGeometric, m_nd) <= 0.0f || dot(reflect(byGeometric, m_nd), m_ng) <= 0.0f;
    } else {
        isFirst =
            isFirst && refractBy(m_nd, m_out, m_eta, byShading) && dot(byShading, m_ng) < 0.0f;
        isSecond = refractBy(m_ng, m_out, m_eta, byGeometric);
        Vec3f back;
        if (isSecond && dot(byGeometric, m_nd) < 0.0f)
            isSecond = refractBy(-m_nd, byGeometric, 1.0f / m_eta, back) && dot(back, m_ng) <= 0.0f;
    }
    if (isFirst) {
        ways[0].share = shareSeenFrom(byShading, lobe);
        ways[0].correction = adjointCorrection(byShading);
    }
    if (isSecond) ways[1].share = shareSeenFrom(byGeometric, lobe);
    return ways;
}

bool Bsdf::takePhotonWay(Lobe lobe, float probability, float u, BsdfSample& sample) const {
    const std::array<PhotonWay, 2> ways = photonWays(lobe);
    const float first = mean(ways[0].share), second = mean(ways[1].share);
    if (!(first + second > 0.0f)) return false;
    const float ofFirst = first / (first + second);
    const bool takesFirst = u < ofFirst;
    const PhotonWay& way = ways[takesFirst ? 0 : 1];
    sample.direction = way.direction;
    sample.weight =
        way.share * (way.correction / (probability * (takesFirst ? ofFirst : 1.0f - ofFirst)));
    return true;
}

bool Bsdf::sample(float uLobe, Vec2f u, BsdfSample& sample) const {
    std::size_t i = 0;
    while (i < kLobeCount && uLobe >= m_probability[i]) uLobe -= m_probability[i++];
    if (i == kLobeCount) {
        if (m_transport == Transport::kPhotons || m_black) return false;
        // Rounding left a crumb of [0,1) after the last lobe.
        i = static_cast<std::size_t>(std::max_element(m_probability.begin(), m_probability.end()) -
                                     m_probability.begin());
    }
    return take(static_cast<Lobe>(i), m_probability[i], u, sample);
}

bool Bsdf::follow(Lobe lobe, BsdfSample& sample, Vec2f u) const {
    return has(lobe) && take(lobe, 1.0f, u, sample);
}

bool Bsdf::take(Lobe lobe, float probability, Vec2f u, BsdfSample& sample) const {
    sample.lobe = lobe;
    sample.pdfSolidAngle = probability;
    sample.weight = m_reflectance[index(lobe)] / probability;
    switch (sample.lobe) {
        case Lobe::kDiffuse:
            sample.direction = normalize(Frame(diffuseAxis()).toWorld(sampleCosineHemisphere(u)));
            sample.pdfSolidAngle = pdfSolidAngle(sample.lobe, sample.direction);
            if (m_transport == Transport::kPhotons) sample.weight *= normalRatio();
            return sample.pdfSolidAngle > 0.0f && dot(sample.direction, m_ng) > 0.0f;
        case Lobe::kGlossy:
        case Lobe::kBroad:
            sample.direction =
                normalize(Frame(reflect(m_out, m_ns)).toWorld(samplePhongLobe(u, m_exponent)));
            sample.pdfSolidAngle = pdfSolidAngle(sample.lobe, sample.direction);
            sample.weight *= (m_exponent + 2.0f) / (m_exponent + 1.0f) *
                             dot(sample.direction, m_ns) * adjointCorrection(sample.direction);
            return sample.pdfSolidAngle > 0.0f && isReflection(sample.direction);
        case Lobe::kReflection:
            if (m_hasPhotonWays) return takePhotonWay(lobe, probability, u.x, sample);
            sample.direction = reflect(m_out, m_ns);
            if (dot(sample.direction, m_ng) <= 0.0f) sample.direction = reflect(m_out, m_ng);
            return true;
        case Lobe::kRefraction: {
            if (m_hasPhotonWays) return takePhotonWay(lobe, probability, u.x, sample);
            float correction;
            if (!refract(sample.direction, correction)) return false;
            // Radiance is squeezed into a narrower cone of a denser medium; flux is not changed.
            if (m_transport == Transport::kRadiance) sample.weight *= 1.0f / (m_eta * m_eta);
            sample.weight *= correction;
            return true;
        }
        case Lobe::kStraight:
            sample.direction = -m_out;
            return true;
    }
    return false;
}

}  // namespace pm
