// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders that go on from a checkpoint have the bits of those that were never interrupted.
#include <sys/resource.h>

#include <array>
#include <csignal>

#include "tests/abi/box_scene.h"
#include "tests/pieces/piece_host.h"

namespace pm::test {

namespace {

class Checkpoints : public PieceHost {
  protected:
    Settings on(const Settings& more = {}) const {
        Settings settings = more;
        settings["checkpoint"] = path("c");
        settings["resume"] = std::string("1");
        return settings;
    }
    // A checkpoint of a render that was cancelled after about so many buckets; 20 make a pass.
    void makeInterrupted(int buckets, const Settings& more = {}) {
        const Outcome outcome = render(on(more), buckets);
        ASSERT_EQ(PMR_ERROR_CANCELLED, outcome.ended);
    }
    void expectRefusal(const Outcome& outcome, PmrStatus status, const std::string& text) {
        EXPECT_EQ(status, outcome.started == PMR_OK ? outcome.ended : outcome.started);
        EXPECT_NE(std::string::npos, outcome.error.find(text)) << outcome.error;
        EXPECT_NE(std::string::npos, outcome.error.find(path("c"))) << outcome.error;
    }
};

TEST_F(Checkpoints, ChangeNoBit) {
    expectSameBits(render({}), render(on()));
    EXPECT_EQ((std::vector<std::string>{"c"}), files());
}

TEST_F(Checkpoints, InterruptedAnywhereGoOn) {
    const Outcome whole = render({});
    // Within the first pass, in later ones, and after the file was made anew from sums alone.
    for (const int buckets : {1, 7, 20, 33, 61, 90}) {
        std::filesystem::remove(path("c"));
        makeInterrupted(buckets);
        const Outcome resumed = render(on());
        expectSameBits(whole, resumed);
        // Events are late, so at least so many buckets were done.
        EXPECT_GE(resumed.json["passesResumed"].get<int>(), buckets / 20) << buckets;
    }
}

TEST_F(Checkpoints, SeveralTimes) {
    const Outcome whole = render({});
    for (int i = 0; i < 6; ++i) render(on(), 17);
    expectSameBits(whole, render(on()));
}

TEST_F(Checkpoints, GoOnWithOtherBucketsAndThreads) {
    const Outcome whole = render({});
    int withinPass = 0;
    for (const std::string size : {"8", "24", "40"}) {
        std::filesystem::remove(path("c"));
        // Six buckets a pass; some of the third one's are done.
        makeInterrupted(15, {{"bucketSize", "16"}, {"bucketOrder", "row"}, {"threads", "1"}});
        const Outcome resumed = render(on({{"bucketSize", size}, {"threads", "3"}}));
        expectSameBits(whole, resumed);
        withinPass += resumed.infos.find(" passes and 0 % of") == std::string::npos;
    }
    EXPECT_GT(withinPass, 0);
}

TEST_F(Checkpoints, FinishedOnesGoOnWithMorePasses) {
    render(on({{"passes", "2"}}));
    const Outcome more = render(on());
    expectSameBits(render({}), more);
    EXPECT_EQ(2, more.json["passesResumed"]);
    // And again, now that nothing is left to do.
    const Outcome again = render(on());
    expectSameBits(more, again);
    EXPECT_EQ(0, again.json["counters"]["cameraSamples"]);
}

TEST_F(Checkpoints, ErrorTargetsStopWhereTheyWouldHave) {
    const double first = render({{"passes", "2"}}).json["relMseEstimate"];
    const Settings target = {{"errorTarget", std::to_string(0.5 * first)}};
    m_settings.erase("passes");
    const Outcome whole = render(target);
    ASSERT_GT(whole.json["passesDone"].get<int>(), 2);
    makeInterrupted(30, target);
    const Outcome resumed = render(on(target));
    expectSameBits(whole, resumed);
    EXPECT_EQ("error target", resumed.json["stopReason"]);
    // Killed after its end, before its host wrote anything.
    expectSameBits(whole, render(on(target)));
}

TEST_F(Checkpoints, PassesAreNotTakenBack) {
    render(on({{"passes", "4"}}));
    const Outcome outcome = render(on({{"passes", "3"}}));
    EXPECT_EQ(PMR_ERROR_MISMATCH, outcome.ended);
    EXPECT_NE(std::string::npos, outcome.error.find("4 passes; 3 were asked")) << outcome.error;
}

TEST_F(Checkpoints, OfAnotherRenderAreRefusedByWhatDiffers) {
    makeInterrupted(10);
    const std::string before = readFile(path("c"));
    for (const auto& [name, value, text] : std::vector<std::array<std::string, 3>>{
             {"seed", "2", "setting seed (1 there, 2 here)"},
             {"photons", "2001", "setting photons (1000 there, 2001 here)"},
             {"width", "48", "setting width (40 there, 48 here)"},
             {"crop", "0,0,20,20", "window (0,0,40,28 there, 0,0,20,20 here)"},
             {"layers", "N", "layers"},
             {"buckets", "0:3", "run of buckets"},
             {"hostIdentity", "colour config: x", "colour config (none there, x here)"}})
        expectRefusal(render(on({{name, value}})), PMR_ERROR_MISMATCH, text);
    PmrScene other = nullptr;
    ASSERT_EQ(PMR_OK, makeBoxScene(&api(), m_host.context(), &other));
    expectSameBits(render({}), render(other, on()));  // the same scene from other handles
    EXPECT_EQ(PMR_OK, api().releaseScene(other));
    writeFile(path("c"), before);
    expectSameBits(render({}), render(on()));
}

TEST_F(Checkpoints, AnotherSceneIsRefusedByName) {
    makeInterrupted(10);
    PmrScene scene = nullptr;
    PmrSceneDesc sceneDesc = PMR_INIT(PmrSceneDesc);
    ASSERT_EQ(PMR_OK, api().createScene(m_host.context(), &sceneDesc, &scene));
    addGreyBall(m_host.context(), scene);
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    const double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5};
    camera.transforms = transform;
    camera.transformCount = 1;
    camera.fieldOfView = 0.8;
    ASSERT_EQ(PMR_OK, api().setCamera(scene, &camera));
    ASSERT_EQ(PMR_OK, api().commitScene(scene)) << m_host.lastError();
    const Outcome outcome = render(scene, on());
    expectRefusal(outcome, PMR_ERROR_MISMATCH, "differs in");
    for (const char* what : {"geometry", "materials", "camera"})
        EXPECT_NE(std::string::npos, outcome.error.find(what)) << outcome.error;
    for (const char* what : {"seed", "build", "window"})
        EXPECT_EQ(std::string::npos, outcome.error.find(what)) << outcome.error;
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
}

TEST_F(Checkpoints, WithoutResumeBeginAnew) {
    const auto tells = [this](const Outcome& outcome) {
        return outcome.warnings.find(path("c") + ": a checkpoint was there; it is begun anew") !=
               std::string::npos;
    };
    EXPECT_FALSE(tells(render(on({{"seed", "7"}}))));
    const Outcome fresh = render({{"checkpoint", path("c")}});
    EXPECT_TRUE(tells(fresh)) << fresh.warnings;
    expectSameBits(render({}), fresh);
    EXPECT_EQ(0, fresh.json["passesResumed"]);
}

TEST_F(Checkpoints, OtherFilesAreNotOverwritten) {
    for (const char* resume : {"0", "1"}) {
        writeFile(path("c"), "a letter to a friend");
        expectRefusal(render({{"checkpoint", path("c")}, {"resume", resume}}), PMR_ERROR_FILE,
                      "no checkpoint");
        EXPECT_EQ("a letter to a friend", readFile(path("c")));
    }
    makePart("c", "");
    const std::string part = readFile(path("c"));
    expectRefusal(render(on()), PMR_ERROR_FILE, "is a part of a picture");
    expectRefusal(render({{"checkpoint", path("c")}}), PMR_ERROR_FILE, "is a part of a picture");
    EXPECT_TRUE(part == readFile(path("c")));
}

TEST_F(Checkpoints, InAFolderThatIsNotThere) {
    const Outcome outcome = render({{"checkpoint", path("no/c")}});
    EXPECT_EQ(PMR_ERROR_IO, outcome.started);
    EXPECT_NE(std::string::npos, outcome.error.find(path("no/c"))) << outcome.error;
}

TEST_F(Checkpoints, AreOfOneRenderAtATime) {
    const PmrRender first = m_host.makeRender(on({{"passes", "100000"}}));
    ASSERT_EQ(PMR_OK, api().startRender(first));
    expectRefusal(render(on()), PMR_ERROR_IO, "another render uses");
    EXPECT_EQ(PMR_OK, api().cancelRender(first));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(first, -1.0));
    // It is free once the render has ended, even if its handle lives.
    expectRefusal(render(on()), PMR_ERROR_MISMATCH, "differs");
    EXPECT_EQ(PMR_OK, api().destroyRender(first));
}

TEST_F(Checkpoints, OfARunOfBuckets) {
    const Settings run = {{"buckets", "2:17"}};
    const Outcome whole = render(run);
    makeInterrupted(22, run);
    expectSameBits(whole, render(on(run)));
}

TEST_F(Checkpoints, EmptyOnesAreNotLeftBehind) {
    const Outcome outcome = render(on({{"memoryLimitGib", "0.000001"}}));
    EXPECT_EQ(PMR_ERROR_MEMORY, outcome.started);
    EXPECT_TRUE(files().empty());
    writeFile(path("c"), "");  // somebody's: what begins here has its head from the start
    expectRefusal(render(on()), PMR_ERROR_FILE, "is there and no checkpoint");
    EXPECT_EQ(files(), std::vector<std::string>{"c"});
}

// Of a user's own, and where a link leads to.
TEST_F(Checkpoints, NamesBesideThemAreLeftAlone) {
    for (const char* name : {"c.tmp", "mine"}) writeFile(path(name), "mine");
    EXPECT_TRUE(render({{"checkpoint", path("c")}}).isOk());
    EXPECT_EQ("mine", readFile(path("c.tmp")));
    EXPECT_EQ("mine", readFile(path("mine")));
    std::filesystem::remove(path("c.tmp"));
    std::filesystem::create_symlink(path("mine"), path("c.tmp"));
    EXPECT_TRUE(render({{"checkpoint", path("c")}}).isOk());
    EXPECT_EQ("mine", readFile(path("mine")));
}

TEST_F(Checkpoints, OnAFullDiskLeaveNothing) {
    rlimit limit{};
    getrlimit(RLIMIT_FSIZE, &limit);
    const rlimit none{10, limit.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &none);
    const Outcome outcome = render({{"checkpoint", path("c")}});
    setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, handler);
    expectRefusal(outcome, PMR_ERROR_IO, "can't be written");
    EXPECT_TRUE(files().empty());
}

TEST_F(Checkpoints, StayBoundedOverManyPasses) {
    m_settings["passes"] = "40";
    m_settings["photons"] = "100";
    render(on());
    // Sums take some 250 bytes a pixel, and records of passes at most as many and those of a pass.
    EXPECT_LT(std::filesystem::file_size(path("c")), 40u * 28u * 700u);
    EXPECT_EQ((std::vector<std::string>{"c"}), files());
}

}  // namespace

}  // namespace pm::test
