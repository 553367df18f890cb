// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/gather_pilot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/transport/survey/pilot_paths.h"

namespace pm {

namespace {

// Paths through the frame, and rays and lamp samples at the end of each.
constexpr std::size_t kColumns = 24, kRows = 24;
constexpr std::uint32_t kRays = 16, kRaysOfSet = 32, kLampSamples = 4;
constexpr std::uint64_t kSeed = 0x6761746865727069ull;
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
    // Of a point that the path leaves by the diffuse lobe. guide: null: the rays go by the cosine.
    GatherPilot(const Scene& scene, const GatherEnds& ends, const PathStop& stop,
                const GatherGuide* guide)
        : m_scene(scene), m_ends(ends), m_stop(stop), m_frame(stop.bsdf.facingShadingNormal()) {
        if (guide) m_directions = guide->at(stop.surface.position, m_frame);
    }

    Rgb direct(const LightSampler& lights) const {
        std::uint32_t rays = 0;
        const Rgb direct =
            estimateDirect(m_scene, lights, m_stop.surface, m_stop.bsdf,
                           DirectStrategy::kNextEventOnly, true, kLampSamples, m_stop.sampler, rays)
                .of(Lobe::kDiffuse);
        return m_stop.throughput * direct;
    }

    // What the eye sees of a gather ray.
    Rgb seen(bool guided, Sampler random) const {
        const Vec2f u = random.get2D(Purpose::kDirection);
        random.nextEvent();
        const auto warped =
            guided ? m_directions->warp(u) : GatherGuide::Directions::Warped{u, 1.0f};
        const Vec3f direction = normalize(m_frame.toWorld(sampleCosineHemisphere(warped.u)));
        if (!(dot(direction, m_stop.bsdf.facingGeometricNormal()) > 0.0f)) return {};
        GatherEnds ends = m_ends;
        ends.width = m_stop.footprint.width();
        const Rgb radiance = finalGather(m_scene, ends, rayFrom(m_stop.surface, direction),
                                         dot(direction, m_frame.normal), random)
                                 .radiance.wide;
        return m_stop.throughput * m_stop.bsdf.diffuse() * (radiance / warped.density);
    }

    // The mean of kRaysOfSet rays, as well spread as a gather point's; each set has its number.
    Rgb meanOfSet(std::uint32_t set, bool guided) const {
        const Sampler shared = m_stop.sampler.branch(set);
        Rgb sum;
        for (std::uint32_t i = 0; i < kRaysOfSet; ++i) sum += seen(guided, shared.at(i));
        return sum / static_cast<float>(kRaysOfSet);
    }

  private:
    const Scene& m_scene;
    const GatherEnds& m_ends;
    const PathStop& m_stop;
    Frame m_frame;
    std::optional<GatherGuide::Directions> m_directions;
};

double spreadAt(const GatherPilot& pilot, const LightSampler& lights, const Sampler& sampler,
                double offset) {
    const Rgb direct = pilot.direct(lights);
    Moments moments[3];
    for (std::uint32_t i = 0; i < kRays; ++i) {
        const Rgb seen = pilot.seen(false, sampler.branch(i));
        for (int c = 0; c < 3; ++c) moments[c].add(static_cast<double>(seen[c]));
    }
    double spread = 0;
    for (int c = 0; c < 3; ++c) {
        const double r = moments[c].mean() + static_cast<double>(direct[c]);
        spread += moments[c].variance() / (r * r + offset);
    }
    return std::min(spread / 3, kLargestSpread);
}

// By two sets of rays each way: half of the square of what they differ by is the variance of one.
GatherRivals rivalsAt(const GatherPilot& pilot, const LightSampler& lights, double offset) {
    const Rgb direct = pilot.direct(lights);
    const Rgb cosine[2] = {pilot.meanOfSet(0, false), pilot.meanOfSet(1, false)};
    const Rgb guide[2] = {pilot.meanOfSet(2, true), pilot.meanOfSet(3, true)};
    GatherRivals rivals;
    for (int c = 0; c < 3; ++c) {
        const auto of = [c](const Rgb& rgb) { return static_cast<double>(rgb[c]); };
        const double r = (of(guide[0]) + of(guide[1])) / 2 + of(direct);
        const double scale = kRaysOfSet / 2.0 / (r * r + offset) / 3;
        rivals.byCosine += std::pow(of(cosine[0]) - of(cosine[1]), 2) * scale;
        rivals.byGuide += std::pow(of(guide[0]) - of(guide[1]), 2) * scale;
    }
    return {std::min(rivals.byCosine, kLargestSpread), std::min(rivals.byGuide, kLargestSpread)};
}

// Calls use(path, stop) at the first diffuse surface of each path through the lattice.
template <typename Use>
void visitPlaces(const Scene& scene, const Camera& camera, const FrameLattice& lattice,
                 const RenderSettings& settings, const CancelCheck& cancel, const Use& use) {
    followPilotPaths(scene, camera, lattice, combineBits(settings.seed, kSeed), cancel,
                     [&](std::size_t path, const PathStop& stop) {
                         if (!stop.isGathered()) return stop.goesOn();
                         use(path, stop);
                         return false;
                     });
}

}  // namespace

double gatherSpread(const Scene& scene, const Camera& camera, const LightSampler& lights,
                    const GatherEnds& ends, const RenderSettings& settings, const ErrorScale& scale,
                    const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::fixed(settings, kColumns, kRows);
    std::vector<double> spreads(lattice.size());
    visitPlaces(
        scene, camera, lattice, settings, cancel, [&](std::size_t path, const PathStop& stop) {
            spreads[path] =
                spreadAt({scene, ends, stop, nullptr}, lights, stop.sampler, scale.offset());
        });
    double sum = 0;
    for (const double spread : spreads) sum += spread;
    return sum / static_cast<double>(spreads.size());
}

GatherRivals gatherRivals(const Scene& scene, const Camera& camera, const LightSampler& lights,
                          const GatherEnds& ends, const GatherGuide& guide,
                          const RenderSettings& settings, const ErrorScale& scale,
                          const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::fixed(settings, kColumns, kRows);
    std::vector<GatherRivals> all(lattice.size());
    visitPlaces(scene, camera, lattice, settings, cancel,
                [&](std::size_t path, const PathStop& stop) {
                    all[path] = rivalsAt({scene, ends, stop, &guide}, lights, scale.offset());
                });
    GatherRivals mean;
    for (const GatherRivals& rivals : all) {
        mean.byCosine += rivals.byCosine / static_cast<double>(all.size());
        mean.byGuide += rivals.byGuide / static_cast<double>(all.size());
    }
    return mean;
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
