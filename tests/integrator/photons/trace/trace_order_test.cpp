// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The order in which photons are traced: by number, or sorted where surfaces are cut on demand.
#include "integrator/photons/trace/trace_order.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "tests/integrator/geometry/obj_cage.h"
#include "tests/support/limit_scene.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

const std::atomic<bool> kGoesOn{false};

// A floor of 64 by 64 units below a sun, and a ball above it.
std::shared_ptr<const Scene> floorUnderASun(bool isCut) {
    SceneMaker maker;
    const std::uint32_t grey = maker.diffuse(Rgb(0.5f));
    if (isCut)
        addLimit(maker, gridCage(16), 16, grey, {64, 0, 0, -32, 0, 64, 0, -32, 0, 0, 64, 0});
    else
        maker.quad({-32, -32, 0}, {64, 0, 0}, {0, 64, 0}, grey);
    maker.sphere({3, 2, 4}, 2.0, grey);
    maker.sun({-0.3, -0.2, -0.9}, Rgb(1.0f), 0.005);
    return maker.build();
}

PhotonTraceRequest globalPhotons(std::uint64_t count) {
    PhotonTraceRequest request;
    request.count = count;
    return request;
}

// Mean distance between the floor's points that photons after each other would meet.
double meanStep(const PhotonWalk& walk, std::uint64_t count,
                const std::function<std::uint64_t(std::uint64_t)>& index) {
    double sum = 0;
    Vec3d last;
    for (std::uint64_t i = 0; i < count; ++i) {
        const Ray ray = walk.firstRay(index(i)).value();
        const Vec3d at =
            Vec3d(ray.origin) - Vec3d(ray.direction) * (static_cast<double>(ray.origin.z) /
                                                        static_cast<double>(ray.direction.z));
        if (i > 0) sum += length(at - last);
        last = at;
    }
    return sum / static_cast<double>(count - 1);
}

struct Traced {
    Traced(bool isCut, std::uint64_t count)
        : scene(floorUnderASun(isCut)), lights(*scene), request(globalPhotons(count)) {}

    std::shared_ptr<const Scene> scene;
    LightSampler lights;
    PhotonTraceRequest request;
    PhotonWalk walk{*scene, lights, request};
    TraceOrder order{*scene, walk, request.count};
};

TEST(TraceOrder, IsByNumberWhereNothingIsCut) {
    Traced t(false, 5000);
    const std::uint64_t count = t.request.count;
    EXPECT_EQ(t.order.enter(0, CancelCheck(kGoesOn)), count);
    for (const std::uint64_t i : {0u, 77u, 4999u}) EXPECT_EQ(t.order.index(i), i);
}

TEST(TraceOrder, PhotonsAfterEachOtherGoNearEachOther) {
    Traced t(true, 5000);
    const std::uint64_t count = t.request.count;
    EXPECT_EQ(t.order.enter(0, CancelCheck(kGoesOn)), count);
    const double byNumber = meanStep(t.walk, count, [](std::uint64_t i) { return i; });
    const double sorted =
        meanStep(t.walk, count, [&](std::uint64_t i) { return t.order.index(i); });
    EXPECT_LT(sorted, 0.15 * byNumber);
}

TEST(TraceOrder, HasEachPhotonOnceInWindows) {
    Traced t(true, TraceOrder::kWindow + 1000);
    const std::uint64_t count = t.request.count;
    std::vector<bool> seen(count);
    for (std::uint64_t begin = 0; begin < count;) {
        const std::uint64_t end = t.order.enter(begin, CancelCheck(kGoesOn));
        EXPECT_EQ(end, begin == 0 ? TraceOrder::kWindow : count);
        for (std::uint64_t i = begin; i < end; ++i) {
            const std::uint64_t index = t.order.index(i);
            ASSERT_TRUE(index >= begin && index < end && !seen[index]) << i;
            seen[index] = true;
        }
        begin = end;
    }
}

// Of a cache that holds next to nothing, in small rounds and by two threads.
TEST(TraceOrder, GivesTheSameBitsForAnyRoundsThreadsAndCache) {
    const auto scene = floorUnderASun(true);
    const LightSampler lights(*scene);
    const PhotonTraceRequest request = globalPhotons(30'000);
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 4);
    const auto traced = [&](int threads, std::uint64_t bytes, std::uint64_t budget) {
        scene->setGroupBudget(budget);
        std::vector<Photon> photons;
        std::size_t rounds = 0;
        const auto take = [&](PhotonTraceResult part) {
            photons.insert(photons.end(), part.photons.begin(), part.photons.end());
            ++rounds;
        };
        tbb::task_arena(threads).execute([&] {
            traceInRounds(*scene, lights, request, kGoesOn, {}, {bytes, take});
        });
        EXPECT_EQ(rounds > 1, bytes != TraceRounds::kAll);
        return photons;
    };
    const auto wanted = traced(1, TraceRounds::kAll, std::uint64_t{1} << 30);
    const auto found = traced(2, 1 << 20, 1 << 16);
    ASSERT_EQ(wanted.size(), found.size());
    ASSERT_GT(wanted.size(), 10'000u);
    EXPECT_EQ(std::memcmp(wanted.data(), found.data(), wanted.size() * sizeof(Photon)), 0);
}

}  // namespace
}  // namespace pm::test
