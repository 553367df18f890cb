// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <span>
#include <variant>

#include "integrator/materials/lobe_kinds.h"
#include "integrator/materials/material_traits.h"
#include "integrator/materials/materials.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

// How a surface scatters, at one point and for light that leaves along `out` (or, for photons, that
// came from there): the closure of its lobes, of which it knows the roles, not the models.
// Reflection on both sides; textures looked up once. Energy is never made: where the reflectances
// add to more than 1 in a channel, all are scaled down.
class Bsdf {
  public:
    // out: unit, away from the surface. carried: throughput or flux so far; lobes are chosen in
    // proportion to what they would carry on. Photons are absorbed with the rest of the
    // probability, so that their mean flux stays the same; camera paths always go on.
    Bsdf(const Materials& materials, const Surface& surface, const Vec3f& out, Transport transport,
         const Rgb& carried);
    // In a medium: by its phase function, as a broad lobe that light goes through. albedo: of what
    // is scattered or absorbed, the share that is scattered.
    Bsdf(const HenyeyGreenstein& phase, const Rgb& albedo, const Vec3f& out, Transport transport,
         const Rgb& carried);

    bool has(Lobe lobe) const { return m_probability[index(lobe)] > 0.0f; }
    // Whether there is a lobe that is not delta, for which lamps are sampled.
    bool reflectsLamps() const { return has(Lobe::kDiffuse) || isShiny(); }
    // Whether there is one around a direction, of any width.
    bool isShiny() const { return has(Lobe::kGlossy) || has(Lobe::kWide) || has(Lobe::kBroad); }
    // With which sample() chooses the lobe.
    float probability(Lobe lobe) const { return m_probability[index(lobe)]; }
    // What the lobe reflects or transmits; at a refraction without its factor
    // 1 / BsdfSample::etaSquared.
    const Rgb& reflectance(Lobe lobe) const { return m_lobes.of(lobe); }
    // Whether light that comes from behind leaves by a lobe that is not delta.
    bool goesThrough() const;
    // Rough glass with a wide lobe, and nothing broad beside it.
    bool isFrosted() const { return has(Lobe::kWide) && !has(Lobe::kBroad) && goesThrough(); }
    // Nothing but a diffuse lobe, or less.
    bool isDiffuseOnly() const { return m_diffuseOnly; }
    // Mean over channels of what could be reflected or transmitted is 0.
    bool isBlackBody() const { return m_black; }

    // False: absorbed (photons), or the sampled direction has no value.
    bool sample(float uLobe, Vec2f u, BsdfSample& sample) const;
    // From here on all lobes are followed, in place of one: densities have no choice in them.
    void followAll() { m_followsAll = true; }
    // The same for a lobe that is taken for sure, so that no choice is in the weight. False also
    // where the surface has no such lobe. u: a delta lobe needs none, but of photons.
    bool follow(Lobe lobe, BsdfSample& sample, LobeNumbers u = {}) const;

    // f |cos| of a lobe that is not delta, for light from `in` (unit, away from the surface).
    Rgb evaluate(Lobe lobe, const Vec3f& in) const;
    // The same of the diffuse lobe by the shading normal alone, also where `in` is beyond the
    // horizon of the geometric normal.
    Rgb evaluateSmooth(const Vec3f& in) const;
    // Density with which sample() takes that lobe and that direction, or, after followAll(), with
    // which the lobe's own direction is that; sr^-1.
    float pdfSolidAngle(Lobe lobe, const Vec3f& in) const;

    // By the diffuse lobe: radiance that leaves along `out` of a radiance of 1 from everywhere.
    Rgb diffuse() const;
    // What light from `out` counts for in the irradiance of which that is, beside light of the
    // mean.
    float arrival() const;
    // That of light from anywhere, where it does not depend on where it leaves to and is so simple;
    // none elsewhere.
    std::optional<Admission> admission() const;
    // The same of an irradiance.
    Rgb reflectedOf(const Rgb& irradiance) const;
    // All that is reflected or transmitted, for the albedo layer.
    Rgb albedo() const;

    // The normals turned to the side of `out`.
    const Vec3f& facingGeometricNormal() const { return m_at.ng; }
    const Vec3f& facingShadingNormal() const { return m_at.nd; }
    // What a photon that arrived from `out` counts for in irradiance, in [0, 20].
    float normalRatio() const { return m_at.normalRatio(); }
    // Diffuse directions are drawn by the cosine to it.
    const Vec3f& diffuseAxis() const { return m_at.diffuseAxis(); }

  private:
    static constexpr std::size_t index(Lobe lobe) { return static_cast<std::size_t>(lobe); }
    // The lobes of one part of a mixture. at: of it, its opacity is the share that it has.
    struct Part {
        LobePoint at;
        Lobes lobes{};

        template <typename Call>
        decltype(auto) visit(Lobe lobe, const Call& call) const;
        bool has(Lobe lobe) const { return !isBlack(lobes.of(lobe)); }
        Rgb evaluate(Lobe lobe, const Vec3f& in) const;
        float pdfSolidAngle(Lobe lobe, const Vec3f& in, float choice) const;
        // As a model does, from a weight that is the reflectance over the choice's probability.
        bool sample(Lobe lobe, LobeNumbers u, BsdfSample& sample) const;
    };
    // The parts of a mixture; most surfaces have none, and nothing of this is touched then.
    class Parts {
      public:
        Parts() {}  // leaves the rest as it is: it is large
        Part& add(const LobePoint& at) { return *new (slot(m_count++)) Part{at}; }
        bool any() const { return m_count > 0; }
        std::span<const Part> all() const { return {slot(0), m_count}; }

      private:
        Part* slot(std::size_t i) { return reinterpret_cast<Part*>(m_bytes) + i; }
        const Part* slot(std::size_t i) const { return reinterpret_cast<const Part*>(m_bytes) + i; }
        std::size_t m_count = 0;
        alignas(Part) std::byte m_bytes[kMostParts * sizeof(Part)];
    };

    static bool isSentByWays(const Lobes& lobes, const LobePoint& at);
    static void limitEnergy(Lobes& lobes, float opacity);
    void addParts(const Materials& materials, std::uint32_t index, const Surface& surface,
                  float share);
    void addUp();
    // Of all that has the lobe's role, a part's share.
    float shareOf(const Part& part, Lobe lobe) const;
    Rgb diffuseOfParts() const;
    float arrivalAtParts() const;
    Rgb evaluateParts(Lobe lobe, const Vec3f& in) const;
    Rgb evaluatePartsSmooth(const Vec3f& in) const;
    float pdfOfParts(Lobe lobe, const Vec3f& in, float choice) const;
    bool takePart(Lobe lobe, float probability, LobeNumbers u, BsdfSample& sample) const;
    void chooseDiffuse(const Rgb& carried);
    void chooseProbabilities(const Rgb& carried);
    bool take(Lobe lobe, float probability, LobeNumbers u, BsdfSample& sample) const;
    template <typename OneOfModels>
    bool takeBy(const OneOfModels& lobe, LobeNumbers u, BsdfSample& sample) const;

    LobePoint m_at;
    bool m_black = false, m_diffuseOnly = false, m_followsAll = false;
    Lobes m_lobes;  // of a mixture the reflectances are sums, and the lobes its parts'
    Parts m_parts;
    std::array<float, kLobeCount> m_probability{};
};

}  // namespace pm
