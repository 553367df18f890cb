// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/ggx_albedo.h"
#include "integrator/materials/lobes/local_reflection.h"
#include "integrator/materials/lobes/stretched_albedo.h"

namespace pm {

// Reflection by a rough surface, with what is scattered by more than one facet. Its reflectance
// is what albedo() tells, times the opacity.
//
// With E(mu) the share that one scattering reflects along mu where facets absorb nothing, what is
// missing goes on as (1 - E(in)) (1 - E(out)) / (pi (1 - mean E)), times what the facets leave of
// it: energy is kept and the lobe is reciprocal. Source: Kulla & Conty, "Revisiting Physically
// Based Shading at Imageworks", SIGGRAPH 2017 course.
struct GgxReflection {
    Ggx ggx;
    Fresnel fresnel;
    Vec3f tangent{};  // unit: along which facets are stretched; of any length where none are
    const StretchedAlbedo* stretched = nullptr;  // of that stretch; null where there is none

    // Of even light along a cosine.
    Rgb albedo(float cosine) const {
        const GgxShares shares = GgxAlbedo::table().at(cosine, ggx.alpha);
        return once(shares, fresnel.at(cosine)) + ofMore() * shares.missing();
    }

    // Its mean over directions, each by its cosine.
    Rgb mean() const {
        const GgxShares shares = GgxAlbedo::table().mean(ggx.alpha);
        return once(shares, fresnel.mean()) + ofMore() * shares.missing();
    }
    // In one scattering; there: what facets reflect there, of curves that shares don't know.
    Rgb once(const GgxShares& shares, const Rgb& there) const {
        return fresnel.curve == Fresnel::Curve::kSchlick
                   ? fresnel.tint * shares.normal + (Rgb(1.0f) - fresnel.tint) * shares.grazing
                   : there * shares.normal;
    }
    // What the facets leave of light that is scattered more than once.
    Rgb ofMore() const {
        const Rgb mean = fresnel.mean();
        const float once = GgxAlbedo::table().mean(ggx.alpha).normal;
        const auto channel = [&](float f) { return f * f * once / (1.0f - f * (1.0f - once)); };
        return {channel(mean.r), channel(mean.g), channel(mean.b)};
    }
    static float cosine(const LobePoint& at) { return cosineOfOut(at); }

    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        return evaluateLocal(*this, at, reflectance, in);
    }
    float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) const {
        return pdfLocal(*this, at, in, choice);
    }
    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        return sampleLocal(*this, at, u, sample);
    }

    // As a LocalReflection has them.
    Frame frame(const LobePoint& at) const {
        return ggx.stretch == 1.0f ? Frame(at.ns) : Frame(at.ns, tangent);
    }
    Rgb value(const Vec3f& out, const Vec3f& in) const {
        const Vec3f h = normalize(out + in);
        const Rgb direct = fresnel.at(clamp01(dot(out, h))) *
                           (ggx.density(h) * ggx.maskingOfBoth(out, in) / (4.0f * out.z));
        const float meanMissing = stretched ? stretched->meanMissing(ggx.alpha)
                                            : GgxAlbedo::table().mean(ggx.alpha).missing();
        if (!(meanMissing > 0.0f)) return direct;
        return direct +
               ofMore() * (shareOfMore(out) * shareOfMore(in) * kInvPi * in.z / meanMissing);
    }
    float density(const Vec3f& out, const Vec3f& in) const {
        const Vec3f h = normalize(out + in);
        const float more = shareOfMore(out);
        const float facets = ggx.visibleDensity(out, h) / (4.0f * std::max(1e-12f, dot(out, h)));
        return more * in.z * kInvPi + (1.0f - more) * facets;
    }
    bool sampleIn(const Vec3f& out, Vec2f u, Vec3f& in) const {
        const float more = shareOfMore(out);
        if (u.x < more) {
            in = sampleCosineHemisphere({u.x / more, u.y});
        } else {
            const Vec3f h = ggx.sampleVisible(out, {(u.x - more) / (1.0f - more), u.y});
            in = normalize(h * (2.0f * dot(out, h)) - out);
        }
        return in.z > 0.0f;
    }

  private:
    float shareOfMore(const Vec3f& out) const {
        if (stretched) return stretched->missing(out, ggx.alpha);
        return GgxAlbedo::table().at(out.z, ggx.alpha).missing();
    }
};

}  // namespace pm
