// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include "integrator/sampling/sampler.h"
#include "tests/support/aimed.h"
#include "tests/support/scene_maker.h"

namespace pm::test {

// Share of the photons aimed at something that meet what casts before anything else. Nine tenths
// of all must be aimed at something.
inline double hitShare(const SceneMaker& maker, std::uint32_t photons) {
    const Aimed aimed(maker.build(), false);
    std::uint32_t aimedAt = 0, hit = 0;
    for (std::uint32_t i = 0; i < photons; ++i) {
        const Sampler sampler(1, 1, 0, i);
        const Vec2f choice = sampler.get2D(Purpose::kLight);
        const Vec2f point = sampler.get2D(Purpose::kPlace);
        AimedPhoton photon;
        const bool emitted =
            aimed.aim.emit(choice, point, sampler.get2D(Purpose::kDirection), photon);
        if (emitted && photon.caster == kNoCaster) continue;
        ++aimedAt;  // what carries nothing counts as missed
        Surface surface;
        hit += emitted && aimed.scene->intersect(photon.ray, surface) &&
               aimed.scene->material(surface.material).kind != MaterialKind::kSurface;
    }
    EXPECT_GT(aimedAt, photons / 10 * 9);
    return static_cast<double>(hit) / aimedAt;
}

}  // namespace pm::test
