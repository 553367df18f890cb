// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/support/looks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

namespace pm::test {

namespace {

// A pass whose radii are two fifths of the first one's.
constexpr std::uint32_t kLatePass = 60;
// For what is looked at again: beside a bright caustic bias falls faster than the law at first, and
// what is extrapolated from there comes out too dark.
constexpr std::uint32_t kLatestPass = 4000;
constexpr double kLargestZ = 4;

// Mean of f_i^2, the radii's squares over the first pass's, from one pass on (docs/physics.md).
double meanSquareFactor(std::uint32_t first, std::uint32_t passes) {
    double squared = 1, sum = 0;
    for (std::uint32_t i = 0; i < first + passes; ++i) {
        if (i >= first) sum += squared / passes;
        squared *= (i + 2.0 / 3.0) / (i + 1.0);
    }
    return sum;
}

// A photon-mapped render without its bias. Where light is smooth bias goes as the square of the
// radii, so early and late passes tell what is left at none (Richardson's extrapolation). Emission
// and direct light have none: their mean. kCorrected: of the early passes, whose estimate of their
// bias is the renderer's own.
RegionMeans withoutBias(const RegionMeans& early, std::uint32_t firstEarly, const RegionMeans& late,
                        std::uint32_t firstLate, std::uint32_t passes) {
    const double ofEarly = meanSquareFactor(firstEarly, passes);
    const double ofLate = meanSquareFactor(firstLate, passes);
    RegionMeans result = early;
    for (std::size_t r = 0; r < early.size(); ++r)
        for (std::size_t c = 0; c < 3; ++c) {
            double& beauty = result[r][kBeauty][c] = 0;
            for (const Layer layer : {kEmission, kDirect, kCaustic, kIndirect}) {
                const double a = early[r][layer][c], b = late[r][layer][c];
                const bool hasBias = layer == kCaustic || layer == kIndirect;
                beauty += result[r][layer][c] =
                    hasBias ? (b * ofEarly - a * ofLate) / (ofEarly - ofLate) : (a + b) / 2;
            }
        }
    return result;
}

// The classes sum to the picture.
RegionMeans withClassesChecked(const RegionMeans& means) {
    for (const LayerMeans& m : means)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(m[kEmission][c] + m[kDirect][c] + m[kCaustic][c] + m[kIndirect][c],
                        m[kBeauty][c], 1e-6 * m[kBeauty][c]);
    return means;
}

constexpr double kRounding = 2e-6;
// The renderer's own estimate of its bias is not all of it: 0.05 to 0.1 % of frames is left.
constexpr double kOwnEstimateLeaves = 0.001;

// Passes of a look at photons: early and late ones, or again by later ones; those know the
// renderer's own estimate of its bias only where early ones are rendered, too.
enum class Photons { kFirst, kAgain, kAgainWithOwnEstimate };

RegionMeans photonMapped(const std::shared_ptr<const Scene>& scene, const LookSize& size,
                         const std::vector<Rect>& regions, std::uint64_t seed, Photons photons) {
    const RenderSettings settings = size.settings(IntegratorKind::kPhoton, seed);
    const auto rendered = [&](std::uint32_t first) {
        return withClassesChecked(render(scene, settings, regions, first));
    };
    const RegionMeans late = rendered(kLatePass);
    if (photons == Photons::kFirst)
        return withoutBias(rendered(0), 0, late, kLatePass, size.passes);
    RegionMeans result =
        withoutBias(late, kLatePass, rendered(kLatestPass), kLatestPass, size.passes);
    if (photons == Photons::kAgain) return result;
    const RegionMeans first = rendered(0);
    for (std::size_t r = 0; r < result.size(); ++r) result[r][kCorrected] = first[r][kCorrected];
    return result;
}

std::vector<RegionMeans> lookByPhotons(const std::shared_ptr<const Scene>& scene,
                                       const LookSize& size, const std::vector<Rect>& regions,
                                       std::uint64_t firstSeed, Photons photons) {
    std::vector<RegionMeans> seen;
    for (int i = 0; i < size.renders; ++i)
        seen.push_back(
            photonMapped(scene, size, regions, firstSeed + static_cast<std::uint64_t>(i), photons));
    return seen;
}

// Again: with 16 times as many samples of path tracing.
std::vector<RegionMeans> lookByPaths(const std::shared_ptr<const Scene>& scene,
                                     const LookSize& size, const std::vector<Rect>& regions,
                                     std::uint64_t firstSeed, Photons photons) {
    std::vector<RegionMeans> seen;
    for (int i = 0; i < size.renders; ++i) {
        RenderSettings path =
            size.settings(IntegratorKind::kPath, firstSeed + static_cast<std::uint64_t>(i));
        if (photons != Photons::kFirst) {
            path.passes *= 4;
            ++path.aaLevel;
        }
        seen.push_back(withClassesChecked(render(scene, path, regions)));
    }
    return seen;
}

Look lookAt(const std::shared_ptr<const Scene>& scene, const LookSize& size,
            const std::vector<Rect>& regions, std::uint64_t firstSeed, Photons photons) {
    return {lookByPhotons(scene, size, regions, firstSeed, photons),
            lookByPaths(scene, size, regions, firstSeed, photons)};
}

constexpr std::array<Layer, 6> kLayers = {kEmission, kDirect,    kCaustic,
                                          kIndirect, kCorrected, kBeauty};

struct Suspect {
    std::size_t region, channel;
    Layer layer;
};

// What is beyond kLargestZ. Prints the largest of each layer, and the mean of the squares.
std::vector<Suspect> suspects(const Look& seen, const std::string& what,
                              bool ofPictureOnly = false) {
    std::vector<Suspect> found;
    const std::size_t regions = seen.path.front().size();
    std::string line;
    for (const Layer layer : kLayers) {
        const bool isHeld = !ofPictureOnly || layer == kBeauty || layer == kCorrected;
        double largest = 0, squares = 0;
        for (std::size_t r = 0; r < regions; ++r)
            for (std::size_t c = 0; c < 3; ++c) {
                const double z = seen.z(r, layer, c);
                if (isHeld && !(z < kLargestZ)) found.push_back({r, c, layer});
                largest = std::max(largest, z);
                squares += z * z / static_cast<double>(3 * regions);
            }
        line += fmt::format(", {} {:.2f} ({:.2f})", kLayerNames[layer], largest, squares);
    }
    fmt::print("    {}, largest |z| and mean square of {}{}\n", what, regions, line);
    return found;
}

}  // namespace

RenderSettings LookSize::settings(IntegratorKind integrator, std::uint64_t seed) const {
    const bool photon = integrator == IntegratorKind::kPhoton;
    // Photons' noise is shared by the samples of a pass: more of those would tell little more.
    // Paths are cheap beside them.
    RenderSettings result = smallFrame(frame, frame, integrator, photon ? passes : 2 * passes,
                                       photon ? photonLevel : pathLevel);
    result.photons = photons;
    // Of one seed both would have their samples at the same places in the pixels: the errors of
    // both are to be independent.
    result.seed = photon ? seed : seed + 1000;
    return result;
}

double Look::z(std::size_t region, Layer layer, std::size_t channel) const {
    const Replicated a = spread(photon, region, layer, channel);
    const Replicated b = spread(path, region, layer, channel);
    const double allowed = layer == kCorrected ? kOwnEstimateLeaves : kRounding;
    return zScore(a, b, allowed * std::max(b.mean, frameMean(layer, channel)));
}

std::string Look::tell(std::size_t region, Layer layer, std::size_t channel) const {
    const Replicated a = spread(photon, region, layer, channel);
    const Replicated b = spread(path, region, layer, channel);
    return fmt::format("{}, channel {}: {:.6f} +- {:.6f}, path {:.6f} +- {:.6f}, z {:.2f}",
                       kLayerNames[layer], channel, a.mean, a.standardError, b.mean,
                       b.standardError, z(region, layer, channel));
}

double Look::frameMean(Layer layer, std::size_t channel) const {
    double sum = 0;
    for (const LayerMeans& region : path.front()) sum += region[layer][channel];
    return sum / static_cast<double>(path.front().size());
}

Look look(const std::shared_ptr<const Scene>& scene, const LookSize& size) {
    return lookAt(scene, size, size.regions(), firstSeed(), Photons::kFirst);
}

Look lookAtTwin(const std::shared_ptr<const Scene>& ofPhotons,
                const std::shared_ptr<const Scene>& ofPaths, const LookSize& size) {
    return {lookByPhotons(ofPhotons, size, size.regions(), firstSeed(), Photons::kFirst),
            lookByPaths(ofPaths, size, size.regions(), firstSeed(), Photons::kFirst)};
}

void lookAgain(const std::shared_ptr<const Scene>& scene, const LookSize& size, const Look& first,
               const std::string& name) {
    const std::vector<Rect> regions = size.regions();
    const std::vector<Suspect> found = suspects(first, name, size.ofPictureOnly);
    if (found.empty()) return;
    std::map<std::size_t, std::size_t> place;  // of a suspect's region among those looked at again
    std::vector<Rect> again;
    Photons photons = Photons::kAgain;
    for (const Suspect& s : found) {
        if (place.emplace(s.region, again.size()).second) again.push_back(regions[s.region]);
        if (s.layer == kCorrected) photons = Photons::kAgainWithOwnEstimate;
    }
    const Look second =
        lookAt(scene, size, again, firstSeed() + static_cast<std::uint64_t>(size.renders), photons);
    for (const Suspect& s : found) {
        const std::size_t at = place[s.region];
        const std::string told = fmt::format("{}, region {}, {}; again {}", name, s.region,
                                             first.tell(s.region, s.layer, s.channel),
                                             second.tell(at, s.layer, s.channel));
        fmt::print("    {}\n", told);
        EXPECT_LT(second.z(at, s.layer, s.channel), kLargestZ) << told;
    }
}

void expectFrameAgrees(const Look& frame, const std::string& what) {
    for (const Suspect& s : suspects(frame, what))
        ADD_FAILURE() << what << ", " << frame.tell(0, s.layer, s.channel);
}

void addFrame(Look& a, const Look& b) {
    a.photon.resize(b.photon.size());
    a.path.resize(b.path.size());
    for (std::size_t i = 0; i < b.path.size(); ++i) {
        addTo(a.photon[i], b.photon[i], 1);
        addTo(a.path[i], b.path[i], 1);
    }
}

}  // namespace pm::test
