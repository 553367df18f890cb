// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Every light path in exactly one class, every class with exactly one estimator: the sum of the
// classes, and each class, against path tracing; and the same light by another estimator.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "tests/support/replicates.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

constexpr std::int32_t kSize = 48, kRegion = 8;
constexpr int kRenders = 8;
constexpr std::uint32_t kPasses = 4;
// A pass whose radii are two fifths of the first one's.
constexpr std::uint32_t kLatePass = 60;
// For what is looked at again: beside a bright caustic bias falls faster than the law at first, and
// what is extrapolated from there comes out too dark.
constexpr std::uint32_t kLatestPass = 4000;
constexpr double kLargestZ = 4;

RenderSettings settingsOf(IntegratorKind integrator, std::uint64_t seed) {
    const bool photon = integrator == IntegratorKind::kPhoton;
    // Photons' noise is shared by the samples of a pass: more of those would tell little more.
    // Paths are cheap beside them.
    RenderSettings settings =
        smallFrame(kSize, kSize, integrator, photon ? kPasses : 2 * kPasses, photon ? 2 : 4);
    settings.photons = 40'000;
    // Of one seed both would have their samples at the same places in the pixels: the errors of
    // both are to be independent.
    settings.seed = photon ? seed : seed + 1000;
    return settings;
}

// Mean of f_i^2, the radii's squares over the first pass's, from one pass on (docs/physics.md).
double meanSquareFactor(std::uint32_t first) {
    double squared = 1, sum = 0;
    for (std::uint32_t i = 0; i < first + kPasses; ++i) {
        if (i >= first) sum += squared / kPasses;
        squared *= (i + 2.0 / 3.0) / (i + 1.0);
    }
    return sum;
}

// A photon-mapped render without its bias. Where light is smooth bias goes as the square of the
// radii, so early and late passes tell what is left at none (Richardson's extrapolation). Emission
// and direct light have none: their mean. kCorrected: of the early passes, whose estimate of their
// bias is the renderer's own.
RegionMeans withoutBias(const RegionMeans& early, std::uint32_t firstEarly, const RegionMeans& late,
                        std::uint32_t firstLate) {
    const double ofEarly = meanSquareFactor(firstEarly), ofLate = meanSquareFactor(firstLate);
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

// What was seen of a region by both.
struct Look {
    std::vector<RegionMeans> photon, path;

    double z(std::size_t region, Layer layer, std::size_t channel) const {
        const Replicated a = spread(photon, region, layer, channel);
        const Replicated b = spread(path, region, layer, channel);
        const double allowed = layer == kCorrected ? kOwnEstimateLeaves : kRounding;
        return zScore(a, b, allowed * std::max(b.mean, frameMean(layer, channel)));
    }
    std::string tell(std::size_t region, Layer layer, std::size_t channel) const {
        const Replicated a = spread(photon, region, layer, channel);
        const Replicated b = spread(path, region, layer, channel);
        return fmt::format("{}, channel {}: {:.6f} +- {:.6f}, path {:.6f} +- {:.6f}, z {:.2f}",
                           kLayerNames[layer], channel, a.mean, a.standardError, b.mean,
                           b.standardError, z(region, layer, channel));
    }

  private:
    static constexpr double kRounding = 2e-6;
    // The renderer's own estimate of its bias is not all of it: 0.05 to 0.1 % of frames is left.
    static constexpr double kOwnEstimateLeaves = 0.001;
    double frameMean(Layer layer, std::size_t channel) const {
        double sum = 0;
        for (std::size_t r = 0; r < path.front().size(); ++r)
            sum += path.front()[r][layer][channel];
        return sum / static_cast<double>(path.front().size());
    }
};

// Passes of a look at photons: early and late ones, or again by later ones; those know the
// renderer's own estimate of its bias only where early ones are rendered, too.
enum class Photons { kFirst, kAgain, kAgainWithOwnEstimate };

RegionMeans photonMapped(const std::shared_ptr<const Scene>& scene,
                         const std::vector<Rect>& regions, std::uint64_t seed, Photons photons) {
    const RenderSettings settings = settingsOf(IntegratorKind::kPhoton, seed);
    const auto rendered = [&](std::uint32_t first) {
        return withClassesChecked(render(scene, settings, regions, first));
    };
    const RegionMeans late = rendered(kLatePass);
    if (photons == Photons::kFirst) return withoutBias(rendered(0), 0, late, kLatePass);
    RegionMeans result = withoutBias(late, kLatePass, rendered(kLatestPass), kLatestPass);
    if (photons == Photons::kAgain) return result;
    const RegionMeans first = rendered(0);
    for (std::size_t r = 0; r < result.size(); ++r) result[r][kCorrected] = first[r][kCorrected];
    return result;
}

// Again: with 16 times as many samples of path tracing.
Look look(const std::shared_ptr<const Scene>& scene, const std::vector<Rect>& regions,
          std::uint64_t firstSeed, Photons photons = Photons::kFirst) {
    Look result;
    for (std::uint64_t seed = firstSeed; seed < firstSeed + kRenders; ++seed) {
        result.photon.push_back(photonMapped(scene, regions, seed, photons));
        RenderSettings path = settingsOf(IntegratorKind::kPath, seed);
        if (photons != Photons::kFirst) {
            path.passes *= 4;
            ++path.aaLevel;
        }
        result.path.push_back(withClassesChecked(render(scene, path, regions)));
    }
    return result;
}

constexpr std::array<Layer, 6> kLayers = {kEmission, kDirect,    kCaustic,
                                          kIndirect, kCorrected, kBeauty};

struct Suspect {
    std::size_t region, channel;
    Layer layer;
};

// What is beyond kLargestZ. Prints the largest of each layer, and the mean of the squares.
std::vector<Suspect> suspects(const Look& seen, const std::string& what) {
    std::vector<Suspect> found;
    const std::size_t regions = seen.path.front().size();
    std::string line;
    for (const Layer layer : kLayers) {
        double largest = 0, squares = 0;
        for (std::size_t r = 0; r < regions; ++r)
            for (std::size_t c = 0; c < 3; ++c) {
                const double z = seen.z(r, layer, c);
                if (!(z < kLargestZ)) found.push_back({r, c, layer});
                largest = std::max(largest, z);
                squares += z * z / static_cast<double>(3 * regions);
            }
        line += fmt::format(", {} {:.2f} ({:.2f})", kLayerNames[layer], largest, squares);
    }
    fmt::print("    {}, largest |z| and mean square of {}{}\n", what, regions, line);
    return found;
}

// Regions that are beyond in the first look, looked at again, all in one render: with other seeds,
// 16 times as many samples of path tracing, and narrower radii. What is beyond again fails.
void lookAgain(const std::shared_ptr<const Scene>& scene, const Look& first,
               const std::vector<Rect>& regions, const std::string& name) {
    const std::vector<Suspect> found = suspects(first, name);
    if (found.empty()) return;
    std::map<std::size_t, std::size_t> place;  // of a suspect's region among those looked at again
    std::vector<Rect> again;
    Photons photons = Photons::kAgain;
    for (const Suspect& s : found) {
        if (place.emplace(s.region, again.size()).second) again.push_back(regions[s.region]);
        if (s.layer == kCorrected) photons = Photons::kAgainWithOwnEstimate;
    }
    const Look second = look(scene, again, firstSeed() + kRenders, photons);
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

// a += b.
void addFrame(Look& a, const Look& b) {
    a.photon.resize(b.photon.size());
    a.path.resize(b.path.size());
    for (std::size_t i = 0; i < b.path.size(); ++i) {
        addTo(a.photon[i], b.photon[i], 1);
        addTo(a.path[i], b.path[i], 1);
    }
}

// By 8 x 8 regions, of each frame, and of all frames together, which tell a hundredth of the
// indirect light. No bias is allowed for but what the renderer's own estimate leaves. Among
// thousands of regions' numbers a few are beyond 4 standard errors by chance, the more as path
// tracing may miss a region's rare light and with it its spread: those are looked at again.
TEST(Partition, AgreesWithPath) {
    const std::vector<Rect> regions = squares(kSize, kSize, kRegion);
    Look frames;
    for (const Room& room : roomsOfEveryLobe()) {
        const auto scene = room.maker.build();
        const Look first = look(scene, regions, firstSeed());
        const Look frame{wholeFrames(first.photon), wholeFrames(first.path)};
        expectFrameAgrees(frame, room.name + ", frame");
        lookAgain(scene, first, regions, room.name);
        addFrame(frames, frame);
    }
    expectFrameAgrees(frames, "all frames");
}

// Light descended from caustics, found by gather rays that meet those, and by an estimate of its
// own, where it is a tenth of all light. PhotonClasses.AddUp looks closer.
TEST(PartitionMoves, LightDescendedFromCaustics) {
    for (const Room& room : roomsOfEveryLobe()) {
        if (room.name != "mirror behind glass" && room.name != "partly transparent") continue;
        const auto scene = room.maker.build();
        const std::vector<Rect> regions = squares(kSize, kSize, 16);
        const auto rendered = [&](float descent) {
            return replicate(8, [&](std::uint64_t seed) {
                RenderSettings settings = settingsOf(IntegratorKind::kPhoton, seed);
                settings.passes = 2;
                Plan plan = makePlan(*scene, settings);
                EXPECT_GT(plan.descent, 0);
                plan.descent = descent;
                return PlannedRender(scene, settings, plan).render(regions, 2);
            });
        };
        const auto gathered = rendered(0), estimated = rendered(0.5f);
        expectAgreement(estimated, gathered, kCorrected, 0.01, 4, room.name);
        expectAgreement(wholeFrames(estimated), wholeFrames(gathered), kCorrected, 0.002, 4,
                        room.name);
        const Replicated whole = spread(wholeFrames(gathered), 0, kCorrected, 1);
        EXPECT_LT(whole.standardError, 0.01 * whole.mean);
    }
}

// What a plan leaves out, since the scene has no need of it, would have brought nothing.
TEST(PartitionMoves, PlanEverything) {
    std::vector<Room> rooms = {roomsOfEveryLobe().front()};
    const auto seen = [](SceneMaker maker) {
        maker.camera({0, 2, 3}, {0, 0, 0}, {0, 1, 0}, 40);
        return maker;
    };
    SceneMaker flat;
    flat.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, flat.diffuse(Rgb(0.5f)));
    flat.pointLight({0.3, 1, 0}, Rgb(1.0f));
    rooms.push_back({"flat floor", seen(flat)});
    SceneMaker mirrors;
    mirrors.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, mirrors.material(mirror()));
    mirrors.sphere({0, 0.5, 0}, 0.3, mirrors.diffuse({}, Rgb(1.0f)));
    rooms.push_back({"nothing diffuse", seen(mirrors)});
    SceneMaker dark;
    dark.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, dark.diffuse(Rgb(0.5f)));
    dark.sphere({0, 0.5, 0}, 0.3, dark.material(glass()));
    rooms.push_back({"nothing shines", seen(dark)});
    for (const Room& room : rooms) {
        const auto scene = room.maker.build();
        const std::vector<Rect> regions = squares(32, 32, 8);
        const auto rendered = [&](PlanKind plan) {
            return replicate(8, [&](std::uint64_t seed) {
                RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 2, 3);
                settings.photons = 20'000;
                settings.seed = seed;
                settings.plan = plan;
                EXPECT_TRUE(plan == PlanKind::kAuto || makePlan(*scene, settings).causticMap);
                return render(scene, settings, regions);
            });
        };
        const auto automatic = rendered(PlanKind::kAuto);
        const auto everything = rendered(PlanKind::kEverything);
        EXPECT_EQ(spread(automatic, 5, kBeauty, 1).mean == 0, room.name == "nothing shines");
        expectAgreement(everything, automatic, kCorrected, 0, 4, room.name);
        expectAgreement(wholeFrames(everything), wholeFrames(automatic), kCorrected, 0, 4,
                        room.name);
    }
}

// Where there are no caustics a map of them brings nothing and changes nothing: the same bits. (The
// pilot of lamp samples would take more of them, since all else takes longer.)
TEST(PartitionMoves, MapsWithoutPhotonsChangeNoBit) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.25, Rgb(15.0f));
    maker.box({-0.6, -1, -0.6}, {-0.1, 0.2, -0.1}, maker.diffuse(Rgb(0.7f)), false);
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 40);
    const auto scene = maker.build();
    const std::vector<Rect> pixels = squares(32, 32, 1);
    const auto rendered = [&](PlanKind kind) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 2, 2);
        settings.plan = kind;
        settings.gatherRays = 32;  // no pilot, so no guide of the rays
        Plan plan = makePlan(*scene, settings);
        EXPECT_EQ(plan.causticMap, kind == PlanKind::kEverything);
        plan.lampSamples = 2;
        return PlannedRender(scene, settings, plan).render(pixels, 2);
    };
    const RegionMeans automatic = rendered(PlanKind::kAuto);
    EXPECT_EQ(rendered(PlanKind::kEverything), automatic);
    double indirect = 0;
    for (const LayerMeans& pixel : automatic) indirect += pixel[kIndirect][0];
    EXPECT_GT(indirect, 0);
}

}  // namespace
}  // namespace pm::test
