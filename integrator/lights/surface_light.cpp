// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/surface_light.h"

#include <cmath>

namespace pm {

Ray shadowSegment(const Vec3f& from, const LampPoint& to) {
    const Vec3f straight = to.position - from;
    const float reach = std::sqrt(lengthSquared(straight));
    const Vec3f end = to.position + to.normal * (to.offset + 4.0f * 0x1p-24f * reach);
    return {from, end - from, 1.0f - 8.0f * 0x1p-24f};
}

bool sampleLampPoint(const Surface& from, const LampPoint& point, float probability, float area,
                     LightSample& sample) {
    const Vec3f toLight = point.position - from.position;
    const float d2 = lengthSquared(toLight);
    if (!(d2 > 0.0f)) return false;
    sample.direction = toLight / std::sqrt(d2);
    const float cosine = -dot(sample.direction, point.normal);
    if (!(cosine > 0.0f)) return false;
    sample.pdfSolidAngle = probability * d2 / (area * cosine);
    sample.isPoint = false;
    sample.shadowRay = shadowSegment(rayOrigin(from, sample.direction), point);
    return true;
}

}  // namespace pm
