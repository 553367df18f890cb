// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/follow_footprint.h"

#include <cmath>

namespace pm {

void followFootprint(const Vec3f& in, const Surface& surface, const Bsdf& bsdf,
                     const BsdfSample& sample, RayFootprint& footprint) {
    if (!footprint.isKnown || sample.lobe == Lobe::kStraight) return;
    const Vec3f& normal = bsdf.facingShadingNormal();
    const bool turned = dot(normal, surface.shadingNormal) < 0.0f;
    if (sample.lobe == Lobe::kReflection)
        footprint.reflect(in, normal, turned);
    else if (sample.lobe == Lobe::kRefraction)
        footprint.refract(in, normal, turned, std::sqrt(sample.etaSquared));
    else
        footprint.widen(sample.direction, sample.pdfSolidAngle);
}

}  // namespace pm
