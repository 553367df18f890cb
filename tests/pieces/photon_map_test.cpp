// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photon-map files: a picture rendered with one has the bits of one that traced its own photons,
// and a file that is of other photons is refused by what differs.
#include <sys/resource.h>

#include <array>
#include <csignal>

#include "tests/pieces/photon_host.h"

namespace pm::test {

namespace {

TEST_F(PhotonHost, GivesTheBitsOfARenderThatTraces) {
    makePhotons("m", {{"threads", "3"}});
    for (const Settings& more : std::vector<Settings>{
             {{"threads", "1"}},
             {{"threads", "3"}, {"bucketOrder", "spiral"}, {"bucketSize", "16"}},
             {{"passes", "3"}},
             {{"aaLevelMost", "2"}, {"estimatePhotons", "30"}, {"gatherRays", "6"}},
             {{"crop", "2,1,40,27"}}}) {
        const Outcome traced = render(more);
        const Outcome read = renderWith("m", more);
        EXPECT_EQ(32u, read.json["photonMap"]["hash"].get<std::string>().size());
        expectSameBits(traced, read);
        // What became of the photons is known from the file.
        EXPECT_EQ(traced.json["counters"], read.json["counters"]);
        EXPECT_EQ("read", read.json["photonMap"]["use"]);
        EXPECT_EQ(5, read.json["photonMap"]["passesHeld"]);
        EXPECT_FALSE(traced.json.contains("photonMap"));
    }
}

TEST_F(PhotonHost, GoesOnFromACheckpoint) {
    makePhotons("m");
    const Outcome whole = renderWith("m", {});
    Settings settings = {{"checkpoint", path("c")}, {"photonMap", path("m")}};
    render(settings, 50);
    settings["resume"] = "1";
    const Outcome resumed = render(settings);
    expectSameBits(whole, resumed);
    EXPECT_EQ(2, resumed.json["passesResumed"]);
}

TEST_F(PhotonHost, IsTheSameBytesWhateverThePixels) {
    makePhotons("a", {{"threads", "1"}});
    makePhotons("b", {{"threads", "3"},
                      {"width", "80"},
                      {"crop", "0,0,9,9"},
                      {"aaLevel", "4"},
                      {"estimatePhotons", "7"},
                      {"bucketSize", "64"}});
    EXPECT_TRUE(readFile(path("a")) == readFile(path("b")));
    // A file that is there is replaced, and of one with more passes the first are the same.
    const std::string hash = renderWith("a", {{"passes", "2"}}).json["photonMap"]["hash"];
    makePhotons("a", {{"passes", "2"}});
    EXPECT_LT(readFile(path("a")).size(), readFile(path("b")).size() / 2);
    EXPECT_EQ(hash, renderWith("a", {{"passes", "2"}}).json["photonMap"]["hash"]);
    EXPECT_EQ((std::vector<std::string>{"a", "b"}), files());
}

TEST_F(PhotonHost, PartsOfItArePartsOfThePicture) {
    m_settings["passes"] = "2";
    makePhotons("m");
    makePart("a", "1/3", {{"photonMap", path("m")}});
    makePart("b", "2/3", {{"photonMap", path("m")}, {"threads", "3"}});
    makePart("c", "3/3");
    PmrMerge merge = nullptr;
    ASSERT_EQ(PMR_OK, api().createMerge(m_host.context(), &merge));
    for (const char* part : {"a", "c", "b"})
        EXPECT_EQ(PMR_OK, api().addPart(merge, path(part).c_str())) << m_host.lastError();
    std::vector<float> pixels(40 * 28 * 4);
    const PmrRectangle frame{0, 0, 40, 28};
    EXPECT_EQ(PMR_OK, api().readMergedPixels(merge, &frame, "beauty", pixels.data(), 0, 0));
    EXPECT_TRUE(pixels == render({}).beauty);
    // A part says which photons it was made with.
    EXPECT_NE(std::string::npos, readFile(path("a")).find("\"photonHash\""));
    EXPECT_EQ(std::string::npos, readFile(path("c")).find("\"photonHash\""));
    EXPECT_EQ(PMR_ERROR_FILE, api().addPart(merge, path("m").c_str()));
    EXPECT_NE(std::string::npos, m_host.lastError().find("is a photon map, no part"));
    EXPECT_EQ(PMR_OK, api().releaseMerge(merge));
}

TEST_F(PhotonHost, OfOtherPhotonsIsRefusedByWhatDiffers) {
    m_settings["passes"] = "2";
    makePhotons("m");
    for (const auto& [name, value, text] : std::vector<std::array<std::string, 3>>{
             {"seed", "2", "setting seed (1 there, 2 here)"},
             {"photons", "1001", "photons a pass (1000 global, 1000 caustic there, 1001 global"},
             {"photons", "0", "photons a pass"},
             {"passes", "3", "holds 2 passes; up to 3 were asked for"}}) {
        const Outcome refused = renderWith("m", {{name, value}});
        EXPECT_EQ(PMR_ERROR_MISMATCH, refused.started);
        EXPECT_NE(std::string::npos, refused.error.find(path("m"))) << refused.error;
        EXPECT_NE(std::string::npos, refused.error.find(text)) << refused.error;
    }
    // A target may end a render earlier.
    EXPECT_EQ(PMR_OK, renderWith("m", {{"errorTarget", "1000"}}).ended);
    PmrScene scene = nullptr;
    const PmrSceneDesc desc = PMR_INIT(PmrSceneDesc);
    ASSERT_EQ(PMR_OK, api().createScene(m_host.context(), &desc, &scene)) << m_host.lastError();
    addGreyBall(m_host.context(), scene);
    ASSERT_EQ(PMR_OK, api().commitScene(scene)) << m_host.lastError();
    const Outcome other = render(scene, {{"photonMap", path("m")}});
    EXPECT_EQ(PMR_ERROR_MISMATCH, other.started);
    for (const char* part : {"geometry", "materials", "photons a pass"})
        EXPECT_NE(std::string::npos, other.error.find(part)) << other.error;
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
}

TEST_F(PhotonHost, WhatIsNoPhotonMapIsRefused) {
    m_settings["passes"] = "1";
    makePart("part", "0:2");
    render({{"checkpoint", path("check")}});
    writeFile(path("text"), "newmtl light\n");
    writeFile(path("empty"), "");
    std::filesystem::create_directory(path("folder"));
    const std::vector<std::array<std::string, 2>> cases = {
        {"absent", "there is no such photon map"},
        {"part", "is a part of a picture, no photon map"},
        {"check", "is a checkpoint, no photon map"},
        {"text", "is no photon map"},
        {"empty", "is no photon map"},
        {"folder", "is no photon map"}};
    for (const auto& [file, text] : cases) {
        const Outcome refused = renderWith(file, {});
        EXPECT_EQ(PMR_ERROR_FILE, refused.started) << file;
        EXPECT_NE(std::string::npos, refused.error.find(text)) << refused.error;
    }
    // Nor is anything else overwritten.
    for (const char* file : {"part", "check", "text", "folder"}) {
        const Outcome refused = tracePhotons(file, {});
        EXPECT_EQ(PMR_ERROR_FILE, refused.started) << file;
        EXPECT_NE(std::string::npos, refused.error.find("would be overwritten")) << refused.error;
    }
    EXPECT_EQ(13u, readFile(path("text")).size());
    EXPECT_EQ(PMR_ERROR_IO, tracePhotons("no/folder", {}).started);
    EXPECT_EQ((std::vector<std::string>{"check", "empty", "folder", "part", "text"}), files());
}

TEST_F(PhotonHost, WhatDoesNotGoTogetherIsRefused) {
    const auto refused = [&](const Settings& settings, const std::string& text) {
        const Outcome outcome = render(settings);
        EXPECT_EQ(PMR_ERROR_ARGUMENT, outcome.started);
        EXPECT_NE(std::string::npos, outcome.error.find(text)) << outcome.error;
    };
    const Settings only = {{"photonsOnly", "1"}, {"photonMap", path("m")}};
    const auto with = [&](const char* name, const std::string& value) {
        Settings all = only;
        all[name] = value;
        return all;
    };
    refused({{"photonsOnly", "1"}}, "needs photonMap");
    refused({{"photonMap", path("m")}, {"integrator", "path"}}, "path");
    for (const auto& [name, value] :
         std::vector<std::array<std::string, 2>>{{"buckets", "1/2"},
                                                 {"part", path("p")},
                                                 {"checkpoint", path("c")},
                                                 {"timeLimitSeconds", "9"},
                                                 {"errorTarget", "0.1"}})
        refused(with(name.c_str(), value), "photonsOnly does not go together with " + name);
    EXPECT_TRUE(files().empty());
}

TEST_F(PhotonHost, MakesNoPictureAndNoBuckets) {
    const Outcome only = tracePhotons("m", {});
    ASSERT_TRUE(only.isOk()) << only.error;
    EXPECT_EQ(0, m_seen.buckets);
    EXPECT_EQ(1, m_seen.finished);
    EXPECT_EQ(1.0, m_seen.progress);
    EXPECT_EQ(0u, m_seen.layers);
    EXPECT_EQ(PMR_ERROR_NAME, m_seen.readStatus);
    EXPECT_EQ("passes done", only.json["stopReason"]);
    EXPECT_EQ(5, only.json["passesDone"]);
    EXPECT_EQ("written", only.json["photonMap"]["use"]);
    EXPECT_EQ(readFile(path("m")).size(), only.json["photonMap"]["fileBytes"]);
    EXPECT_TRUE(only.json["relMseEstimate"].is_null());
    EXPECT_EQ(0, only.json["memory"]["frameBytes"]);
    // The photons are those of a render.
    const auto counters = render({}).json["counters"];
    for (const char* name : {"photonsEmitted", "photonsStoredGlobal", "photonsStoredCaustic",
                             "fluxEmittedW", "fluxAbsorbedW"})
        EXPECT_EQ(counters[name], only.json["counters"][name]) << name;
    EXPECT_GT(counters["photonsStoredCaustic"], 100);
}

TEST_F(PhotonHost, IsExplained) {
    EXPECT_NE(std::string::npos,
              explain({{"photonMap", "maps"}}).find("photons: read from maps, which is not there"));
    const std::string only = explain({{"photonMap", "maps"}, {"photonsOnly", "1"}});
    EXPECT_NE(std::string::npos, only.find("photons only: those of 5 passes are traced into maps"));
    EXPECT_NE(std::string::npos, only.find("frame 0.00"));
    EXPECT_TRUE(files().empty());
}

TEST_F(PhotonHost, AFullDiskLeavesNothing) {
    makePhotons("m", {{"passes", "1"}});
    const std::string before = readFile(path("m"));
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    getrlimit(RLIMIT_FSIZE, &limit);
    const rlimit small{2 * before.size(), limit.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    const Outcome full = tracePhotons("m", {});
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(PMR_ERROR_IO, full.ended) << full.error;
    EXPECT_NE(std::string::npos, full.error.find("can't be written")) << full.error;
    EXPECT_EQ((std::vector<std::string>{"m"}), files());
    EXPECT_TRUE(before == readFile(path("m")));
}

TEST_F(PhotonHost, CancelledLeavesNothing) {
    // Many passes, so that it is not done before it hears of it.
    for (const double fraction : {0.0, 1e-5}) {
        const Outcome cancelled = tracePhotons("m", {{"passes", "100000"}}, fraction);
        EXPECT_EQ(PMR_ERROR_CANCELLED, cancelled.ended) << fraction;
        EXPECT_EQ("cancelled", cancelled.json["stopReason"]);
        EXPECT_TRUE(files().empty());
    }
}

}  // namespace

}  // namespace pm::test
