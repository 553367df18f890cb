// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Bad input to the real pm_host: the right exit code and one line that says what, where and what is
// allowed; nothing half-written.
#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "host_shim/log/guarded.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class BadInput : public HostProcess {
  protected:
    Outcome runScene(const std::string& text) const {
        write("bad.obj", text);
        return run({"bad.obj", "--size", "16x16"});
    }
};

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST_F(BadInput, scenes) {
    expectRefusal(run({"none.obj"}), 4, {"none.obj", "No such file"});
    expectRefusal(runScene(kTriangle + "f 1 2 9001\n"), 3,
                  {"pm_host: bad.obj:4: face refers to vertex 9001 of 3"});
    expectRefusal(runScene(kTriangle + "f 0 1 2\n"), 3, {"bad.obj:4:"});
    expectRefusal(runScene("v 0 nan 0\n" + kTriangle + "f 1 2 3\n"), 3, {"bad.obj:1:", "'nan'"});
    expectRefusal(runScene(""), 3, {"bad.obj: no geometry"});
    expectRefusal(runScene(std::string("\xFE\xFF\0v\0 ", 6)), 3, {"bad.obj: no geometry"});
    expectRefusal(run({"/"}), 3, {"no geometry"});
    ASSERT_EQ(mkfifo(path("pipe.obj").c_str(), 0600), 0);
    expectRefusal(run({"pipe.obj"}), 4, {"pipe.obj: can't be read: it is a pipe"});
    write("scene.txt", "x");
    expectRefusal(run({"scene.txt"}), 3, {"scene.txt", ".obj"});
    expectRefusal(run({"box.obj", "--log", "BOX.MTL"}), 2, {"BOX.MTL", "may not end in .mtl"});
    expectRefusal(run({"box.obj", "-o", "box"}), 2, {"box: its name has no ending", ".exr"});
    expectRefusal(run({"box.obj", "-o", "a.png", "--look", "None"}), 3, {"'None'; there are none"});
    fs::copy_file(path("box.obj"), path("box.Obj"));
    EXPECT_EQ(run({"box.Obj", "--explain"}).exitCode, 0);
}

TEST_F(BadInput, aMissingLibraryIsAWarningAndADefaultMaterial) {
    fs::remove(path("box.mtl"));
    const Outcome outcome = render({});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("warning: box.obj:1: material library missing: box.mtl"),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("'wall', 'light'"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("a point light at the camera"), std::string::npos) << outcome.err;
    EXPECT_TRUE(fs::exists(path("box.exr")));
}

// What is wrong with a part of a scene is told with its file and line or its group.
TEST_F(BadInput, partsOfAScene) {
    write("box.mtl", "newmtl light\nKe 5 5 5\nnewmtl wall\nKd 1 1 1\nmap_Kd none.png\n");
    write("flat.obj",
          "mtllib box.mtl\n" + kTriangle + "usemtl wall\nf 1 2 3\ng bulb\nusemtl light\nf 1 2 2\n");
    const Outcome outcome = run({"flat.obj", "--size", "16x16", "--passes", "1"});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    for (const char* text :
         {"warning: box.mtl:5: material wall: texture none.png does not exist",
          "warning: flat.obj: group bulb: 1 triangles without area were left out",
          "warning: flat.obj: group bulb: the faces of material light have no area"})
        EXPECT_NE(outcome.err.find(text), std::string::npos) << text << " in " << outcome.err;
}

// A room that is closed all round, seen from outside; the same from inside says nothing.
TEST_F(BadInput, aBlackPictureIsAWarning) {
    write("room.mtl", "newmtl lamp\nKd 0.5 0.5 0.5\nKe 1 1 1\n");
    write("room.obj",
          "mtllib room.mtl\nusemtl lamp\n"
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
          "f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 4 3 7 8\nf 1 4 8 5\nf 2 6 7 3\n");
    const std::vector<std::string> small = {"room.obj", "--size", "16x16", "--passes", "1"};
    std::vector<std::string> without = small;
    without.insert(without.end(), {"--eye", ".5,.5,3", "--look-at", ".5,.5,0"});
    const Outcome outside = run(without);
    EXPECT_EQ(outside.exitCode, 0) << outside.err;
    EXPECT_NE(outside.err.find("the picture is black"), std::string::npos) << outside.err;
    std::vector<std::string> within = small;
    within.insert(within.end(), {"--eye", ".5,.5,.9", "--look-at", ".5,.5,0"});
    const Outcome inside = run(within);
    EXPECT_EQ(inside.exitCode, 0) << inside.err;
    EXPECT_EQ(inside.err.find("the picture is black"), std::string::npos) << inside.err;
    EXPECT_EQ(inside.err.find("nothing of the scene"), std::string::npos) << inside.err;
}

// A camera that looks past the scene; a crop of the background says nothing.
TEST_F(BadInput, anEmptyPictureIsAWarning) {
    write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::vector<std::string> past = {"tri.obj", "--size", "16x16",     "--passes", "1",
                                     "--eye",   "0,0,9",  "--look-at", "0,0,20"};
    const Outcome whole = run(past);
    EXPECT_EQ(whole.exitCode, 0) << whole.err;
    EXPECT_NE(whole.err.find("nothing of the scene is in the picture"), std::string::npos)
        << whole.err;
    past.insert(past.end(), {"--crop", "0,0,8,8"});
    EXPECT_EQ(run(past).err.find("nothing of the scene"), std::string::npos);
}

TEST_F(BadInput, options) {
    expectRefusal(run({}), 2, {"SCENE"});
    expectRefusal(run({"box.obj", "--bogus"}), 2, {"--bogus: there is no such option (see"});
    expectRefusal(run({"--pases", "3", "box.obj"}), 2,
                  {"--pases: there is no such option; is --passes meant?"});
    expectRefusal(run({"box.obj", "--sed=3"}), 2, {"--sed: there is no such", "is --seed meant?"});
    expectRefusal(run({"box.obj", "b.obj"}), 2, {"'b.obj': one scene is wanted"});
    expectRefusal(run({"box.obj", "--denoise"}), 2, {"--denoise: not available yet"});
    expectRefusal(run({"box.obj", "--photon-map", "f"}), 3, {"f: there is no such photon map"});
    expectRefusal(run({"box.obj", "--photons-only"}), 2, {"--photons-only needs --photon-map"});
    expectRefusal(run({"merge", "a"}), 2, {"pm_host merge PART... -o FILE"});
    expectRefusal(run({"box.obj", "--bucket-size", "12"}), 2, {"--bucket-size", "12", "8"});
    expectRefusal(run({"box.obj", "--integrator", "magic"}), 2, {"--integrator", "magic", "path"});
    expectRefusal(run({"box.obj", "--aov", "smell"}), 2, {"--aov", "smell", "albedo"});
    expectRefusal(run({"box.obj", "--isa", "z80"}), 2, {"--isa", "z80", "avx2"});
    expectRefusal(run({"box.obj", "--passes", "-3"}), 2, {"--passes", "-3"});
    expectRefusal(run({"box.obj", "--memory-limit", "0.000001"}), 5, {"memory"});
}

TEST_F(BadInput, colour) {
    expectRefusal(run({"box.obj", "-o", "a.png", "--view", "Moonlight"}), 3,
                  {"Moonlight", "ACES SDR"});
    expectRefusal(run({"box.obj", "--rendering-space", "nowhere"}), 3, {"nowhere"});
    expectRefusal(run({"box.obj", "--ocio", "none.ocio"}), 3, {"none.ocio"});
}

TEST_F(BadInput, plugins) {
    const Outcome none = run({"box.obj", "--plugin", "none.so"});
    expectRefusal(none, 1, {"no plugin", "none.so"});
    // Never the working folder.
    write("libpm_plugin.so", "not a library");
    expectRefusal(run({"box.obj", "--plugin", "libpm_plugin.so"}), 1, {"no plugin"});
    EXPECT_EQ(render({}).exitCode, 0);
    const Outcome variable = run({"box.obj"}, nullptr, {{"PM_PLUGIN_PATH", "/nowhere/x.so"}});
    EXPECT_EQ(variable.exitCode, 1);
}

TEST_F(BadInput, references) {
    expectRefusal(run({"box.obj", "--reference", "none.exr"}), 4, {"none.exr"});
    write("broken.exr", "not a picture");
    const Outcome broken = run({"box.obj", "--reference", "broken.exr"});
    EXPECT_EQ(broken.exitCode, 3) << broken.err;
    ASSERT_EQ(render({"-o", "reference.exr"}).exitCode, 0);
    const Outcome other = run({"box.obj", "--size", "8x8", "--reference", "reference.exr"});
    EXPECT_EQ(other.exitCode, 3);
    EXPECT_NE(other.err.find("16x16"), std::string::npos) << other.err;
    EXPECT_NE(other.err.find("8x8"), std::string::npos) << other.err;
    // Found before the first ray, not after the last.
    ASSERT_EQ(render({"-o", "part.exr", "--crop", "4,4,8,8"}).exitCode, 0);
    const Outcome part = render({"-o", "late.exr", "--reference", "part.exr"});
    EXPECT_EQ(part.exitCode, 3) << part.err;
    EXPECT_FALSE(fs::exists(path("late.exr")));
    ASSERT_EQ(render({"-o", "wide.exr", "--rendering-space", "ACEScg"}).exitCode, 0);
    const Outcome space = render({"-o", "late.exr", "--reference", "wide.exr"});
    EXPECT_EQ(space.exitCode, 3) << space.err;
    EXPECT_NE(space.err.find("ACEScg"), std::string::npos) << space.err;
}

TEST_F(BadInput, resultsThatDoNotGetOut) {
    const Outcome outcome = run({"--list", "aovs"}, [](pid_t) {});
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(std::system((std::string(PM_HOST) + " --list aovs >/dev/full 2>/dev/null").c_str()),
              4 << 8);
}

TEST_F(BadInput, layersWantAnExr) {
    expectRefusal(run({"box.obj", "--aov", "N", "-o", "x.png"}), 2, {"--aov N", ".exr"});
}

// What is found after the start, by the render's own thread, is told as well.
TEST_F(BadInput, faultsThatShowLateAreTold) {
    const std::vector<std::string> kept{"-o", "a.exr",    "--checkpoint",
                                        "c",  "--resume", "--keep-checkpoint"};
    ASSERT_EQ(render(kept).exitCode, 0);
    std::vector<std::string> fewer = kept;
    fewer.insert(fewer.end(), {"--passes", "1"});
    const Outcome late = render(fewer);
    EXPECT_EQ(late.exitCode, 3);
    EXPECT_NE(late.err.find("c: the checkpoint has 2 passes; 1 were asked for"), std::string::npos)
        << late.err;
    std::vector<std::string> photons{"box.obj", "--size",         "16x16", "--passes",
                                     "2",       "--photons",      "1000",  "--photon-map",
                                     "ph",      "--photons-only", "-q"};
    ASSERT_EQ(run(photons).exitCode, 0);
    std::string bytes = readText(path("ph"));
    bytes[bytes.size() / 2] ^= 1;
    write("ph", bytes);
    std::erase(photons, "--photons-only");
    const Outcome damaged = run(photons);
    EXPECT_EQ(damaged.exitCode, 3);
    EXPECT_NE(damaged.err.find("ph: the photon map is damaged"), std::string::npos) << damaged.err;
}

TEST_F(BadInput, aThreadThatCannotBeStartedIsAWantOfMemory) {
    Log log({Level::kError, false});
    std::string text;
    const auto codeOf = [&](std::errc error) {
        return guarded(
            log, [&]() -> int { throw std::system_error(std::make_error_code(error)); }, &text);
    };
    EXPECT_EQ(codeOf(std::errc::resource_unavailable_try_again), 5);
    EXPECT_NE(text.find("no thread can be started"), std::string::npos) << text;
    EXPECT_EQ(codeOf(std::errc::io_error), 1);
    EXPECT_NE(text.find("internal error"), std::string::npos) << text;
}

TEST_F(BadInput, explainRefusesWhatTheRenderWould) {
    expectRefusal(run({"box.obj", "--explain", "--buckets", "900:901", "-o", "p.pmpart"}), 2,
                  {"--buckets", "900:901", "within the 300 buckets"});
    const Outcome good = run({"box.obj", "--explain", "--buckets", "299:300", "-o", "p.pmpart"});
    EXPECT_EQ(good.exitCode, 0) << good.err;
    EXPECT_NE(good.out.find("memory: "), std::string::npos);
    EXPECT_NE(good.out.find(" GiB at a time\n"), std::string::npos) << good.out;
    EXPECT_EQ(good.out.find("would be refused"), std::string::npos) << good.out;
    EXPECT_NE(run({"box.obj", "--explain", "--memory-limit", "0.01"}).out.find("would be refused"),
              std::string::npos);
}

// Names come from files, and may hold what a terminal obeys.
TEST_F(BadInput, controlCharactersOfNamesAreNotPrinted) {
    write("evil.obj", kTriangle + "usemtl a\x1b[31m\x07\x7f\tb\nf 1 2 3\n");
    const Outcome outcome = run({"evil.obj", "--size", "8x8", "--passes", "1", "--log", "log"});
    EXPECT_NE(outcome.err.find("'a\\x1b[31m\\x07\\x7f b'"), std::string::npos) << outcome.err;
    for (const std::string& text : {outcome.err, readText(path("log"))})
        EXPECT_EQ(text.find_first_of("\x1b\x07\x7f"), std::string::npos) << text;
}

TEST_F(BadInput, aRangeIsToldByTheHost) {
    expectRefusal(run({"box.obj", "--threads", "3000"}), 2, {"--threads '3000'", "[0, 1024]"});
}

TEST_F(BadInput, statisticsAreWrittenOnFailureToo) {
    write("bad.obj", kTriangle + "f 1 2 4\n");
    const Outcome outcome = run({"bad.obj", "--stats", "stats.json"});
    EXPECT_EQ(outcome.exitCode, 3);
    const auto json = nlohmann::json::parse(readText(path("stats.json")));
    EXPECT_EQ(json.at("schema"), "pm-stats/1");
    EXPECT_EQ(json.at("exitCode"), 3);
    EXPECT_EQ(json.at("stopReason"), "failed");
    EXPECT_EQ(json.at("error"), "bad.obj:4: face refers to vertex 4 of 3");
    EXPECT_EQ(json.at("commandLine").at(1), "bad.obj");
    EXPECT_EQ(run({"none.obj", "--stats", "none.json"}).exitCode, 4);
    EXPECT_EQ(nlohmann::json::parse(readText(path("none.json"))).at("exitCode"), 4);
}

}  // namespace
}  // namespace pm::host::test
