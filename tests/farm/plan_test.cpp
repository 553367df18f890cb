// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How a farm cuts runs, pins the instruction set, and reads what its machines have noted.
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>

#include "host_shim/farm/instruction_set.h"
#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/farm/job/run_cut.h"
#include "host_shim/farm/job/task_events.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {
namespace {

// Half-open runs that follow each other, none empty, from 0 to count.
void expectCovers(const std::vector<BucketRun>& runs, std::uint32_t count) {
    std::uint32_t next = 0;
    for (const BucketRun& run : runs) {
        EXPECT_EQ(run.first, next);
        EXPECT_LT(run.first, run.last);
        next = run.last;
    }
    EXPECT_EQ(next, count);
}

TEST(RunCut, RunsOfAlikeBucketsAreAlike) {
    const std::vector<BucketRun> runs = cutRuns(std::vector<double>(12, 0.5), 12, 4);
    expectCovers(runs, 12);
    ASSERT_EQ(runs.size(), 4u);
    for (const BucketRun& run : runs) {
        EXPECT_EQ(run.last - run.first, 3u);
        EXPECT_DOUBLE_EQ(run.cost, 1.5);
    }
}

TEST(RunCut, ADearBucketIsARunOfItsOwn) {
    const std::vector<BucketRun> runs = cutRuns({1, 1, 1, 9, 1, 1, 1}, 7, 3);
    expectCovers(runs, 7);
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_EQ(runs[1].first, 3u);
    EXPECT_EQ(runs[1].last, 4u);
}

TEST(RunCut, RunsAreAsManyAsPay) {
    EXPECT_EQ(runCount({0, 1}, 1, 0), 1u);
    EXPECT_EQ(runCount({10, 1}, 1, 8), 8u) << "one for each machine";
    EXPECT_EQ(runCount({100, 0.1}, 1, 1), 3u) << "half a minute each";
    EXPECT_EQ(runCount({36000, 0.1}, 1, 10), 60u) << "six for each machine";
    EXPECT_EQ(runCount({1e9, 0.1}, 1, 100), 300u);
    EXPECT_EQ(runCount({1e9, 0.1}, 1, 1000), 1000u);
    EXPECT_EQ(runCount({3600, 0.1}, 10, 20), 120u) << "of half a minute";
    // sqrt(3600 * 4 / 80) = 13.4: of maps that cost 40 s each run pays for, twelve.
    EXPECT_EQ(runCount({3600, 40}, 1, 4), 12u);
    EXPECT_EQ(runCount({3600, 40}, 1, 64), 64u);
}

// The cost of the dearest run is what the farm waits for: no more than a bucket above the mean.
TEST(RunCut, NoRunIsFarAboveTheMean) {
    std::vector<double> costs(256);
    for (std::size_t i = 0; i < costs.size(); ++i)
        costs[i] = 1 + static_cast<double>(i * i % 97) / 10;
    const double all = std::accumulate(costs.begin(), costs.end(), 0.0);
    const double most = *std::ranges::max_element(costs);
    for (const std::uint32_t count : {2u, 7u, 24u, 100u}) {
        const std::vector<BucketRun> runs = cutRuns(costs, 256, count);
        expectCovers(runs, 256);
        ASSERT_EQ(runs.size(), count);
        for (const BucketRun& run : runs) EXPECT_LE(run.cost, all / count + most + 1e-9);
    }
}

TEST(RunCut, APilotWithFewerBucketsTellsStretchesOfTheOrder) {
    const std::vector<BucketRun> runs = cutRuns({1, 1, 1, 5}, 64, 2);
    expectCovers(runs, 64);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_NEAR(runs[0].last, 51, 1);  // 3 of 8 and a fifth of the last quarter: 48 + 16 / 5
    EXPECT_NEAR(runs[0].cost, runs[1].cost, 0.4);
}

TEST(RunCut, OddNumbers) {
    expectCovers(cutRuns({}, 5, 2), 5);
    expectCovers(cutRuns({0, 0}, 5, 2), 5);
    expectCovers(cutRuns({1, 2, 3}, 3, 99), 3);
    EXPECT_EQ(cutRuns({1, 2, 3}, 3, 99).size(), 3u);
    expectCovers(cutRuns({1e-9, 1e9}, 2, 2), 2);
    expectCovers(cutRuns({100, 0, 0, 0}, 4, 4), 4);
    EXPECT_TRUE(cutRuns({1}, 0, 3).empty());
}

TEST(InstructionSets, TheLeastOfAllMachinesIsTaken) {
    const std::string old = "fpu sse sse2 ssse3 sse4_1 sse4_2 popcnt avx";
    const std::string middle = old + " avx2 f16c rdrand fma bmi1 bmi2";
    const std::string best = middle + " avx512f avx512dq avx512cd avx512bw avx512vl";
    EXPECT_EQ(instructionSetOf(best), "avx512");
    EXPECT_EQ(instructionSetOf(middle), "avx2");
    EXPECT_EQ(instructionSetOf(middle + " avx512f"), "avx2");
    EXPECT_EQ(instructionSetOf(old), "avx");
    EXPECT_EQ(instructionSetOf("fpu sse sse2 avx2"), "sse2");
    EXPECT_EQ(commonInstructionSet("avx512", {{"a", best}, {"b", middle}, {"c", ""}}), "avx2");
    EXPECT_EQ(commonInstructionSet("avx", {{"a", best}}), "avx");
    EXPECT_EQ(commonInstructionSet("avx512", {}), "avx512");
}

FarmPlan somePlan() {
    FarmPlan plan;
    plan.given = {{"SCENE", {"a b.obj"}}, {"--size", {"64x48"}}, {"--strict", {}}};
    plan.program = "/bin/pm_host";
    plan.folder = "/work";
    plan.isa = "avx2";
    plan.bucketCount = 12;
    plan.frames = {{3, {"-o", "a.exr"}}, {std::nullopt, {}}};
    FarmTask photons;
    photons.kind = FarmTask::Kind::kPhotons;
    photons.frame = 1;
    photons.product = "/job/photons/0001.pmphotons";
    FarmTask run;
    run.first = 4;
    run.last = 12;
    run.predictedCost = 2.5;
    run.product = "/job/parts/0002.pmpart";
    run.words = {"a b.obj", "--buckets", "4:12"};
    plan.tasks = {photons, run};
    return plan;
}

TEST(FarmPlans, ComeBackFromTheirText) {
    const FarmPlan plan = somePlan();
    const FarmPlan read = FarmPlan::fromJson(plan.toJson(), "plan.json");
    EXPECT_EQ(read.toJson(), plan.toJson());
    EXPECT_EQ(read.photonsOf(1), 1);
    EXPECT_EQ(read.photonsOf(0), 0);
    EXPECT_EQ(read.what(2), "buckets 4:12 of frame 3");
    EXPECT_EQ(read.task(2).words.at(2), "4:12");
    EXPECT_EQ(read.given.at(1).values.at(0), "64x48");
}

TEST(FarmPlans, OtherTextsAreRefused) {
    const auto read = [](const std::string& text) {
        return refusal([&] { FarmPlan::fromJson(text, "plan.json"); });
    };
    EXPECT_TRUE(refusesWith(read(""), 3, {"plan.json", "no JSON"}));
    EXPECT_TRUE(refusesWith(read("{\"schema\": \"pm-farm/2\"}"), 3, {"pm-farm/1"}));
    EXPECT_TRUE(refusesWith(read("{\"schema\": \"pm-farm/1\"}"), 3, {"can't be understood"}));
    FarmPlan broken = somePlan();
    broken.tasks[1].frame = 7;
    EXPECT_TRUE(refusesWith(read(broken.toJson()), 3, {"can't be understood"}));
}

class TaskFiles : public ScratchTest {};

TEST_F(TaskFiles, AttemptsAreReadAlsoWhereTwoWroteAtOnce) {
    writeBytes(file("events"),
               "start 10.5 n1 7\nstart 11 n2 9\nend 12 n2 9 0\nst\nend 13 n3 1 0\n"
               "end 14 n1 7 137\nstart 15 n1 7\nstart x n1 8\n");
    const std::vector<TaskAttempt> attempts = readAttempts(file("events"));
    ASSERT_EQ(attempts.size(), 3u);
    EXPECT_EQ(attempts[0].machine, "n1");
    EXPECT_EQ(attempts[0].exitCode, 137);
    EXPECT_DOUBLE_EQ(attempts[0].end.value(), 14);
    EXPECT_EQ(attempts[1].exitCode, 0);
    EXPECT_FALSE(attempts[2].end);
    EXPECT_TRUE(readAttempts(file("none")).empty());
}

TEST_F(TaskFiles, ProgressIsThatOfTheLastLine) {
    writeBytes(file("log"),
               "[ 1 s] begins\n{\"progress\": 0.25, \"elapsed_seconds\": 1}\n"
               "{\"progress\": 0.5, \"elapsed_seconds\": 2}\n{\"progress\": 0.7");
    EXPECT_DOUBLE_EQ(readProgress(file("log")), 0.5);
    EXPECT_EQ(lastMessage(file("log")), "[ 1 s] begins");
    EXPECT_EQ(readProgress(file("none")), 0);
    EXPECT_EQ(lastMessage(file("none")), "");
    writeBytes(file("long"), std::string(100'000, 'x') + "\n{\"progress\": 1.0000}\nthe end\n");
    EXPECT_EQ(readProgress(file("long")), 1);
    EXPECT_EQ(lastMessage(file("long")), "the end");
}

}  // namespace
}  // namespace pm::host::test
