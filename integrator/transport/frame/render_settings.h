// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>

#include "integrator/sampling/pixel_filter.h"
#include "integrator/values/error_scale.h"
#include "integrator/values/rect.h"

namespace pm {

// In the order of the choices of the setting "integrator". All but the first do without photons.
enum class IntegratorKind { kPhoton, kPath };

// What the photon integrator uses: the maps that a scene needs, or all there are.
enum class PlanKind { kAuto, kEverything };

// Everything that a picture depends on beside the scene. Ranges are checked by whoever fills it.
struct RenderSettings {
    std::int32_t width = 640;  // pixels of the frame
    std::int32_t height = 480;
    Rect window{0, 0, 640, 480};  // pixels to render; may exceed the frame
    IntegratorKind integrator = IntegratorKind::kPhoton;
    PlanKind plan = PlanKind::kAuto;
    std::uint64_t photons = 0;           // emitted a pass; 0 = chosen by the plan
    std::uint32_t estimatePhotons = 50;  // k of the k-nearest estimates, >= 2
    std::uint32_t gatherRays = 0;        // of each gather point; 0 = chosen by the plan
    std::uint32_t passes = 4;            // >= 1
    PixelFilter filter = PixelFilter::kBox;
    // 0..6: 4^(level-1) samples a pixel in four passes, at least; at level 0 the four pixels of a
    // group share them.
    std::uint32_t aaLevel = 3;
    std::uint32_t aaLevelMost = 0;  // as well, at most, where they differ; 0 = aaLevel, everywhere
    double aaThreshold = 0.01;      // SampleRule::threshold, > 0
    std::optional<ErrorScale> errorScale;  // else the plan finds it
    std::uint64_t seed = 1;
    bool wantAlbedo = false;
    bool wantNormal = false;
    bool wantDepth = false;

    // Whether pixels get unlike numbers of samples, by what they show.
    bool isAdaptive() const { return aaLevelMost > aaLevel; }
    // Whether groups of 2 x 2 pixels, on even coordinates of the frame, begin as one pixel each.
    bool hasGroups() const { return aaLevel == 0; }
};

}  // namespace pm
