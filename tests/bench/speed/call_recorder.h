// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a render asks of its parts: rays, look-ups and random numbers, written down as they are
// asked for, so that they can be asked again and timed alone.
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/surface_estimate.h"
#include "integrator/rays/ray_tracer.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/gather/gather_points.h"

namespace pm::bench {

// The calls of the buckets of one pass, in their order. What is looked up in must outlive this.
struct RecordedCalls {
    struct Point {
        const GatherPoints* points;
        GatherPoints::Place place;
    };
    struct Caustic {
        const CausticMap* map;
        Vec3f position, normal;
        float pixelWidth;
    };
    struct Site {
        const IrradianceSites* sites;
        Vec3f position, normal;
    };
    struct Estimate {
        SurfaceEstimate estimate;
        Vec3f position, normal;
        std::uint32_t pattern;
    };
    std::vector<Ray> camera, onward, shadow, gather;
    std::vector<Point> points;
    std::vector<Caustic> caustics;
    std::vector<Site> sites;
    std::vector<Estimate> estimates;  // with rays of their own, which are nowhere else
    // Random numbers: samplers made, pairs and single numbers drawn.
    std::uint64_t samplers = 0, pairs = 0, singles = 0;
};

// Writes down all calls while it lives. The linker leads the calls between the renderer's object
// files here (see pm_bench_speed in CMakeLists.txt). Threads: the render must run on one; one
// recorder at a time.
class CallRecorder {
  public:
    CallRecorder();
    ~CallRecorder();
    CallRecorder(const CallRecorder&) = delete;
    CallRecorder& operator=(const CallRecorder&) = delete;

    // Throws Error(kInternal) when calls that no render does without were not seen: then the linker
    // was told wrong names.
    const RecordedCalls& calls() const;

  private:
    RecordedCalls m_calls;
};

}  // namespace pm::bench
