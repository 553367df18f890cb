// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/glass_albedo.h"
#include "integrator/materials/lobes/lobe_point.h"

namespace pm {

// A rough boundary of glass or water: reflects, and lets light through; where a facet reflects all,
// none goes through. Source: Walter et al. 2007, with the facets seen from `out`. What is
// scattered by more than one facet leaves on both sides, evenly but for what each loses, as Kulla &
// Conty 2017 have it for reflection: with m(mu) what is missing along mu on a side and M its mean,
// m(out) m(in) / (pi M), so that energy is kept and the lobe reciprocal.
struct RoughGlass {
    Ggx ggx;
    Rgb tint{1.0f};  // of what it lets through
    const GlassAlbedo* table = &GlassAlbedo::usual();
    bool isInside = false;  // `out` is inside

    float eta() const { return isInside ? 1.0f / table->ior() : table->ior(); }

    // Of even light along a cosine.
    Rgb albedo(float cosine) const {
        const float reflected = fresnelDielectric(cosine, eta());
        return Rgb(reflected) + tint * (1.0f - reflected);
    }

    static float cosine(const LobePoint& at) { return std::max(1e-4f, dot(at.out, at.ns)); }

    // For light from both sides.
    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        const Frame frame(at.ns);
        const Vec3f out = frame.toLocal(at.out), local = frame.toLocal(in);
        if (!isEither(at, out, local, in)) return {};
        const Rgb value =
            local.z > 0.0f ? Rgb(reflectedValue(out, local)) : tint * throughValue(at, out, local);
        return scaled(at, reflectance, value) * at.adjointCorrection(in);
    }

    float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) const {
        const Frame frame(at.ns);
        const Vec3f out = frame.toLocal(at.out), local = frame.toLocal(in);
        if (!isEither(at, out, local, in)) return 0.0f;
        return choice *
               (local.z > 0.0f ? reflectedDensity(out, local) : throughDensity(out, local));
    }

    bool sample(const LobePoint& at, LobeNumbers u, BsdfSample& sample) const {
        const Frame frame(at.ns);
        const Vec3f out = frame.toLocal(at.out);
        if (!(out.z > 0.0f)) return false;
        bool goesThrough;
        Vec3f in;
        if (take(u.way, missing(out))) {
            goesThrough = !take(u.way, reflectsMore());
            in = sampleCosineHemisphere(u);
            if (goesThrough) in.z = -in.z;
        } else {
            const Vec3f h = ggx.sampleVisible(out, u);
            const float seen = dot(out, h);
            goesThrough = !take(u.way, reflects(seen));
            in = h * (2.0f * seen) - out;
            if (goesThrough && !refract(out, h, in)) return false;
            in = normalize(in);
        }
        if (goesThrough ? !(in.z < 0.0f) : !(in.z > 0.0f)) return false;
        if (goesThrough) sample.etaSquared = eta() * eta();
        sample.direction = normalize(frame.toWorld(in));
        const Rgb value =
            goesThrough ? tint * throughValue(at, out, in) : Rgb(reflectedValue(out, in));
        const float density = goesThrough ? throughDensity(out, in) : reflectedDensity(out, in);
        if (!(density > 0.0f)) return false;
        sample.weight =
            scaled(at, sample.weight, value) * (at.adjointCorrection(sample.direction) / density);
        return isEither(at, out, in, sample.direction);
    }

  private:
    // On the same side of both normals.
    static bool isEither(const LobePoint& at, const Vec3f& out, const Vec3f& local,
                         const Vec3f& in) {
        return out.z > 0.0f && local.z != 0.0f && (local.z > 0.0f) == (dot(in, at.ng) > 0.0f);
    }
    // Whether u falls to a share; u is then even over [0, 1) again.
    static bool take(float& u, float share) {
        const bool isTaken = u < share;
        u = isTaken ? u / share : (u - share) / (1.0f - share);
        u = std::min(u, 1.0f - 0x1p-24f);
        return isTaken;
    }
    // With which probability a facet that is seen under a cosine reflects what is sampled: in
    // proportion to what it sends either way, so that no weight has the choice in it.
    float reflects(float seen) const { return ofBoth(fresnelDielectric(clamp01(seen), eta())); }
    // The same of what is scattered by more than one facet.
    float reflectsMore() const {
        return ofBoth(1.0f - table->crossing(isInside ? 1 : 0, ggx.alpha));
    }
    float ofBoth(float reflected) const {
        const float both = reflected + meanChannel(tint) * (1.0f - reflected);
        return both > 0.0f ? reflected / both : 1.0f;
    }
    float missing(const Vec3f& out) const {
        return table->missing(isInside ? 1 : 0, out.z, ggx.alpha);
    }
    bool refract(const Vec3f& out, const Vec3f& h, Vec3f& in) const {
        const float c = dot(out, h), cos2 = 1.0f - (1.0f - c * c) / (eta() * eta());
        if (!(cos2 > 0.0f)) return false;
        in = h * (c / eta() - std::sqrt(cos2)) - out / eta();
        return true;
    }

    // f |cos|.
    float reflectedValue(const Vec3f& out, const Vec3f& in) const {
        const int side = isInside ? 1 : 0;
        const Vec3f h = normalize(out + in);
        const float once = fresnelDielectric(clamp01(dot(out, h)), eta()) * ggx.density(h) *
                           ggx.maskingOfBoth(out, in) / (4.0f * out.z);
        const float mean = table->meanMissing(side, ggx.alpha);
        if (!(mean > 0.0f)) return once;
        return once + (1.0f - table->crossing(side, ggx.alpha)) * missing(out) *
                          table->missing(side, in.z, ggx.alpha) * in.z * kInvPi / mean;
    }
    float reflectedDensity(const Vec3f& out, const Vec3f& in) const {
        const Vec3f h = normalize(out + in);
        const float more = missing(out), seen = dot(out, h);
        return more * reflectsMore() * in.z * kInvPi + (1.0f - more) * reflects(seen) *
                                                           ggx.visibleDensity(out, h) /
                                                           (4.0f * std::max(1e-12f, seen));
    }
    // The facet by which light goes from one to the other; false: by none.
    bool facetOf(const Vec3f& out, const Vec3f& in, Vec3f& h) const {
        h = normalize(out + in * eta());
        if (h.z < 0.0f) h = -h;
        return dot(out, h) > 0.0f && dot(in, h) < 0.0f;
    }
    // Of directions beyond by facets: the change of solid angle.
    float stretch(const Vec3f& out, const Vec3f& in, const Vec3f& h) const {
        const float o = dot(out, h), i = dot(in, h), sum = o + eta() * i;
        return eta() * eta() * -i / std::max(1e-20f, sum * sum);
    }
    float throughValue(const LobePoint& at, const Vec3f& out, const Vec3f& in) const {
        const int side = isInside ? 1 : 0;
        float value = 0.0f;
        Vec3f h;
        if (facetOf(out, in, h))
            value = (1.0f - fresnelDielectric(clamp01(dot(out, h)), eta())) *
                    ggx.maskingOfBoth(out, in) * dot(out, h) * ggx.density(h) / out.z *
                    stretch(out, in, h);
        const float mean = table->meanMissing(1 - side, ggx.alpha);
        if (mean > 0.0f)
            value += table->crossing(side, ggx.alpha) * missing(out) *
                     table->missing(1 - side, -in.z, ggx.alpha) * -in.z * kInvPi / mean;
        // Radiance is gathered in the smaller cone.
        return at.transport == Transport::kRadiance ? value / (eta() * eta()) : value;
    }
    float throughDensity(const Vec3f& out, const Vec3f& in) const {
        const float more = missing(out);
        Vec3f h;
        const float facets =
            facetOf(out, in, h)
                ? (1.0f - reflects(dot(out, h))) * ggx.visibleDensity(out, h) * stretch(out, in, h)
                : 0.0f;
        return more * (1.0f - reflectsMore()) * -in.z * kInvPi + (1.0f - more) * facets;
    }
    Rgb scaled(const LobePoint& at, const Rgb& reflectance, const Rgb& value) const {
        return inProportion(reflectance, albedo(cosine(at)), value);
    }
};

}  // namespace pm
