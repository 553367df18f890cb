// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The statistics as JSON, while a render runs, when it is done, cancelled or without light.
#include <nlohmann/json.hpp>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

nlohmann::json statistics(PmrRender render) {
    return nlohmann::json::parse(
        textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().renderStatistics(render, buffer, capacity, needed);
        }));
}

TEST(Statistics, OfAFinishedRender) {
    const BoxHost host;
    const PmrRender render = host.makeRender({{"passes", "3"}, {"threads", "2"}});
    ASSERT_EQ(PMR_OK, api().startRender(render));
    ASSERT_EQ(PMR_OK, api().waitRender(render, -1.0));
    const nlohmann::json json = statistics(render);
    EXPECT_EQ("pm-stats/1", json["schema"]);
    EXPECT_EQ("passes done", json["stopReason"]);
    EXPECT_EQ(3, json["passesDone"]);
    EXPECT_EQ(3, json["passesPlanned"]);
    EXPECT_EQ(2, json["threads"]);
    EXPECT_EQ(2, json["settings"]["threads"]);
    EXPECT_GT(json["relMseEstimate"].get<double>(), 0.0);
    EXPECT_TRUE(json["relMseEstimateIsLowerBound"].is_boolean());
    EXPECT_GE(json["relMseEstimateUnresolvedShare"].get<double>(), 0.0);
    EXPECT_LE(json["relMseEstimateUnresolvedShare"].get<double>(), 1.0);
    EXPECT_TRUE(json.contains("relMseEstimateDegreesOfFreedom"));
    EXPECT_GT(json["counters"]["cameraSamples"].get<std::uint64_t>(), 0u);
    EXPECT_EQ(4000, json["plan"]["globalPhotonsPerPass"]);
    // Those of the caustic map and of other aids come on top.
    EXPECT_GE(json["counters"]["photonsEmitted"].get<std::uint64_t>(), 3u * 4000u);
    EXPECT_GT(json["counters"]["fluxEmittedW"].get<double>(), 0.0);
    EXPECT_GT(json["memory"]["peakResidentBytes"].get<std::uint64_t>(), 1u << 20);
    EXPECT_GT(json["memory"]["sceneBytes"].get<std::uint64_t>(), 0u);
    EXPECT_LE(json["buckets"]["minimumSecondsPerPass"].get<double>(),
              json["buckets"]["maximumSecondsPerPass"].get<double>());
    EXPECT_EQ(16, json["buckets"]["sizePixels"]);
    EXPECT_GE(json["buckets"]["idleTailThreadSeconds"].get<double>(), 0.0);
    EXPECT_LT(json["buckets"]["idleTailThreadSeconds"].get<double>(),
              2 * json["phases"]["renderSeconds"].get<double>());
    EXPECT_FALSE(json["plan"]["lines"].empty());
    EXPECT_FALSE(json["isa"].get<std::string>().empty());
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

// What is planned decides what is refused.
TEST(Statistics, MapsTakeWhatIsPlanned) {
    const BoxHost host;
    for (const char* photons : {"100", "2000", "20000", "200000"})
        for (const char* size : {"40", "320"}) {
            const PmrRender render = host.makeRender({{"passes", "1"},
                                                      {"photons", photons},
                                                      {"width", size},
                                                      {"height", size},
                                                      {"crop", "0,0,8,8"}});
            ASSERT_EQ(PMR_OK, api().startRender(render)) << host.lastError();
            ASSERT_EQ(PMR_OK, api().waitRender(render, -1.0)) << host.lastError();
            const nlohmann::json memory = statistics(render)["memory"];
            const auto used = memory["mapBytes"].get<double>();
            const auto planned = memory["plannedMapBytes"].get<double>();
            EXPECT_GT(used, 0);
            EXPECT_LE(used, 1.5 * planned) << photons << " photons, " << size << " pixels";
            EXPECT_LE(planned, 1.5 * used) << photons << " photons, " << size << " pixels";
            EXPECT_GT(memory["processBytes"].get<double>(), 0);
            EXPECT_EQ(PMR_OK, api().destroyRender(render));
        }
}

// Maps of 8 passes of a huge frame by buckets; points are those of the crop, not of the frame,
// whose million takes 90 MB a pass.
TEST(Statistics, MapsOfAHugeFrameTakeWhatIsPlanned) {
    const BoxHost host;
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.bucketFinished = [](void*, PmrRender, const PmrBucketInfo*) {};
    const PmrRender render = host.makeRender({{"width", "32768"},
                                              {"height", "32768"},
                                              {"crop", "16000,16384,16256,16512"},
                                              {"delivery", "buckets"},
                                              {"photons", "20000"},
                                              {"passes", "8"},
                                              {"aaLevel", "1"},
                                              {"aaLevelMost", "1"}},
                                             &desc);
    ASSERT_EQ(PMR_OK, api().startRender(render)) << host.lastError();
    ASSERT_EQ(PMR_OK, api().waitRender(render, -1.0)) << host.lastError();
    const nlohmann::json memory = statistics(render)["memory"];
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    const auto used = memory["mapBytes"].get<double>();
    const auto planned = memory["plannedMapBytes"].get<double>();
    EXPECT_LE(used, 1.5 * planned);
    // Of so small a crop, tiles that are never asked for count.
    EXPECT_LT(planned, 1.5 * used);
    EXPECT_LT(planned, 130e6);
}

// Checksums tell renders apart that have other pixels, and none that have not.
TEST(Statistics, HashesNameTheRender) {
    using Settings = std::map<std::string, std::string>;
    const BoxHost host;
    const auto hashes = [&](const Settings& settings) {
        const PmrRender render = host.makeRender(settings);
        EXPECT_EQ(PMR_OK, api().startRender(render));
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
        const nlohmann::json json = statistics(render)["hashes"];
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        return json;
    };
    const nlohmann::json first = hashes({{"passes", "1"}});
    EXPECT_EQ(32u, first["scene"].get<std::string>().size());
    EXPECT_EQ(
        first,
        hashes({{"passes", "2"}, {"threads", "1"}, {"bucketSize", "16"}, {"bucketOrder", "row"}}));
    const nlohmann::json other = hashes({{"passes", "1"}, {"seed", "7"}});
    EXPECT_EQ(first["scene"], other["scene"]);
    EXPECT_NE(first["settings"], other["settings"]);
    const BoxHost again;
    const PmrRender render = again.makeRender({{"passes", "1"}});
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(first["scene"], statistics(render)["hashes"]["scene"]) << "the same scene, made anew";
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Statistics, OnePassCannotTellItsError) {
    const BoxHost host;
    const PmrRender render = host.makeRender({{"passes", "1"}});
    ASSERT_EQ(PMR_OK, api().startRender(render));
    ASSERT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_TRUE(statistics(render)["relMseEstimate"].is_null());
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Statistics, WhileRunningAndAfterCancel) {
    const BoxHost host;
    const PmrRender render = host.makeRender({{"passes", "100000"}});
    ASSERT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ("running", statistics(render)["stopReason"]);
    EXPECT_EQ(PMR_OK, api().cancelRender(render));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, -1.0));
    const nlohmann::json json = statistics(render);
    EXPECT_EQ("cancelled", json["stopReason"]);
    EXPECT_LT(json["passesDone"].get<int>(), 100000);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Statistics, NoLightIsAWarning) {
    const BoxHost host;
    PmrScene scene = nullptr;
    ASSERT_EQ(PMR_OK, api().createScene(host.context(), nullptr, &scene));
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    camera.fieldOfView = 1;
    ASSERT_EQ(PMR_OK, api().setCamera(scene, &camera));
    addGreyBall(host.context(), scene);
    ASSERT_EQ(PMR_OK, api().commitScene(scene)) << host.lastError();
    PmrRender render = nullptr;
    ASSERT_EQ(PMR_OK, api().createRender(scene, nullptr, &render));
    ASSERT_EQ(PMR_OK, api().setSettingInteger(render, "width", 16));
    ASSERT_EQ(PMR_OK, api().setSettingInteger(render, "height", 16));
    ASSERT_EQ(PMR_OK, api().startRender(render)) << host.lastError();
    ASSERT_EQ(PMR_OK, api().waitRender(render, -1.0)) << host.lastError();
    const nlohmann::json json = statistics(render);
    bool found = false;
    for (const auto& warning : json["warnings"])
        found = found || warning["code"] == PMR_MESSAGE_NO_LIGHT;
    EXPECT_TRUE(found) << json["warnings"].dump();
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
}

}  // namespace

}  // namespace pm::test
