// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photons in places of no area, few and many of them, sums of many numbers, and dim light.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "integrator/photons/map/photon_map.h"
#include "integrator/transport/frame/pixel_sums.h"
#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_look.h"
#include "tests/support/rooms.h"
#include "tests/support/statistics.h"

namespace pm::bench {

namespace {

// Photons at places of [-1, 1]^dimensions.
PhotonMap mapOf(double count, int dimensions, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<Photon> photons;
    for (int i = 0; i < static_cast<int>(count); ++i) {
        Vec3f at{0.3f, 0.1f, 0.2f};
        if (dimensions >= 1) at.x = 2 * random.next() - 1;
        if (dimensions >= 2) at.y = 2 * random.next() - 1;
        photons.push_back({at, Rgb(0.1f), PackedNormal({0, 0, 1})});
    }
    return PhotonMap(photons);
}

constexpr const char* kPlaces[] = {"in a point", "in a line", "in a plane"};

Sweep degenerate(int dimensions) {
    Sweep sweep{.kind = "photons", .name = "flux of a map", .variant = kPlaces[dimensions]};
    sweep.parameter = "photons";
    sweep.values = {1, 2, 3, 10, 100, 1e3, 1e4, 1e5};
    sweep.against = "the photons' flux";
    sweep.measure = [=](double count, std::uint64_t seed) {
        const PhotonMap map = mapOf(count, dimensions, seed);
        const TwoRadii found = map.fluxWithin({0, 0, 0.2f}, {0, 0, 1}, 2);
        return static_cast<double>(found.wide.g);
    };
    sweep.expected = [](double count, std::uint64_t) { return count * static_cast<double>(0.1f); };
    return sweep;
}

Sweep nearest(int dimensions) {
    Sweep sweep{.kind = "photons", .name = "nearest 50 of a map"};
    sweep.variant = kPlaces[dimensions];
    sweep.parameter = "photons";
    sweep.values = {0, 1, 2, 49, 50, 51, 1e3, 1e5};
    sweep.against = "found more or fewer than there are";
    sweep.reported = "cgal#3077, ponca#148";
    sweep.isCount = true;
    sweep.measure = [=](double count, std::uint64_t seed) {
        const PhotonMap map = mapOf(count, dimensions, seed);
        NearestPhotons nearest;
        map.findNearest({{0, 0, 0.2f}, {0, 0, 1}, 50, 10}, nearest);
        return std::abs(static_cast<double>(nearest.found().size()) - std::min(count, 50.0));
    };
    return sweep;
}

// Light in a ball with a lamp in its middle, by the second bounce on.
double lightOfABall(std::uint64_t photons, std::uint32_t estimatePhotons, std::uint64_t seed) {
    test::SceneMaker maker;
    maker.sphere({}, 1, maker.diffuse(Rgb(0.5f)));
    maker.pointLight({}, Rgb(static_cast<float>(2 * std::numbers::pi)));
    maker.camera({0.1, 0, 0}, {1, 0, 0.5}, {0, 1, 0}, 90);
    return look(maker,
                {.seed = seed, .passes = 4, .photons = photons, .estimatePhotons = estimatePhotons})
        .indirect;
}

Sweep numberOfPhotons() {
    Sweep sweep{.kind = "photons", .name = "number of photons"};
    sweep.parameter = "photons of a pass";
    sweep.isLong = true;
    sweep.values = {1, 2, 10, 100, 1e3, 1e4, 1e5};
    sweep.against = "an integrating sphere's closed form";
    sweep.measure = [](double photons, std::uint64_t seed) {
        return lightOfABall(static_cast<std::uint64_t>(photons), 50, seed);
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

Sweep numberOfNearest() {
    Sweep sweep{.kind = "photons", .name = "k, of 1000 photons"};
    sweep.parameter = "k";
    sweep.values = {2, 10, 50, 1e3, 1e4, 1e5};
    sweep.against = "an integrating sphere's closed form";
    sweep.measure = [](double k, std::uint64_t seed) {
        return lightOfABall(1000, static_cast<std::uint32_t>(k), seed);
    };
    sweep.expected = [](double, std::uint64_t) { return 1.0; };
    return sweep;
}

Sweep accumulator() {
    Sweep sweep{.kind = "photons", .name = "sum of photons"};
    sweep.parameter = "photons added to one sum";
    sweep.values = decades(2, 8);
    sweep.against = "their number times their flux";
    sweep.measure = [](double count, std::uint64_t) {
        LeafFluxes leaf{};
        for (std::uint32_t i = 0; i < PhotonLeaf::kSize; ++i) leaf.set(i, Rgb(0.1f));
        FluxSums sums;
        for (std::int64_t left = std::llround(count); left > 0; left -= 4)
            leaf.add(0x1111u, 0, sums);
        return sums.wide[1];
    };
    sweep.expected = [](double count, std::uint64_t) { return count * static_cast<double>(0.1f); };
    return sweep;
}

Sweep brightSample() {
    Sweep sweep{.kind = "photons", .name = "a bright sample of a pixel"};
    sweep.parameter = "samples of 1 beside one of 1e8";
    sweep.values = decades(1, 6);
    sweep.against = "their mean";
    sweep.measure = [](double count, std::uint64_t) {
        PixelSums sums;
        SampleRadiance sample;
        const auto add = [&](float radiance) {
            sample.indirect = Rgb(radiance);
            if (!PixelSums::faultOf(sample)) sums.add(sample, 0, false);
        };
        const auto samples = static_cast<std::uint32_t>(count);
        for (std::uint32_t i = 0; i < samples; ++i) add(i == samples / 2 ? 1e8f : 1.0f);
        const ChannelLayout layout = channelLayout({});
        std::vector<float> pixel(static_cast<std::size_t>(layout.count));
        sums.write(layout, samples, pixel.data());
        return static_cast<double>(pixel[static_cast<std::size_t>(layout.beauty) + 1]);
    };
    sweep.expected = [](double count, std::uint64_t) { return (count - 1 + 1e8) / count; };
    return sweep;
}

// A room divided by a wall, with a dim lamp on the right: what the right half of the frame shows.
Sweep dimLight(IntegratorKind integrator) {
    Sweep sweep{.kind = "photons", .name = "dim half of a frame", .variant = nameOf(integrator)};
    sweep.parameter = "its light over that of the other half";
    sweep.values = decades(0, -8);
    sweep.against = "the same beside as bright a half";
    sweep.measure = [=](double share, std::uint64_t seed) {
        test::SceneMaker maker = test::openRoom();
        maker.box({-0.01, -1, -1}, {0.01, 1, 1}, maker.diffuse(Rgb(0.7f)), false);
        maker.quad({-0.7, 0.95, -0.3}, {0.4, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(10.0f)));
        maker.quad({0.3, 0.95, -0.3}, {0.4, 0, 0}, {0, 0, 0.6},
                   maker.diffuse({}, Rgb(static_cast<float>(10 * share))));
        const Seen seen = look(maker, {integrator, seed, 16, 4});
        double sum = 0;
        for (std::size_t i = 0; i < seen.pixels.size(); ++i)
            if (i % 16 > 8) sum += seen.pixels[i];
        return sum / (16 * 7 * share);
    };
    sweep.wellAt = 1;
    return sweep;
}

// A lamp in a closed black box, and no other: photons that all end at once.
Sweep hiddenLamp(IntegratorKind integrator) {
    Sweep sweep{.kind = "photons", .name = "no photon arrives", .variant = nameOf(integrator)};
    sweep.parameter = "radiance of a lamp in a box";
    sweep.values = {1e-6, 1e-3, 1, 1e3, 1e6, 1e9};
    sweep.against = "black: pixels that are not";
    sweep.isCount = true;
    sweep.measure = [=](double radiance, std::uint64_t seed) {
        test::SceneMaker maker = test::openRoom();
        maker.box({-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}, maker.diffuse({}), true);
        maker.sphere({}, 0.1, maker.diffuse({}, Rgb(static_cast<float>(radiance))));
        return look(maker, {integrator, seed}).countOff(0);
    };
    return sweep;
}

// Photons' flux that is neither absorbed nor gone, of a room with glass.
Sweep lostFlux() {
    Sweep sweep{.kind = "photons", .name = "flux lost"};
    sweep.parameter = "moved by, room widths / 2";
    sweep.values = decades(0, 8);
    sweep.against = "photons that ended for a numerical reason";
    sweep.isCount = true;
    sweep.measure = [](double by, std::uint64_t seed) {
        test::SceneMaker maker = test::openRoom();
        test::ceilingLamp(maker, 0.4, Rgb(5.0f));
        maker.sphere({0.3, -0.6, 0}, 0.3, maker.material(test::glass()));
        maker.box({-0.7, -1, -0.5}, {-0.2, 0, 0}, maker.material(test::glass()), false);
        const auto counters =
            look(placed(maker, 1, Vec3d{1, 0.7, -0.4} * by), {.seed = seed}).counters;
        return static_cast<double>(counters.photonsLost + counters.badSamples.total());
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> photonSweeps() {
    std::vector<Sweep> sweeps;
    for (const int dimensions : {0, 1, 2}) sweeps.push_back(degenerate(dimensions));
    for (const int dimensions : {0, 1, 2}) sweeps.push_back(nearest(dimensions));
    sweeps.push_back(numberOfPhotons());
    sweeps.push_back(numberOfNearest());
    sweeps.push_back(accumulator());
    sweeps.push_back(brightSample());
    for (const auto& make : {dimLight, hiddenLamp})
        for (const IntegratorKind integrator : kBoth) sweeps.push_back(make(integrator));
    sweeps.push_back(lostFlux());
    return sweeps;
}

}  // namespace pm::bench
