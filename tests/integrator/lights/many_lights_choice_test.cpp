// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Many lights: the tree over them, the choice among them against the probabilities it states.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <span>
#include <thread>

#include "integrator/light_sampling/light_guide.h"
#include "integrator/light_sampling/light_tree.h"
#include "integrator/values/error.h"
#include "tests/integrator/lights/lamp_rooms.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kSignificance = 0.01 / 20;

// Parts of the tree that are built side by side make the same tree.
TEST(ManyLights, TheTreeKnowsNoThreads) {
    const Room room(100, 100);
    const auto treeBy = [&](int threads) {
        tbb::task_arena arena(threads);
        return arena.execute([&] { return LightTree(*room.scene); });
    };
    const LightTree alone = treeBy(1), together = treeBy(4);
    EXPECT_EQ(alone.memoryBytes(), together.memoryBytes());
    EXPECT_EQ(alone.cut(500), together.cut(500));
    for (const Surface& surface : room.receivers())
        for (std::uint32_t light = 0; light < room.scene->lights().size(); light += 37) {
            const Receiver receiver = facing(surface);
            EXPECT_EQ(alone.position(light), together.position(light));
            EXPECT_EQ(alone.probability(LightTree::kRoot, receiver, light),
                      together.probability(LightTree::kRoot, receiver, light));
        }
}

TEST(ManyLights, BuildingTheTreeCanBeCancelled) {
    const Room room(20, 20);
    const std::atomic<bool> cancelled{true};
    EXPECT_THROW(LightSampler(*room.scene, CancelCheck(cancelled)), Error);
    EXPECT_THROW(LightTree(*room.scene, CancelCheck(cancelled)), Error);
}

// Not at its first step alone: half-way, too, or the tree of millions of lights is built to its
// end.
TEST(ManyLights, BuildingTheTreeCanBeCancelledHalfway) {
    const Room room(200, 200);
    using Clock = std::chrono::steady_clock;
    Clock::duration whole = std::chrono::hours(1);
    for (int i = 0; i < 3; ++i) {
        const Clock::time_point start = Clock::now();
        const LightTree tree(*room.scene);
        whole = std::min(whole, Clock::now() - start);
    }
    // Where the machine has other work to do the flag may come too late.
    int stopped = 0;
    for (int i = 0; i < 20 && stopped == 0; ++i) {
        std::atomic<bool> cancelled{false};
        const std::jthread later([&] {
            std::this_thread::sleep_for(whole / 2);
            cancelled = true;
        });
        try {
            const LightTree tree(*room.scene, CancelCheck(cancelled));
        } catch (const Error&) {
            ++stopped;
        }
    }
    EXPECT_EQ(stopped, 1);
}

// By the tree alone, and with a table before it: probabilities add up to 1, and choices follow
// them (chi-squared).
TEST(ManyLights, ChoicesFollowTheirProbabilities) {
    // More than a leaf each, so that runs are tried too.
    for (const std::uint32_t side : {8u, 60u}) {
        const Room room(side, side);
        LightTree tree(*room.scene);
        const auto surfaces = room.receivers();
        std::vector<Receiver> receivers;
        for (const Surface& surface : surfaces) receivers.push_back(facing(surface));
        const LightGuide guide(tree, receivers,
                               [&](std::size_t i, std::uint32_t node, std::uint32_t n) {
                                   LightDescent descent{0.25 * n, node};
                                   tree.choose(receivers[i], {&descent, 1});
                                   return Sighting{descent.node, (node + i) % 3 == 0};
                               });
        const std::size_t count = room.scene->lights().size();
        const auto check = [&](const auto& choose, const auto& probability) {
            Random random(3);
            Histogram histogram(count);
            double sum = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto p = static_cast<double>(probability(i));
                EXPECT_GT(p, 0.0);
                sum += p;
                histogram.expect(i, p);
            }
            EXPECT_NEAR(sum, 1.0, 1e-4);
            double mean = 0, wrong = 0;
            const std::size_t samples = 200'000;
            std::size_t total = 0;
            // In batches of any size: side by side all are chosen as they would be alone.
            for (std::size_t done = 0, size = 1; done < samples; size = size % 16 + 1) {
                std::array<LightDescent, 16> batch;
                const std::span<LightDescent> descents(batch.data(), size);
                for (LightDescent& descent : descents) {
                    const auto fine = static_cast<double>(random.next());
                    descent.u = static_cast<double>(random.next()) + fine * 0x1p-24;
                }
                const std::array<LightDescent, 16> before = batch;
                choose(descents);
                for (std::size_t i = 0; i < size; ++i) {
                    LightDescent alone = before[i];
                    choose({&alone, 1});
                    const auto& [u, light, p] = descents[i];
                    EXPECT_TRUE(alone.node == light && alone.u == u && alone.probability == p);
                    wrong += std::abs(p / probability(light) - 1.0f) > 1e-4f;
                    histogram.count(light);
                    EXPECT_TRUE(u >= 0 && u < 1);
                    mean += u;
                }
                done += size;
                total = done;
            }
            mean /= static_cast<double>(total);
            EXPECT_EQ(wrong, 0);
            EXPECT_GT(histogram.pValue(0), kSignificance);
            // What is left of u is uniform.
            EXPECT_NEAR(mean, 0.5, 5 / std::sqrt(12.0 * static_cast<double>(total)));
        };
        for (const Receiver& receiver : receivers) {
            check([&](std::span<LightDescent> descents) { tree.choose(receiver, descents); },
                  [&](std::uint32_t i) { return tree.probability(LightTree::kRoot, receiver, i); });
            check([&](std::span<LightDescent> descents) { guide.choose(receiver, descents); },
                  [&](std::uint32_t i) { return guide.probability(receiver, i); });
        }
    }
}

// Lights chosen together are those that are chosen one by one, near and far ones in any order, in
// batches longer than any that are made side by side, too.
TEST(ManyLights, ChosenTogetherAsAlone) {
    for (const std::uint32_t side : {2u, 30u}) {
        SceneMaker maker = makeRoom(side, side);
        maker.sun({0.2, -1, 0.1}, Rgb(3.0f), 0.1);
        Room room(side, side);
        room.scene = maker.build();
        room.lights = std::make_unique<LightSampler>(*room.scene);
        room.learn();
        const Surface at = room.receivers().front();
        Random random(9);
        std::size_t far = 0, total = 0;
        for (std::size_t size = 1; size < 70; size = size * 3 / 2 + 1) {
            std::vector<ChosenLight> together(size);
            for (ChosenLight& one : together) one.u = random.next2D();
            const std::vector<ChosenLight> before = together;
            room.lights->choose(at, at.geometricNormal, together);
            for (std::size_t i = 0; i < size; ++i) {
                ChosenLight alone = before[i];
                room.lights->choose(at, at.geometricNormal, {&alone, 1});
                EXPECT_EQ(alone.light, together[i].light);
                EXPECT_EQ(alone.u, together[i].u);
                EXPECT_EQ(alone.probability, together[i].probability);
                far += alone.light >= room.scene->nearLights().size();
            }
            total += size;
        }
        EXPECT_GT(far, 0);
        EXPECT_LT(far, total);
    }
}

}  // namespace
}  // namespace pm::test
