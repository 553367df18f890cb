// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders that end by an error target or a time limit: with the bits of so many passes, and saying
// why.
#include <atomic>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

using Settings = std::map<std::string, std::string>;

nlohmann::json statistics(PmrRender render) {
    return nlohmann::json::parse(
        textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().renderStatistics(render, buffer, capacity, needed);
        }));
}

std::int32_t stopReason(PmrRender render) {
    std::int32_t reason = -1;
    EXPECT_EQ(PMR_OK, api().renderStopReason(render, &reason));
    return reason;
}

// What was seen in callbacks.
struct Seen {
    std::atomic<std::int32_t> reasonInFinished{-1};
    std::atomic<double> fraction{0};
    std::atomic<bool> fell{false};
};

void onFinished(void* user, PmrRender render, PmrStatus) {
    static_cast<Seen*>(user)->reasonInFinished = stopReason(render);
}

void onProgress(void* user, PmrRender, double fraction, double) {
    auto* seen = static_cast<Seen*>(user);
    if (!(fraction >= seen->fraction && fraction <= 1)) seen->fell = true;
    seen->fraction = fraction;
}

struct Ended {
    std::vector<float> pixels, standardError, samples;
    nlohmann::json json;
};

class Stops : public ::testing::Test {
  protected:
    // Unlike BoxHost::makeRender it leaves the number of passes alone.
    PmrRender makeRender(const Settings& settings) {
        PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
        desc.user = &m_seen;
        desc.finished = onFinished;
        desc.progress = onProgress;
        PmrRender render = nullptr;
        EXPECT_EQ(PMR_OK, api().createRender(m_host.scene(), &desc, &render));
        Settings all = {{"width", "40"}, {"height", "24"}, {"photons", "4000"}, {"aaLevel", "2"}};
        for (const auto& [name, value] : settings) all[name] = value;
        for (const auto& [name, value] : all)
            EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str()))
                << m_host.lastError();
        return render;
    }
    Ended run(Settings settings, std::int32_t reason) {
        settings["layers"] = "stderr,samples";
        m_seen.fraction = 0;
        const PmrRender render = makeRender(settings);
        EXPECT_EQ(PMR_STOP_NONE, stopReason(render));
        EXPECT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0)) << m_host.lastError();
        EXPECT_EQ(reason, stopReason(render));
        EXPECT_EQ(reason, m_seen.reasonInFinished);
        EXPECT_FALSE(m_seen.fell);
        EXPECT_EQ(1.0, m_seen.fraction);
        Ended ended{readLayer(render, "beauty", 4, {0, 0, 40, 24}),
                    readLayer(render, "stderr", 3, {0, 0, 40, 24}),
                    readLayer(render, "samples", 1, {0, 0, 40, 24}), statistics(render)};
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        return ended;
    }
    // The same settings without targets, and as many passes as were made.
    void expectSameBits(const Ended& ended, Settings settings) {
        settings.erase("errorTarget");
        settings.erase("timeLimitSeconds");
        settings["passes"] = ended.json["passesDone"].dump();
        const Ended again = run(settings, PMR_STOP_PASSES);
        ASSERT_EQ(ended.pixels.size(), again.pixels.size());
        for (const auto member : {&Ended::pixels, &Ended::standardError})
            EXPECT_EQ(0, std::memcmp((ended.*member).data(), (again.*member).data(),
                                     (ended.*member).size() * sizeof(float)));
        EXPECT_EQ(ended.json["relMseEstimate"], again.json["relMseEstimate"]);
        EXPECT_EQ(ended.json["hashes"], again.json["hashes"]);
    }

    BoxHost m_host;
    Seen m_seen;
};

class StopsOfIntegrators : public Stops, public ::testing::WithParamInterface<const char*> {};

TEST_P(StopsOfIntegrators, ErrorTargetMakesThePictureOfSoManyPasses) {
    Settings settings = {{"integrator", GetParam()}, {"passes", "2"}};
    const double first = run(settings, PMR_STOP_PASSES).json["relMseEstimate"].get<double>();
    ASSERT_GT(first, 0.0);
    // Noise that falls as 1/passes gets there after some 5.
    const double target = 0.4 * first;
    settings.erase("passes");
    settings["errorTarget"] = std::to_string(target);
    const Ended ended = run(settings, PMR_STOP_ERROR_TARGET);
    EXPECT_EQ("error target", ended.json["stopReason"]);
    const auto& curve = ended.json["errorCurve"];
    const auto done = ended.json["passesDone"].get<std::size_t>();
    EXPECT_GT(done, 2u);
    EXPECT_LT(done, 1000u);
    ASSERT_GE(curve.size(), 2u);
    EXPECT_LE(ended.json["relMseEstimate"].get<double>(), target);
    EXPECT_EQ(curve.back()["passes"], done);
    EXPECT_EQ(curve.back()["estimatedRelMse"], ended.json["relMseEstimate"]);
    // Not a pass more than it takes.
    if (done <= 16) {
        EXPECT_GT(curve[done - 2]["estimatedRelMse"].get<double>(), target);
    }
    expectSameBits(ended, settings);
}

INSTANTIATE_TEST_SUITE_P(Integrators, StopsOfIntegrators, ::testing::Values("photon", "path"),
                         [](const auto& info) { return std::string(info.param); });

TEST_F(Stops, ATinyTimeLimitStillMakesOneWholePass) {
    const Settings settings = {{"timeLimitSeconds", "1e-9"}};
    const Ended ended = run(settings, PMR_STOP_TIME_LIMIT);
    EXPECT_EQ("time limit", ended.json["stopReason"]);
    EXPECT_EQ(1, ended.json["passesDone"]);
    for (const float samples : ended.samples) ASSERT_EQ(samples, 1.0f);
    expectSameBits(ended, settings);
    const Settings level1 = {{"timeLimitSeconds", "1e-9"}, {"aaLevel", "1"}, {"aaLevelMost", "1"}};
    const Ended sparse = run(level1, PMR_STOP_TIME_LIMIT);
    EXPECT_EQ(4, sparse.json["passesDone"]);
    for (const float samples : sparse.samples) ASSERT_EQ(samples, 1.0f);
    expectSameBits(sparse, level1);
}

TEST_F(Stops, ATimeLimitIsKept) {
    const Settings settings = {{"timeLimitSeconds", "1"}};
    const Ended ended = run(settings, PMR_STOP_TIME_LIMIT);
    EXPECT_GT(ended.json["passesDone"].get<int>(), 1);
    const double seconds = ended.json["errorCurve"].back()["seconds"].get<double>();
    EXPECT_GT(seconds, 0.5);
    EXPECT_LT(seconds, 3.0);  // a machine that does other things at the same time
    expectSameBits(ended, settings);
}

TEST_F(Stops, PassesThatAreGivenEndARenderThatHasTargets) {
    const Ended ended = run(
        {{"passes", "3"}, {"errorTarget", "1e-12"}, {"timeLimitSeconds", "1e6"}}, PMR_STOP_PASSES);
    EXPECT_EQ(3, ended.json["passesDone"]);
    EXPECT_EQ(3, ended.json["passesPlanned"]);
    EXPECT_EQ(4, run({}, PMR_STOP_PASSES).json["passesDone"]);
}

TEST_F(Stops, CurveTellsErrorOverTime) {
    const nlohmann::json json = run({{"passes", "18"}}, PMR_STOP_PASSES).json;
    const auto& curve = json["errorCurve"];
    ASSERT_EQ(17u, curve.size());  // 1 to 16, and the last
    EXPECT_TRUE(curve[0]["estimatedRelMse"].is_null());
    EXPECT_TRUE(curve[0]["noise"].is_null());
    for (std::size_t i = 1; i < curve.size(); ++i) {
        EXPECT_GT(curve[i]["passes"], curve[i - 1]["passes"]);
        EXPECT_GE(curve[i]["seconds"], curve[i - 1]["seconds"]);
        EXPECT_GE(curve[i]["processorSeconds"], curve[i - 1]["processorSeconds"]);
        const double noise = curve[i]["noise"], bias = curve[i]["bias"];
        EXPECT_EQ(noise + std::max(0.0, bias), curve[i]["estimatedRelMse"].get<double>());
    }
    EXPECT_EQ(18, curve.back()["passes"]);
    EXPECT_LT(curve.back()["noise"].get<double>(), 0.5 * curve[1]["noise"].get<double>());
    EXPECT_EQ(curve.back()["noise"], json["relMseEstimateNoise"]);
    EXPECT_EQ(curve.back()["bias"], json["relMseEstimateBias"]);
    EXPECT_LE(json["relMseEstimateTrimmed"].get<double>(), json["relMseEstimate"].get<double>());
}

TEST_F(Stops, CancelledHasItsReason) {
    const PmrRender render = makeRender({{"passes", "100000"}});
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().renderStopReason(render, nullptr));
    ASSERT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_STOP_NONE, stopReason(render));
    EXPECT_EQ(PMR_OK, api().cancelRender(render));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, -1.0));
    EXPECT_EQ(PMR_STOP_CANCELLED, stopReason(render));
    EXPECT_EQ(PMR_STOP_CANCELLED, m_seen.reasonInFinished);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    std::int32_t reason = 0;
    EXPECT_EQ(PMR_ERROR_HANDLE, api().renderStopReason(render, &reason));
}

}  // namespace

}  // namespace pm::test
