// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

#include "integrator/materials/invisible.h"
#include "integrator/photons/emission/aim_cone.h"
#include "integrator/scene/scene.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// What a lobe may reflect and still count as carrying nothing: far less than one photon a pass
// would bring.
inline constexpr float kCarriesNothing = 1e-6f;

// Whether light can leave a surface of this material other than diffusely, by a broad lobe or
// straight on, which makes it caustic.
inline bool castsCaustics(const MaterialDescription& material) {
    if (isDiffuseAtMost(material) || isInvisible(material)) return false;
    if (material.kind != MaterialKind::kDielectric && !material.fresnelMirror &&
        material.glossyTexture == kNoTexture && !(maxChannel(material.glossy) > kCarriesNothing))
        return false;
    const bool isPhong = material.kind == MaterialKind::kSurface ||
                         (material.kind == MaterialKind::kMirror && material.glossyExponent > 0.0f);
    return !(isPhong && isBroad(material));
}

// Casters that together hold every surface of the scene that casts caustics, at most kMostFound:
// as many as make the solid angle they fill, seen from the viewpoints, clearly smaller. Empty when
// nothing casts. Time: about that of sorting the casting triangles by place. Throws
// Error(kCancelled) soon after cancel is set.
std::vector<Caster> findCasters(const Scene& scene, std::span<const EmissionPoint> viewpoints,
                                const CancelCheck& cancel = {});

}  // namespace pm
