// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The photon map against a search through all photons.
#include "integrator/photons/map/photon_map.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "integrator/sampling/warps.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

Photon photonAt(Vec3f position, Vec3f normal = {0, 0, 1}, Rgb flux = Rgb(1.0f)) {
    return {position, flux, PackedNormal(normal)};
}

// On the plane z = 0, each of a flux of its own, so that it can be told apart.
std::vector<Photon> onPlane(std::uint32_t count, std::uint64_t seed, float grid) {
    Random random(seed);
    std::vector<Photon> photons;
    for (std::uint32_t i = 0; i < count; ++i) {
        Vec2f p = random.next2D();
        // On a grid there are ties and duplicates.
        if (grid > 0.0f) p = {std::floor(p.x * grid) / grid, std::floor(p.y * grid) / grid};
        photons.push_back(photonAt({p.x, p.y, 0}, {0, 0, 1}, Rgb(static_cast<float>(i + 1))));
    }
    return photons;
}

// Nearest in the order of distance, then of index in the map.
std::vector<NearestPhotons::Found> bruteForce(const PhotonMap& map, const PhotonQuery& query) {
    std::vector<NearestPhotons::Found> all;
    for (std::uint32_t i = 0; i < map.size(); ++i) {
        const float d2 = lengthSquared(map.photon(i).position - query.position);
        if (d2 <= query.maxRadius * query.maxRadius && i != query.leaveOut &&
            map.photon(i).normal.dotWith(query.normal) > 0.9f)
            all.push_back({d2, i});
    }
    std::sort(all.begin(), all.end());
    all.resize(std::min<std::size_t>(all.size(), query.count));
    return all;
}

void expectNearest(const PhotonMap& map, const PhotonQuery& query, NearestPhotons& scratch) {
    map.findNearest(query, scratch);
    std::vector<NearestPhotons::Found> found = scratch.found();
    if (!found.empty() && found.size() == query.count) {
        EXPECT_FALSE(found.front() < *std::max_element(found.begin(), found.end()));
    }
    std::sort(found.begin(), found.end());
    const std::vector<NearestPhotons::Found> expected = bruteForce(map, query);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].index, expected[i].index);
        EXPECT_EQ(found[i].distanceSquared, expected[i].distanceSquared);
    }
}

// The mark and the class of a photon don't disturb each other, nor the normal.
TEST(PhotonMap, PhotonsKnowTheirClass) {
    for (unsigned group = 0; group < PhotonClass::kGroups; ++group)
        for (unsigned slice = 0; slice < PhotonClass::kSlices; ++slice) {
            PackedNormal normal(Vec3f{0, 0, -1});
            const PhotonClass of{static_cast<std::uint8_t>(group),
                                 static_cast<std::uint8_t>(slice)};
            normal.mark();
            normal.setClass(of);
            EXPECT_EQ(normal.photonClass(), of);
            EXPECT_TRUE(normal.isMarked());
            normal.unmark();
            EXPECT_EQ(normal.photonClass(), of);
            EXPECT_FALSE(normal.isMarked());
            EXPECT_EQ(normal.unpack(), (Vec3f{0, 0, -1}));
        }
}

TEST(PhotonMap, FindsTheNearest) {
    NearestPhotons scratch;
    for (const std::uint32_t count : {1u, 2u, 15u, 16u, 17u, 33u, 1000u, 20'000u})
        for (const float grid : {0.0f, 8.0f}) {
            const PhotonMap map(onPlane(count, count, grid));
            Random random(1);
            for (int n = 0; n < 40; ++n) {
                const Vec2f at = random.next2D();
                PhotonQuery query{{at.x, at.y, 0}, {0, 0, 1}};
                if (n % 2) query.position = {std::floor(at.x * 8) / 8, std::floor(at.y * 8) / 8, 0};
                query.count = n % 4 == 0 ? 2 * count : 1 + static_cast<std::uint32_t>(n);
                query.maxRadius = n % 3 == 0 ? 10.0f : 0.2f;
                if (n % 5 == 0) query.leaveOut = 0;
                expectNearest(map, query, scratch);
            }
        }
}

// In space, of all directions: four at a time and one at a time must agree on who counts.
std::vector<Photon> inSpace(std::uint32_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Photon> photons;
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec2f p = random.next2D();
        const Vec3f n = i % 2 ? Vec3f{0, 0, 1} : sampleUniformSphere(random.next2D());
        photons.push_back(
            photonAt({p.x, p.y, 0.05f * random.next()}, n, Rgb(static_cast<float>(i + 1))));
    }
    return photons;
}

TEST(PhotonMap, CountsWhatTheGateAccepts) {
    const PhotonMap map(inSpace(3000, 8));
    Random random(9);
    std::size_t counted = 0;
    for (int n = 0; n < 200; ++n) {
        const Vec2f at = random.next2D();
        const Vec3f position{at.x, at.y, 0.02f};
        const Vec3f normal = n % 2 ? Vec3f{0, 0, 1} : sampleUniformSphere(random.next2D());
        const PhotonGate gate = map.gate(position, normal);
        const float radius = 0.3f * random.next();
        double expected = 0;
        std::vector<NearestPhotons::Found> all;
        for (std::uint32_t i = 0; i < map.size(); ++i) {
            const Photon photon = map.photon(i);
            const float d2 = lengthSquared(photon.position - position);
            if (d2 > radius * radius || !gate.accepts(photon)) continue;
            expected += static_cast<double>(photon.flux.r);
            all.push_back({d2, i});
        }
        counted += all.size();
        EXPECT_EQ(map.fluxWithin(position, normal, radius).wide.r, static_cast<float>(expected));
        NearestPhotons scratch;
        map.findNearest({position, normal, 5, radius}, scratch);
        std::sort(all.begin(), all.end());
        all.resize(std::min<std::size_t>(all.size(), 5));
        auto found = scratch.found();
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found.size(), all.size());
        for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(found[i].index, all[i].index);
    }
    EXPECT_GT(counted, 1000u);
}

// A walk from the thick into the thin and back, two maps taking turns: earlier queries change how
// fast the nearest are found, never which.
TEST(PhotonMap, WarmStartsChangeNothing) {
    std::vector<Photon> photons = onPlane(20'000, 10, 0);
    for (std::size_t i = 0; i < photons.size(); i += 2) {
        photons[i].position.x = 3 + 0.01f * photons[i].position.x;
        photons[i].position.y *= 0.01f;
    }
    const PhotonMap map(photons), other(onPlane(500, 11, 16));
    NearestPhotons walking;
    for (int n = 0; n < 400; ++n) {
        const float x = 4.0f * std::abs(static_cast<float>(n - 200)) / 200;
        PhotonQuery query{{x, 0.005f, 0}, {0, 0, 1}};
        query.count = n % 7 == 0 ? 10 : 50;
        query.maxRadius = n % 5 == 0 ? 0.1f : 10.0f;
        expectNearest(n % 11 == 0 ? other : map, query, walking);
    }
}

// The same for leaves that are kept from query to query, where another map may come to lie in the
// place of one that is gone.
TEST(PhotonMap, KeptLeavesChangeNothing) {
    NearestPhotons walking;
    auto map = std::make_unique<PhotonMap>(inSpace(20'000, 10));
    const PhotonMap other(inSpace(500, 11));
    std::size_t found = 0;
    for (int n = 0; n < 1200; ++n) {
        if (n % 400 == 399) *map = PhotonMap(inSpace(20'000 - 10 * static_cast<unsigned>(n), 12));
        const float x = std::abs(static_cast<float>(n % 400 - 200)) / 200;
        const Vec3f position{x, 0.3f + 0.1f * x * x, 0.01f}, up{0, 0, 1};
        const PhotonMap& asked = n % 11 == 0 ? other : *map;
        // The last finds too many leaves to keep.
        const float radius = n % 50 == 0 ? 0.7f : n % 2 ? 0.02f : 0.03f;
        const TwoRadii kept = asked.fluxWithin(position, up, radius, walking);
        const TwoRadii fresh = asked.fluxWithin(position, up, radius);
        EXPECT_EQ(kept.wide, fresh.wide);
        EXPECT_EQ(kept.narrow, fresh.narrow);
        PhotonQuery query{position, up, n % 7 == 0 ? 40u : 12u, n % 5 == 0 ? 0.02f : 10.0f};
        if (n % 3 == 0) query.leaveOut = 100;
        NearestPhotons scratch;
        asked.findNearest(query, scratch);
        const bool enough = scratch.found().size() == query.count;
        const float expected = enough ? std::sqrt(scratch.found().front().distanceSquared)
                                      : std::numeric_limits<float>::infinity();
        EXPECT_EQ(asked.radiusOf(query, walking), expected);
        found += enough;
    }
    EXPECT_GT(found, 800u);
}

TEST(PhotonMap, EmptyAndZero) {
    NearestPhotons scratch;
    const PhotonMap map(std::vector<Photon>{});
    EXPECT_TRUE(map.empty());
    map.findNearest({{0, 0, 0}, {0, 0, 1}, 5, 10.0f}, scratch);
    EXPECT_TRUE(scratch.found().empty());
    EXPECT_EQ(map.fluxWithin({0, 0, 0}, {0, 0, 1}, 10.0f).wide, Rgb());
    EXPECT_EQ(map.fluxWithin({0, 0, 0}, {0, 0, 1}, 10.0f, scratch).wide, Rgb());
    EXPECT_TRUE(std::isinf(map.radiusOf({{0, 0, 0}, {0, 0, 1}, 5, 10.0f}, scratch)));
    EXPECT_GT(map.typicalRadius(50), 0.0f);
    const PhotonMap one(onPlane(1, 1, 0));
    one.findNearest({{0, 0, 0}, {0, 0, 1}, 0, 10.0f}, scratch);
    EXPECT_TRUE(scratch.found().empty());
}

TEST(PhotonMap, FluxWithinARadius) {
    for (const float grid : {0.0f, 8.0f}) {
        const PhotonMap map(onPlane(5000, 3, grid));
        Random random(2);
        for (int n = 0; n < 200; ++n) {
            const Vec2f at = random.next2D();
            const Vec3f position{at.x, at.y, 0};
            const float radius = n % 2 ? 0.125f : 0.3f * random.next();
            double wide = 0, narrow = 0;
            for (std::uint32_t i = 0; i < map.size(); ++i) {
                const float d2 = lengthSquared(map.photon(i).position - position);
                const auto flux = static_cast<double>(map.photon(i).flux.g);
                if (d2 <= radius * radius) wide += flux;
                if (d2 <= 0.5f * (radius * radius)) narrow += flux;
            }
            const TwoRadii flux = map.fluxWithin(position, {0, 0, 1}, radius);
            EXPECT_EQ(flux.wide.g, static_cast<float>(wide));
            EXPECT_EQ(flux.narrow.g, static_cast<float>(narrow));
        }
    }
}

// Fluxes that don't add up exactly: near the sum in double, and the same bits whether four at a
// time are added or, where each photon is asked for, one at a time.
TEST(PhotonMap, FluxIsSummedInOneOrder) {
    std::vector<Photon> photons = inSpace(5000, 13);
    for (Photon& photon : photons) photon.flux = photon.flux * 0.1f;
    const PhotonMap map(photons);
    Random random(14);
    std::size_t lit = 0;
    for (int n = 0; n < 300; ++n) {
        const Vec2f at = random.next2D();
        const Vec3f position{at.x, at.y, 0.02f}, normal{0, 0, 1};
        const float radius = 0.2f * random.next();
        const TwoRadii fast = map.fluxWithin(position, normal, radius);
        std::array<double, 2> sums{};
        const TwoRadii slow = map.fluxWithin(position, normal, radius, [&](std::uint32_t index) {
            const Photon photon = map.photon(index);
            const float d2 = lengthSquared(photon.position - position);
            sums[0] += static_cast<double>(photon.flux.b);
            if (d2 <= 0.5f * (radius * radius)) sums[1] += static_cast<double>(photon.flux.b);
            return true;
        });
        EXPECT_EQ(fast.wide, slow.wide);
        EXPECT_EQ(fast.narrow, slow.narrow);
        // 16 of a leaf in float, each sum rounded, all positive.
        EXPECT_NEAR(fast.wide.b, sums[0], 16 * 0x1p-24 * sums[0]);
        EXPECT_NEAR(fast.narrow.b, sums[1], 16 * 0x1p-24 * sums[1]);
        lit += fast.narrow.b > 0;
    }
    EXPECT_GT(lit, 200u);
}

// Ties everywhere: the lowest indices are found, and the search ends once it has them.
TEST(PhotonMap, CoincidentPhotonsGoByIndex) {
    const PhotonMap map(std::vector<Photon>(300'000, photonAt({0.3f, 0.2f, 0.1f})));
    NearestPhotons scratch;
    for (const std::uint32_t leaveOut : {~0u, 7u, 299'999u})
        for (int n = 0; n < 1000; ++n) {
            map.findNearest({{0.3f, 0.2f, 0.1f}, {0, 0, 1}, 50, 1.0f, leaveOut}, scratch);
            auto found = scratch.found();
            std::sort(found.begin(), found.end());
            ASSERT_EQ(found.size(), 50u);
            ASSERT_EQ(found.back().index, leaveOut == 7 ? 50u : 49u);
        }
    EXPECT_GT(map.typicalRadius(50), 0.0f);
}

// The photons of a laser, all at one point: built and asked without trouble.
TEST(PhotonMap, ManyPhotonsAtOnePoint) {
    std::vector<Photon> photons(100'000, photonAt({0.3f, 0.2f, 0.1f}));
    for (int i = 0; i < 10; ++i) photons.push_back(photonAt({static_cast<float>(i), 0.2f, 0.1f}));
    const PhotonMap map(std::move(photons));
    NearestPhotons scratch;
    for (int n = 0; n < 20; ++n) {
        map.findNearest({{0.3f, 0.2f, 0.1f}, {0, 0, 1}, 50, 1.0f}, scratch);
        ASSERT_EQ(scratch.found().size(), 50u);
        EXPECT_EQ(scratch.found().front().distanceSquared, 0.0f);
    }
    EXPECT_EQ(map.fluxWithin({0.3f, 0.2f, 0.1f}, {0, 0, 1}, 0.1f).wide.r, 100'000.0f);
    EXPECT_GT(map.typicalRadius(50), 0.0f);
}

// The order of a tree's photons by its definition: the widest side of their box is divided where
// its first half of leaves is full, equals by their numbers; within a leaf they keep their order.
void orderOf(const std::vector<Photon>& photons, std::vector<std::uint32_t> part,
             std::size_t leaves, std::vector<std::uint32_t>& order) {
    if (leaves == 1) {
        order.insert(order.end(), part.begin(), part.end());
        return;
    }
    int axis = 0;
    float widest = -1;
    for (int a = 0; a < 3; ++a) {
        const auto [lo, hi] = std::minmax_element(part.begin(), part.end(), [&](auto i, auto j) {
            return photons[i].position[a] < photons[j].position[a];
        });
        const float width = photons[*hi].position[a] - photons[*lo].position[a];
        if (width > widest) {
            widest = width;
            axis = a;
        }
    }
    const auto before = [&](std::uint32_t i, std::uint32_t j) {
        return std::pair(photons[i].position[axis], i) < std::pair(photons[j].position[axis], j);
    };
    const std::size_t leftLeaves = (leaves + 1) / 2;
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(16 * leftLeaves);
    std::nth_element(part.begin(), middle, part.end(), before);
    std::vector<std::uint32_t> left(part.begin(), middle), right(middle, part.end());
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    orderOf(photons, std::move(left), leftLeaves, order);
    orderOf(photons, std::move(right), leaves - leftLeaves, order);
}

TEST(PhotonMap, TheTreeIsAsDefined) {
    std::vector<std::vector<Photon>> sets = {inSpace(70'000, 15), onPlane(70'000, 16, 64),
                                             inSpace(15, 17), onPlane(40, 18, 2)};
    // Nearly all at one place: a bucket holds more than a chunk.
    sets.push_back(std::vector<Photon>(30'000, photonAt({0.3f, 0.2f, 0.1f})));
    for (std::size_t i = 0; i < sets.back().size(); i += 1000)
        sets.back()[i].position = {-0.0f, static_cast<float>(i), 0.0f};
    // Wider than what a float can hold.
    sets.push_back(inSpace(5000, 19));
    for (Photon& photon : sets.back())
        photon.position = (photon.position * 2.0f - Vec3f(1.0f)) * 3e38f;
    for (const std::vector<Photon>& photons : sets) {
        std::vector<std::uint32_t> all(photons.size()), order;
        std::iota(all.begin(), all.end(), 0u);
        orderOf(photons, all, (photons.size() + 15) / 16, order);
        const PhotonMap map(photons);
        ASSERT_EQ(order.size(), map.size());
        for (std::uint32_t i = 0; i < map.size(); ++i) {
            const Photon photon = map.photon(i);
            ASSERT_EQ(std::memcmp(&photon, &photons[order[i]], sizeof(Photon)), 0) << i;
        }
    }
}

TEST(PhotonMap, TheSameTreeForAnyThreads) {
    const auto build = [](int threads) {
        std::unique_ptr<PhotonMap> map;
        tbb::task_arena(threads).execute(
            [&] { map = std::make_unique<PhotonMap>(onPlane(60'000, 4, 64)); });
        return map;
    };
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 5);
    const auto one = build(1);
    for (const int threads : {2, 5}) {
        const auto many = build(threads);
        ASSERT_EQ(many->size(), one->size());
        for (std::uint32_t i = 0; i < one->size(); ++i) {
            const Photon a = one->photon(i), b = many->photon(i);
            ASSERT_EQ(std::memcmp(&a, &b, sizeof(Photon)), 0);
        }
        Random random(5);
        for (int n = 0; n < 200; ++n) {
            const Vec2f at = random.next2D();
            EXPECT_EQ(one->fluxWithin({at.x, at.y, 0}, {0, 0, 1}, 0.05f).wide,
                      many->fluxWithin({at.x, at.y, 0}, {0, 0, 1}, 0.05f).wide);
        }
    }
}

TEST(PhotonMap, OtherSidesAndNormalsDoNotCount) {
    std::vector<Photon> photons;
    photons.push_back(photonAt({0.01f, 0, 0}, {0, 0, -1}));         // the other side
    photons.push_back(photonAt({0, 0, 0.01f}, {1, 0, 0}));          // a wall
    photons.push_back(photonAt({0, 0.01f, 0.05f}, {0, 0, 1}));      // a shelf above
    photons.push_back(photonAt({0.02f, 0, 0}, {0, 0, 1}));          // counts
    photons.push_back(photonAt({0, 0.02f, 0}, {0.1f, 0, 0.995f}));  // counts: almost flat
    const PhotonMap map(std::move(photons));
    EXPECT_EQ(map.fluxWithin({0, 0, 0}, {0, 0, 1}, 1).wide.r, 2.0f);
    EXPECT_EQ(map.fluxWithin({0, 0, 0}, {0, 0, -1}, 1).wide.r, 1.0f);
    EXPECT_EQ(map.fluxWithin({0, 0, 0}, {1, 0, 0}, 1).wide.r, 1.0f);
    NearestPhotons scratch;
    map.findNearest({{0, 0, 0}, {0, 0, 1}, 2, 1.0f}, scratch);
    EXPECT_EQ(scratch.found().size(), 2u);
    // Refused photons do not shrink the radius either (P1).
    EXPECT_NEAR(scratch.found().front().distanceSquared, 0.0004f, 1e-6f);
}

TEST(PackedNormal, WithinHalfADegree) {
    Random random(6);
    float worst = 1;
    for (int i = 0; i < 100'000; ++i) {
        const Vec3f n = sampleUniformSphere(random.next2D());
        worst = std::min(worst, dot(PackedNormal(n).unpack(), n));
    }
    EXPECT_GT(worst, std::cos(0.5 * std::numbers::pi / 180));
}

}  // namespace
}  // namespace pm::test
