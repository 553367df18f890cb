// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather_pilot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"
#include "integrator/transport/direct_light.h"
#include "integrator/transport/final_gather.h"
#include "integrator/transport/pilot_paths.h"

namespace pm {

namespace {

// Paths through the frame, and rays and lamp samples at the end of each.
constexpr std::size_t kColumns = 24, kRows = 24;
constexpr std::uint32_t kRays = 16, kLampSamples = 4;
constexpr std::uint64_t kSeed = 0x6761746865727069ull;
// As in relMSE.
constexpr double kOffset = 0.01;
// A place whose light comes by few bright rays counts as if it had no larger spread than this:
// those few places gain nothing from what all the others would pay.
constexpr double kLargestSpread = 100.0;

// The spread at which the plan's number of rays is the one that pays, and the most that a larger
// spread gets. Measured; docs/decisions.md.
constexpr double kSpreadOfPlannedRays = 0.1;
constexpr std::uint32_t kMostTimesPlanned = 4;

struct Moments {
    double sum = 0, squares = 0;

    void add(double value) {
        sum += value;
        squares += value * value;
    }
    double mean() const { return sum / kRays; }
    double variance() const { return std::max(0.0, (squares - sum * sum / kRays) / (kRays - 1.0)); }
};

class GatherPilot {
  public:
    GatherPilot(const Scene& scene, const LightSampler& lights, const IrradianceSites& sites)
        : m_scene(scene), m_lights(lights), m_sites(sites) {}

    // Of a point that the path leaves by the diffuse lobe.
    double spreadAt(const PilotStop& stop) const {
        const auto& [surface, bsdf, throughput, lobe, sampler] = stop;
        std::uint32_t rays = 0;
        const Rgb direct = estimateDirect(m_scene, m_lights, surface, bsdf,
                                          LampStrategy::kNextEventOnly, kLampSamples, sampler, rays)
                               .diffuse;
        Moments moments[3];
        const Frame frame(bsdf.facingShadingNormal());
        for (std::uint32_t i = 0; i < kRays; ++i) {
            const Vec3f direction =
                normalize(frame.toWorld(sampleCosineHemisphere(sampler.next2D())));
            Rgb radiance;
            if (dot(direction, bsdf.facingGeometricNormal()) > 0.0f)
                radiance = finalGather(m_scene, m_sites, rayFrom(surface, direction), sampler)
                               .radiance.wide;
            const Rgb seen = throughput * bsdf.diffuse() * radiance;
            for (int c = 0; c < 3; ++c) moments[c].add(static_cast<double>(seen[c]));
        }
        double spread = 0;
        for (int c = 0; c < 3; ++c) {
            const double r = moments[c].mean() + static_cast<double>(throughput[c] * direct[c]);
            spread += moments[c].variance() / (r * r + kOffset);
        }
        return std::min(spread / 3, kLargestSpread);
    }

  private:
    const Scene& m_scene;
    const LightSampler& m_lights;
    const IrradianceSites& m_sites;
};

}  // namespace

double gatherSpread(const Scene& scene, const Camera& camera, const LightSampler& lights,
                    const IrradianceSites& sites, const RenderSettings& settings,
                    const CancelCheck& cancel) {
    const GatherPilot pilot(scene, lights, sites);
    const FrameLattice lattice = FrameLattice::fixed(settings, kColumns, kRows);
    std::vector<double> spreads(lattice.size());
    followPilotPaths(scene, camera, lattice, combineBits(settings.seed, kSeed), cancel,
                     [&](std::size_t path, const PilotStop& stop) {
                         if (stop.next != Lobe::kDiffuse) return true;
                         spreads[path] = pilot.spreadAt(stop);
                         return false;
                     });
    double sum = 0;
    for (const double spread : spreads) sum += spread;
    return sum / static_cast<double>(spreads.size());
}

// With n rays a pass takes the time C + n c and has the variance R + V / n; their product, the time
// to an error, is least at n^2 = V C / (R c): so n goes with the root of the spread.
std::uint32_t gatherRaysFor(double spread, std::uint32_t rays) {
    const double wanted = rays * std::sqrt(spread / kSpreadOfPlannedRays);
    std::uint32_t chosen = std::max(1u, rays / 2);
    while (chosen < kMostTimesPlanned * rays && wanted > chosen * std::numbers::sqrt2) chosen *= 2;
    return chosen;
}

}  // namespace pm
