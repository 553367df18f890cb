// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/ggx_albedo.h"
#include "integrator/materials/lobes/lobe_point.h"

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

    // Of even light along a cosine.
    Rgb albedo(float cosine) const {
        const GgxShares shares = GgxAlbedo::table().at(cosine, ggx.alpha);
        const Rgb once =
            fresnel.curve == Fresnel::Curve::kSchlick
                ? fresnel.tint * shares.normal + (Rgb(1.0f) - fresnel.tint) * shares.grazing
                : fresnel.at(cosine) * shares.normal;
        return once + ofMore() * shares.missing();
    }

    // Its mean over directions, each by its cosine.
    Rgb mean() const {
        const GgxShares shares = GgxAlbedo::table().mean(ggx.alpha);
        const Rgb once =
            fresnel.curve == Fresnel::Curve::kSchlick
                ? fresnel.tint * shares.normal + (Rgb(1.0f) - fresnel.tint) * shares.grazing
                : fresnel.mean() * shares.normal;
        return once + ofMore() * shares.missing();
    }
    // The cosine that counts: none is so small that nothing is reflected.
    static float cosine(const LobePoint& at) { return std::max(1e-4f, dot(at.out, at.ns)); }

    Rgb evaluate(const LobePoint& at, const Rgb& reflectance, const Vec3f& in) const {
        if (!at.isReflection(in)) return {};
        const Frame frame(at.ns);
        const Vec3f out = frame.toLocal(at.out), local = frame.toLocal(in);
        if (!(out.z > 0.0f && local.z > 0.0f)) return {};
        return scaled(at, reflectance, value(out, local)) * at.adjointCorrection(in);
    }

    float pdfSolidAngle(const LobePoint& at, const Vec3f& in, float choice) const {
        const Frame frame(at.ns);
        const Vec3f out = frame.toLocal(at.out), local = frame.toLocal(in);
        if (!(out.z > 0.0f && local.z > 0.0f)) return 0.0f;
        return choice * density(out, local);
    }

    bool sample(const LobePoint& at, Vec2f u, BsdfSample& sample) const {
        const Frame frame(at.ns);
        const Vec3f out = frame.toLocal(at.out);
        if (!(out.z > 0.0f)) return false;
        const float more = shareOfMore(out);
        Vec3f in;
        if (u.x < more) {
            in = sampleCosineHemisphere({u.x / more, u.y});
        } else {
            const Vec3f h = ggx.sampleVisible(out, {(u.x - more) / (1.0f - more), u.y});
            in = normalize(h * (2.0f * dot(out, h)) - out);
        }
        if (!(in.z > 0.0f)) return false;
        sample.direction = normalize(frame.toWorld(in));
        sample.weight = scaled(at, sample.weight, value(out, in)) *
                        (at.adjointCorrection(sample.direction) / density(out, in));
        return at.isReflection(sample.direction);
    }

  private:
    // What the facets leave of light that is scattered more than once.
    Rgb ofMore() const {
        const Rgb mean = fresnel.mean();
        const float once = GgxAlbedo::table().mean(ggx.alpha).normal;
        const auto channel = [&](float f) { return f * f * once / (1.0f - f * (1.0f - once)); };
        return {channel(mean.r), channel(mean.g), channel(mean.b)};
    }

    float shareOfMore(const Vec3f& out) const {
        return GgxAlbedo::table().at(out.z, ggx.alpha).missing();
    }

    // f |cos|; both above the surface.
    Rgb value(const Vec3f& out, const Vec3f& in) const {
        const Vec3f h = normalize(out + in);
        const Rgb once = fresnel.at(clamp01(dot(out, h))) *
                         (ggx.density(h) * ggx.maskingOfBoth(out, in) / (4.0f * out.z));
        const float meanMissing = GgxAlbedo::table().mean(ggx.alpha).missing();
        if (!(meanMissing > 0.0f)) return once;
        return once + ofMore() * (shareOfMore(out) * shareOfMore(in) * kInvPi * in.z / meanMissing);
    }

    float density(const Vec3f& out, const Vec3f& in) const {
        const Vec3f h = normalize(out + in);
        const float more = shareOfMore(out);
        const float facets = ggx.visibleDensity(out, h) / (4.0f * std::max(1e-12f, dot(out, h)));
        return more * in.z * kInvPi + (1.0f - more) * facets;
    }

    // A value of which the reflectance is not all yet: textures and opacity.
    Rgb scaled(const LobePoint& at, const Rgb& reflectance, const Rgb& value) const {
        return inProportion(reflectance, albedo(cosine(at)), value);
    }
};

}  // namespace pm
