// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/lamp_samples.h"

#include <cstddef>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "integrator/sampling/sampler.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/transport/survey/pilot_paths.h"

namespace pm {

namespace {

// Pilot paths of the frame.
constexpr double kMostPaths = 1024.0;
constexpr std::uint64_t kPilotSeed = 0x6c616d7073616d70ull;

// Lamp samples of each of a place's two sets: as many as a half of the passes has camera samples
// when a picture is near a relMSE of 1e-3. What so many leave, spread well, is what counts.
constexpr std::uint32_t kSet = 8;
// Processor seconds of a lamp sample, measured; docs/decisions.md.
constexpr double kLampSampleSeconds = 0.2e-6;
// Of indirect light it is known only that there is some: as much as if half of what a place sees
// were as bright as the frame's places are on average.
constexpr float kBrightHalf = 0.5f;
// All other variance of a camera sample: of the light that its gather rays bring this share, if
// what they find differs as the frame's places do, and of edges and photons so much, over
// (r^2 + offset) of relMSE. Measured; docs/decisions.md.
constexpr double kGatheredShare = 0.1, kLeastRest = 0.002;

// Where a pilot path ends: direct light by either set, and what it reflects of light all around.
struct Lit {
    Rgb a, b, reflected;
};

Rgb estimate(const Scene& scene, const LightSampler& lights, const Surface& surface,
             const Bsdf& bsdf, const Sampler& sampler) {
    std::uint32_t rays = 0;
    const DirectRadiance direct = estimateDirect(scene, lights, surface, bsdf,
                                                 DirectStrategy::kBoth, true, kSet, sampler, rays);
    return direct.of(Lobe::kDiffuse) + direct.shiny();
}

// At the first lobe of each path that is not delta; black where it meets none.
std::vector<Lit> lookAround(const Scene& scene, const LightSampler& lights, const Camera& camera,
                            const RenderSettings& settings, const CancelCheck& cancel) {
    const FrameLattice lattice = FrameLattice::squares(settings, kMostPaths);
    const std::uint64_t seed = combineBits(settings.seed, kPilotSeed);
    std::vector<Lit> found(lattice.size());
    followPilotPaths(
        scene, camera, lattice, seed, cancel, [&](std::size_t path, const PathStop& stop) {
            if (!stop.bsdf.reflectsLamps()) return true;
            const auto byStream = [&](std::uint64_t stream) {
                return stop.throughput * estimate(scene, lights, stop.surface, stop.bsdf,
                                                  Sampler(seed, stream, path, 0));
            };
            found[path] = {byStream(1), byStream(2), stop.throughput * stop.bsdf.diffuse()};
            return false;
        });
    return found;
}

// Variances of a camera sample with one lamp sample over (r^2 + offset), as in relMSE; means over
// paths and channels.
struct Variances {
    double lamps = 0;  // of a lamp sample, one of kSet
    double rest = 0;
};

Variances variancesOf(const std::vector<Lit>& places, bool hasIndirect, double offset) {
    const auto count = static_cast<float>(places.size());
    Rgb mean;
    for (const Lit& place : places) mean += (place.a + place.b) * (0.5f / count);
    const Rgb around = hasIndirect ? mean * kBrightHalf : Rgb{};
    double lamps = 0, gathered = 0;
    for (const Lit& place : places)
        for (int c = 0; c < 3; ++c) {
            const float direct = 0.5f * (place.a[c] + place.b[c]);
            const auto r = static_cast<double>(direct + place.reflected[c] * around[c]);
            const auto noise = static_cast<double>(place.a[c] - place.b[c]);
            const auto unlike = static_cast<double>(place.reflected[c] * (direct - mean[c]));
            lamps += kSet * noise * noise / 2 / (r * r + offset);
            gathered += unlike * unlike / (r * r + offset);
        }
    const double share = 1.0 / (3.0 * static_cast<double>(count));
    return {lamps * share, kLeastRest + (hasIndirect ? kGatheredShare * gathered * share : 0.0)};
}

}  // namespace

// With n lamp samples a camera sample takes the time C + n c and has the variance R + V / n; their
// product, the time to an error, is least at n^2 = V C / (R c).
std::uint32_t findLampSamples(const Scene& scene, const LightSampler& lights, const Camera& camera,
                              const RenderSettings& settings, const Plan& plan,
                              const CancelCheck& cancel) {
    if (lights.empty()) return 1;
    const Variances variances = variancesOf(lookAround(scene, lights, camera, settings, cancel),
                                            plan.globalMap, plan.errorScale.offset());
    const double squared =
        variances.lamps / variances.rest * plan.processorSecondsPerSample / kLampSampleSeconds;
    std::uint32_t samples = 1;
    // The nearest power of two: up to sqrt(2) times that.
    while (samples < kMostLampSamples && squared > 2.0 * samples * samples) samples *= 2;
    return samples;
}

}  // namespace pm
