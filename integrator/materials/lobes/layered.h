// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/lobes/ggx_reflection.h"
#include "integrator/materials/lobes/layer_pass.h"
#include "integrator/materials/lobes/local_reflection.h"
#include "integrator/materials/lobes/sheen.h"

namespace pm {

// A share of even light that a layer on top lets pass along a cosine, in every channel.
template <LocalReflection Top>
float passesBelow(const Top& top, float cover, float cosine) {
    constexpr float kLeast = 1e-4f;
    return std::max(kLeast, 1.0f - cover * maxChannel(top.albedo(std::max(1e-4f, cosine))));
}

// Of a layer as it is by default.
template <LocalReflection Top>
const LayerPass* usualPass() {
    static const LayerPass pass([](float cosine) { return passesBelow(Top{}, 1.0f, cosine); });
    return &pass;
}

// What a rough lobe below such a layer sends back of even light along a cosine.
inline Rgb albedoBelow(const GgxReflection& base, const LayerPass& pass, float cosine) {
    const LayerPass::Below below = pass.below(cosine, base.ggx.alpha);
    return base.once(below.once, base.fresnel.at(cosine)) + base.ofMore() * below.more;
}

// A clear coat or fibres over rough metal, or over the boundary of plastic: what the layer lets
// pass is reflected below it as LayerPass has it. Reciprocal; a white base sends back all.
template <LocalReflection Top>
struct Layered {
    Top top;
    float cover = 1.0f;  // share of the surface where it is
    GgxReflection base;
    const LayerPass* pass = usualPass<Top>();  // of that top and cover

    Rgb albedo(float cosine) const {
        return top.albedo(cosine) * cover + albedoBelow(base, *pass, cosine);
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

    Frame frame(const LobePoint& at) const { return base.frame(at); }
    Rgb value(const Vec3f& out, const Vec3f& in) const {
        const float alpha = base.ggx.alpha;
        return top.value(out, in) * cover +
               base.value(out, in) * (pass->at(out.z, alpha) * pass->at(in.z, alpha));
    }
    float density(const Vec3f& out, const Vec3f& in) const {
        const float share = shareOfTop(out.z);
        return share * top.density(out, in) + (1.0f - share) * base.density(out, in);
    }
    bool sampleIn(const Vec3f& out, Vec2f u, Vec3f& in) const {
        const float share = shareOfTop(out.z);
        const bool isOfTop = u.x < share;
        u.x = std::min(isOfTop ? u.x / share : (u.x - share) / (1.0f - share), 1.0f - 0x1p-24f);
        return isOfTop ? top.sampleIn(out, u, in) : base.sampleIn(out, u, in);
    }

  private:
    float shareOfTop(float cosine) const {
        constexpr float kLeast = 0.1f;
        const float ofTop = meanChannel(top.albedo(cosine)) * cover;
        const float ofBase = meanChannel(base.albedo(cosine)) * passesBelow(top, cover, cosine);
        return std::clamp(ofTop / std::max(1e-12f, ofTop + ofBase), kLeast, 1.0f - kLeast);
    }
};

}  // namespace pm
