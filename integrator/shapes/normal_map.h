// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/vec.h"

namespace pm {

// What a normal map's components stand along at a point: the tangent (where u grows), the bitangent
// (where v grows) and the normal, as they are interpolated from the corners. They are neither made
// unit nor put at right angles again, since programs that bake maps don't either.
struct TangentFrame {
    Vec3f tangent, bitangent, normal;
};

// isMirrored: see Tangents; of the normal's front.
inline TangentFrame tangentFrame(const Vec3f& tangent, const Vec3f& normal, bool isMirrored) {
    const Vec3f across = cross(normal, tangent);
    return {tangent, isMirrored ? -across : across, normal};
}

// A normal that some map turned, as far up as it has to be: beyond the horizon of its own surface
// it would say nothing of its front. Both unit.
inline Vec3f aboveHorizon(const Vec3f& normal, const Vec3f& geometricNormal) {
    constexpr float kLeast = 1e-3f;
    const float above = dot(normal, geometricNormal);
    return above < kLeast ? normalize(normal + geometricNormal * (kLeast - above)) : normal;
}

// The normal that a map turns a shading normal to. mapped: its components in the frame. Where there
// is no tangent, or the map says nothing, it is the normal itself. On the side of the geometric
// normal; both unit.
inline Vec3f mappedNormal(const Vec3f& shadingNormal, const Vec3f& geometricNormal,
                          const TangentFrame& frame, const Vec3f& mapped) {
    if (mapped.x == 0.0f && mapped.y == 0.0f) return shadingNormal;
    if (!(lengthSquared(frame.tangent) > 0.0f)) return shadingNormal;
    const Vec3d turned = Vec3d(frame.tangent) * static_cast<double>(mapped.x) +
                         Vec3d(frame.bitangent) * static_cast<double>(mapped.y) +
                         Vec3d(frame.normal) * static_cast<double>(mapped.z);
    if (!(lengthSquared(turned) > 0.0)) return shadingNormal;
    return aboveHorizon(Vec3f(normalize(turned)), geometricNormal);
}

}  // namespace pm
