// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

#include "integrator/materials/materials.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// The parts a BSDF is made of. Each light path is told apart by the lobes it went through, so lobes
// are sampled one at a time, never as a mixture.
enum class Lobe : std::uint8_t {
    kDiffuse,     // Lambertian reflection
    kGlossy,      // Phong lobe around the mirror direction, narrow enough to cast caustics
    kBroad,       // Phong lobe that is not: for the classes of paths much like the diffuse one
    kReflection,  // mirror, and the reflected part of a dielectric (delta)
    kRefraction,  // delta
    // Transparency: passes as if nothing were there (delta). It is no event of a path: changes no
    // class of paths and stands in no density. Shadow rays go by it as well: Scene::transmittance.
    kStraight,
};
inline constexpr std::size_t kLobeCount = 6;

constexpr bool isDelta(Lobe lobe) {
    return lobe == Lobe::kReflection || lobe == Lobe::kRefraction || lobe == Lobe::kStraight;
}

// What travels along the path: radiance from the camera backwards, or photons from a light. They
// differ in the factor eta^2 of refraction and in the correction for shading normals.
// Source: Veach 1997, sections 5.2 and 5.3.
enum class Transport : std::uint8_t { kRadiance, kPhotons };

struct BsdfSample {
    Vec3f direction;             // unit, away from the surface
    Rgb weight;                  // f |cos| / pdf, the lobe's choice included
    float pdfSolidAngle = 0.0f;  // sr^-1, the lobe's choice included; of a delta lobe its
                                 // choice's probability
    Lobe lobe = Lobe::kDiffuse;
};

// How a surface scatters, at one point and for light that leaves along `out` (or, for photons, that
// came from there). Reflection on both sides; textures looked up once. Energy is never made: where
// the reflectances add to more than 1 in a channel, all are scaled down.
class Bsdf {
  public:
    // out: unit, away from the surface. carried: throughput or flux so far; lobes are chosen in
    // proportion to what they would carry on. Photons are absorbed with the rest of the
    // probability, so that their mean flux stays the same; camera paths always go on.
    Bsdf(const Materials& materials, const Surface& surface, const Vec3f& out, Transport transport,
         const Rgb& carried);

    bool has(Lobe lobe) const { return m_probability[index(lobe)] > 0.0f; }
    // Whether there is a lobe that is not delta, for which lamps are sampled.
    bool reflectsLamps() const {
        return has(Lobe::kDiffuse) || has(Lobe::kGlossy) || has(Lobe::kBroad);
    }
    // That of the Phong lobe, where there is one: a surface has one at most.
    Lobe phongLobe() const { return m_phong; }
    // With which sample() chooses the lobe.
    float probability(Lobe lobe) const { return m_probability[index(lobe)]; }
    // What the lobe reflects or transmits; at a refraction without its factor 1 / etaSquared().
    const Rgb& reflectance(Lobe lobe) const { return m_reflectance[index(lobe)]; }
    // Nothing but Lambertian reflection, or less.
    bool isDiffuseOnly() const { return m_diffuseOnly; }
    // Mean over channels of what could be reflected or transmitted is 0.
    bool isBlackBody() const { return m_black; }

    // False: absorbed (photons), or the sampled direction has no value.
    bool sample(float uLobe, Vec2f u, BsdfSample& sample) const;
    // From here on all lobes are followed, in place of one: densities have no choice in them.
    void followAll() { m_followsAll = true; }
    // The same for a lobe that is taken for sure, so that no choice is in the weight. False also
    // where the surface has no such lobe. u: a delta lobe needs none, but of photons.
    bool follow(Lobe lobe, BsdfSample& sample, Vec2f u = {}) const;

    // f |cos| of a lobe that is not delta, for light from `in` (unit, away from the surface).
    Rgb evaluate(Lobe lobe, const Vec3f& in) const;
    // Density with which sample() takes that lobe and that direction, or, after followAll(), with
    // which the lobe's own direction is that; sr^-1.
    float pdfSolidAngle(Lobe lobe, const Vec3f& in) const;

    // Lambertian reflectance; reflected radiance = diffuse() * irradiance / pi.
    const Rgb& diffuse() const { return reflectance(Lobe::kDiffuse); }
    // All that is reflected or transmitted, for the albedo layer.
    Rgb albedo() const;

    // Squared index on the far side over the one on this side.
    float etaSquared() const { return m_eta * m_eta; }

    // The normals turned to the side of `out`.
    const Vec3f& facingGeometricNormal() const { return m_ng; }
    const Vec3f& facingShadingNormal() const { return m_nd; }
    // Cosine of `out` to the shading normal over that to the geometric one, in [0, 20]: what a
    // photon that arrived from there counts for in irradiance.
    float normalRatio() const;
    // Diffuse directions are drawn by the cosine to it.
    const Vec3f& diffuseAxis() const { return m_transport == Transport::kPhotons ? m_ng : m_nd; }

  private:
    static constexpr std::size_t index(Lobe lobe) { return static_cast<std::size_t>(lobe); }
    void setSurface(const Materials& materials, const Surface& surface);
    void setMirror(const Materials& materials, const Surface& surface);
    void setDielectric(const Materials& materials, const Surface& surface);
    // Of both boundaries of a body so thin that no ray starts inside it.
    void setPane(float reflected);
    void limitEnergy();
    void chooseDiffuse(const Rgb& carried);
    void chooseProbabilities(const Rgb& carried);
    bool take(Lobe lobe, float probability, Vec2f u, BsdfSample& sample) const;
    bool isReflection(const Vec3f& in) const;
    // The camera goes by the shading normal, and by the geometric one where it sees the surface
    // from behind the other or would come out on the wrong side. So a photon has no, one or two
    // ways on by a mirror or glass: those from whose ends the camera comes to where the photon is
    // from.
    struct PhotonWay {
        Vec3f direction;
        Rgb share;  // of the light there that the camera gets; 0: no way
        float correction = 1.0f;
    };
    std::array<PhotonWay, 2> photonWays(Lobe lobe) const;
    void setPhotonWays();
    bool takePhotonWay(Lobe lobe, float probability, float u, BsdfSample& sample) const;
    // Of the camera that sees the surface from there.
    Rgb shareSeenFrom(const Vec3f& eye, Lobe lobe) const;
    Rgb mirrorColour(float cosine) const;
    Rgb evaluateDiffuse(const Vec3f& in) const;
    // correction: of the normal that was used, see adjointCorrection.
    bool refract(Vec3f& direction, float& correction) const;
    float adjointCorrection(const Vec3f& in) const;

    const MaterialDescription& m_material;
    Vec3f m_out, m_ng;
    Vec3f m_nd, m_ns;  // shading normals, of the diffuse lobe and of all others
    bool m_frontSide;
    bool m_black = false, m_diffuseOnly = false, m_followsAll = false;
    bool m_hasPhotonWays = false;  // photons, at a mirror or glass whose normals differ
    Transport m_transport;
    Lobe m_phong;
    float m_exponent = 0.0f, m_opacity = 1.0f;
    Rgb m_tint;          // of a mirror, or of what glass lets through
    float m_eta = 1.0f;  // index on the far side over the index on this side
    std::array<Rgb, kLobeCount> m_reflectance{};
    std::array<float, kLobeCount> m_probability{};
};

// Share of unpolarised light that a smooth boundary reflects. cosine: of the angle to the normal on
// the side the light comes from, in [0,1]; eta: index on the far side over this side's.
// Source: Fresnel's equations, averaged over both polarisations.
float fresnelDielectric(float cosine, float eta);

}  // namespace pm
