// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "integrator/sampling/warps.h"
#include "integrator/values/vec.h"

namespace pm {

// A rough surface as Trowbridge & Reitz 1975 and Walter et al., "Microfacet Models for Refraction
// through Rough Surfaces", 2007, have it. All directions are unit, in a frame whose z is the
// surface's normal.
struct Ggx {
    float alpha = 0.5f;    // > 0: slopes' width, of which a roughness is the root
    float stretch = 1.0f;  // >= 1: that is wider along x by it, and as much narrower along y

    // Density of microfacets with a normal, D; sr^-1.
    float density(const Vec3f& h) const {
        const float a2 = alpha * alpha;
        const float s = spread2(h) / a2 + h.z * h.z;
        return 1.0f / (kPi * a2 * s * s);
    }
    // Smith's function: masking is 1 / (1 + lambda). Either side of the surface.
    float lambda(const Vec3f& w) const {
        const float z2 = w.z * w.z;
        if (!(z2 > 0.0f)) return std::numeric_limits<float>::max();
        const float slope2 = alpha * alpha * (square(w.x * stretch) + square(w.y / stretch)) / z2;
        // Without cancellation: sqrt(1 + s) - 1 = s / (sqrt(1 + s) + 1).
        return 0.5f * slope2 / (std::sqrt(1.0f + slope2) + 1.0f);
    }
    float masking(const Vec3f& w) const { return 1.0f / (1.0f + lambda(w)); }
    // Of two directions: Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014,
    // eq. 99, taken for directions on both sides as well.
    float maskingOfBoth(const Vec3f& a, const Vec3f& b) const {
        return 1.0f / (1.0f + lambda(a) + lambda(b));
    }
    // Density of the microfacets that are seen from `out`, above the surface: h sampled by it.
    float visibleDensity(const Vec3f& out, const Vec3f& h) const {
        const float seen = dot(out, h);
        return seen > 0.0f ? masking(out) * seen * density(h) / out.z : 0.0f;
    }
    // Source: Dupuy & Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
    Vec3f sampleVisible(const Vec3f& out, Vec2f u) const {
        const float x = alpha * stretch, y = alpha / stretch;
        const Vec3f o = normalize(Vec3f{x * out.x, y * out.y, out.z});
        const float z = 1.0f - u.x * (1.0f + o.z);
        const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
        const SinCos phi = sinCosTurns(u.y);
        const Vec3f h = Vec3f{radius * phi.cos, radius * phi.sin, z} + o;
        return normalize(Vec3f{x * h.x, y * h.y, std::max(1e-9f, h.z)});
    }

  private:
    static float square(float v) { return v * v; }
    // How far a normal leans, squared, where the stretch is taken back.
    float spread2(const Vec3f& h) const { return square(h.x / stretch) + square(h.y * stretch); }
};

// Calls visit(in, weight, cosine) for reflections of light that leaves along a direction, by
// `count` facets that are seen from there, spread evenly: where it comes from, above the surface;
// how much of it is not masked on that side; and the cosine at the facet. Weights over count add to
// what white facets reflect of even light.
template <typename Visit>
void forEachReflection(const Ggx& ggx, const Vec3f& out, std::uint32_t count, const Visit& visit) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3f h = ggx.sampleVisible(out, spreadPoint(i));
        const float seen = dot(out, h);
        const Vec3f in = h * (2.0f * seen) - out;
        if (in.z > 0.0f) visit(in, ggx.maskingOfBoth(out, in) / ggx.masking(out), seen);
    }
}

}  // namespace pm
