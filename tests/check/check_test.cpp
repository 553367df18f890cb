// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// pm_host check on suites of one or two small scenes.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host_shim/check/reference.h"
#include "host_shim/check/scene_check.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

void brighten(Picture& picture, const PixelRect& rect, float factor) {
    for (const char* name : {"R", "G", "B"})
        for (Channel& channel : picture.channels) {
            if (channel.name != name) continue;
            for (std::int32_t y = rect.y0; y < rect.y1; ++y)
                for (std::int32_t x = rect.x0; x < rect.x1; ++x)
                    channel.values[static_cast<std::size_t>(y * picture.width + x)] *= factor;
        }
}

class Check : public HostProcess {
  protected:
    void SetUp() override {
        HostProcess::SetUp();
        write("suite.json", suiteOf({"plain"}));
    }
    static std::string suiteOf(const std::vector<std::string>& names,
                               const std::string& more = "\"display\": true") {
        std::string scenes;
        for (const std::string& name : names)
            scenes += fmt::format("{}{{\"name\": \"{}\", \"scene\": \"box.obj\", {}}}",
                                  scenes.empty() ? "" : ", ", name, more);
        return fmt::format(
            "{{\"schema\": \"pm-suite/1\", \"options\": [\"--size\", \"32x32\", \"--passes\", "
            "\"24\", "
            "\"--photons\", \"1000\", \"--aa\", \"2\", \"--exposure\", \"-2\"], \"scenes\": [{}]}}",
            scenes);
    }
    Outcome check(std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {"check", "suite.json"});
        return run(more);
    }
    // Once for all tests: it is 17 renders.
    void makeReferences() const {
        static const fs::path& kept = *new fs::path(m_folder.string() + "_references");
        if (!fs::exists(kept)) {
            const Outcome made = check({"--update", "--because", "The first.", "--jobs", "2"});
            ASSERT_EQ(made.exitCode, 0) << made.out << made.err;
            fs::copy(path("references"), kept);
            std::atexit([] {
                std::error_code ignored;
                fs::remove_all(kept, ignored);
            });
        } else {
            fs::copy(kept, path("references"));
        }
    }
    // The reference is then of another build.
    void pretendOtherBuild(const std::string& name) const {
        const fs::path file = path("references") / (name + ".exr");
        Picture picture = readExr(file);
        picture.attributes["pm:build"] = std::string("another");
        writeExr(file, picture);
    }
    static void expectHas(const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
    }
};

TEST_F(Check, MissingReferencesAreThree) {
    const Outcome outcome = check();
    EXPECT_EQ(outcome.exitCode, 3) << outcome.out << outcome.err;
    expectHas(outcome.out, "plain: NO REFERENCE");
    expectHas(outcome.out, "references/plain.exr");
}

TEST_F(Check, UntouchedIsZeroAndTheBrightenedBlockIsNamed) {
    makeReferences();
    const Outcome same = check();
    EXPECT_EQ(same.exitCode, 0) << same.out << same.err;
    expectHas(same.out, "plain: same bits");
    // Other seeds, so other bits: still right.
    for (int seed = 2; seed < 5; ++seed) {
        const Outcome other = check({"--seed", std::to_string(seed)});
        EXPECT_EQ(other.exitCode, 0) << seed << other.out << other.err;
        expectHas(other.out, "plain: within noise (furthest region at");
        expectHas(other.out, "found are regions from ");
        expectHas(other.out, "note: the noise is not the reference's");
    }
    const fs::path file = path("references") / "plain.exr";
    Picture picture = readExr(file);
    brighten(picture, {16, 16, 32, 32}, 1.02f);
    writeExr(file, picture);
    const Outcome edited = check();
    EXPECT_EQ(edited.exitCode, 6);
    expectHas(edited.out, "plain: DIFFERENT");
    expectHas(edited.out, "region 16,16 to 32,32");
    fs::remove(file);
    EXPECT_EQ(check().exitCode, 3);
}

// What the scene itself does: a wall that reflects 5 % more.
TEST_F(Check, AChangeOfTheSceneIsFound) {
    makeReferences();
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.525 0.5 0.5\n");
    const Outcome changed = check();
    EXPECT_EQ(changed.exitCode, 6) << changed.out;
    expectHas(changed.out, "input: the scene's input changed; region");
    expectHas(changed.out, "changed are: material wall\n");
    expectHas(changed.out, "pair: region");
    expectHas(changed.out, "R is ");
    expectHas(changed.out, "% brighter");
    expectHas(changed.out, "standard errors (limit");
}

// Far less than what seeds differ by; never within noise, whatever it is.
TEST_F(Check, AnotherInputIsAFindingHoweverSmall) {
    makeReferences();
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.50001 0.5 0.5\n");
    const Outcome changed = check();
    EXPECT_EQ(changed.exitCode, 6) << changed.out;
    expectHas(changed.out, "plain: DIFFERENT");
    expectHas(changed.out, "input: the scene's input changed; region");
    expectHas(changed.out, "changed are: material wall\n");
    EXPECT_EQ(changed.out.find("within noise"), std::string::npos);
}

// Another build has other bits. Its noise is the reference's still, so 2 % of the lamp are found,
// and rounding is not.
TEST_F(Check, PairsSeeWhatSeedsDoNot) {
    makeReferences();
    pretendOtherBuild("plain");
    const Outcome twin = check({"--junit", "junit.xml"});
    EXPECT_EQ(twin.exitCode, 0) << twin.out << twin.err;
    write("suite.json", suiteOf({"plain"}, "\"display\": true, \"options\": [\"--twin\", \"77\"]"));
    const Outcome rounded = check({"--junit", "junit.xml"});
    EXPECT_EQ(rounded.exitCode, 0) << rounded.out << rounded.err;
    expectHas(rounded.out, "plain: within noise (furthest region at");
    EXPECT_EQ(rounded.out.find("noise is not"), std::string::npos) << rounded.out;
    expectHas(readText(path("junit.xml")), "<system-out>within noise: furthest region at");
    write("suite.json", suiteOf({"plain"}));
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 4.9 4.9 4.9\nnewmtl wall\nKd 0.5 0.5 0.5\n");
    const Outcome darker = check();
    EXPECT_EQ(darker.exitCode, 6) << darker.out;
    expectHas(darker.out, "pair: region");
    expectHas(darker.out, "% darker");
    expectHas(darker.out, "note: of the input has changed: material light");
}

TEST_F(Check, ANewWarningIsAFinding) {
    makeReferences();
    write("box.mtl",
          "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.5 0.5 0.5\nmap_bump none.png\n");
    const Outcome outcome = check({"--junit", "junit.xml", "--html", "pages"});
    EXPECT_EQ(outcome.exitCode, 6) << outcome.out;
    expectHas(outcome.out, "new warning: ");
    expectHas(outcome.out, "none.png");
    expectHas(readText(path("junit.xml")), "warning: ");
    expectHas(readText(path("pages") / "index.html"), "none.png");
}

TEST_F(Check, ViewsAreOfOneRender) {
    write("suite.json", suiteOf({"plain"},
                                "\"views\": [{\"name\": \"dark\", \"options\": [\"--exposure\", "
                                "\"-3\"]}]"));
    const Outcome made = check({"--update", "--because", "Views.", "--seeds", "4"});
    ASSERT_EQ(made.exitCode, 0) << made.out << made.err;
    EXPECT_TRUE(fs::exists(path("references") / "plain.dark.png"));
    EXPECT_FALSE(fs::exists(path("references") / "plain.png"));
    EXPECT_EQ(check().exitCode, 0);
    write("suite.json", suiteOf({"plain"},
                                "\"views\": [{\"name\": \"dark\", \"options\": [\"--exposure\", "
                                "\"-2.9\"]}]"));
    const Outcome changed = check();
    EXPECT_EQ(changed.exitCode, 6) << changed.out;
    expectHas(changed.out, "display transform: view dark: ");
    fs::remove(path("references") / "plain.dark.png");
    EXPECT_EQ(check().exitCode, 3);
}

TEST_F(Check, AnotherViewIsFoundByTheDisplayPictureAlone) {
    makeReferences();
    write("suite.json",
          suiteOf({"plain"}, "\"display\": true, \"options\": [\"--exposure\", \"-1.9\"]"));
    const Outcome changed = check();
    EXPECT_EQ(changed.exitCode, 6) << changed.out;
    expectHas(changed.out, "display transform:");
    EXPECT_EQ(changed.out.find("region:"), std::string::npos) << changed.out;
}

TEST_F(Check, ReasonsAreKept) {
    const Outcome refused = check({"--update"});
    EXPECT_EQ(refused.exitCode, 2);
    expectHas(refused.err, "--because");
    makeReferences();
    ASSERT_EQ(check({"--update", "--because", "Walls are warmer.", "--seeds", "4"}).exitCode, 0);
    const Reference reference = readReference(path("references") / "plain.json");
    ASSERT_EQ(reference.reasons.size(), 2u);
    EXPECT_EQ(reference.reasons[0].because, "The first.");
    EXPECT_EQ(reference.reasons[1].because, "Walls are warmer.");
    EXPECT_EQ(reference.regions.size(), 2u);
    EXPECT_EQ(reference.regions[0].renders, 5);
}

TEST_F(Check, JUnitAndPages) {
    makeReferences();
    write("suite.json", suiteOf({"plain", "absent"}));
    const Outcome outcome = check({"--junit", "junit.xml", "--html", "pages", "--jobs", "2"});
    EXPECT_EQ(outcome.exitCode, 3) << outcome.out << outcome.err;
    const std::string junit = readText(path("junit.xml"));
    expectHas(junit, "<testsuite name=\"suite\" tests=\"2\" failures=\"1\" errors=\"0\"");
    expectHas(junit, "<testcase classname=\"suite\" name=\"absent\"");
    expectHas(junit, "<failure type=\"NO REFERENCE\"");
    const std::string index = readText(path("pages") / "index.html");
    expectHas(index, "1 of 2 scenes are right");
    expectHas(index, "href=\"scene/plain.html\"");
    expectHas(index, "data:image/png;base64,");
    const std::string page = readText(path("pages") / "scene" / "plain.html");
    expectHas(page, "the stored picture");
    expectHas(page, "The first.");
    expectHas(page, "href=\"../render/plain.html\"");
    EXPECT_TRUE(fs::exists(path("pages") / "render" / "plain.html"));
    expectHas(page, "Old: the reference.");
    const Outcome failed = check({"--failed", "junit.xml"});
    EXPECT_EQ(failed.exitCode, 3);
    expectHas(failed.out, "absent: NO REFERENCE");
    EXPECT_EQ(failed.out.find("plain:"), std::string::npos) << failed.out;
    EXPECT_EQ(check({"--failed", "suite.json"}).exitCode, 3);
    const std::string before = readText(path("suite.json"));
    EXPECT_EQ(check({"--junit", "suite.json"}).exitCode, 2);
    EXPECT_EQ(readText(path("suite.json")), before);
}

TEST_F(Check, OnlyAndTheTimeBudget) {
    write("suite.json", suiteOf({"one", "two"}));
    const Outcome one = check({"--only", "two"});
    EXPECT_EQ(one.exitCode, 3);
    EXPECT_EQ(one.out.find("one:"), std::string::npos) << one.out;
    write("suite.json", suiteOf({"one"}, "\"tags\": [\"quick\", \"box\"]"));
    expectHas(check({"--only", "tag:box"}).out, "one: NO REFERENCE");
    const Outcome untagged = check({"--only", "tag:slow"});
    EXPECT_EQ(untagged.exitCode, 2);
    expectHas(untagged.err, "its tags are quick, box");
    write("suite.json", suiteOf({"one", "two"}));
    const Outcome none = check({"--only", "three"});
    EXPECT_EQ(none.exitCode, 2);
    expectHas(none.err, "one, two");
    const Outcome late = check({"--time-budget", "0"});
    EXPECT_EQ(late.exitCode, 6);
    expectHas(late.out, "two: OUT OF TIME");
}

// What is wrong with one scene's files keeps no other from being checked, and old references whole.
TEST_F(Check, BrokenReferencesAreOfTheirSceneAlone) {
    makeReferences();
    write("suite.json", suiteOf({"broken", "plain"}));
    for (const char* ending : {".exr", ".png"})
        fs::copy(path("references") / (std::string("plain") + ending),
                 path("references") / (std::string("broken") + ending));
    write("references/broken.json", "<<<<<<< ours");
    const Outcome outcome = check({"--jobs", "2"});
    EXPECT_EQ(outcome.exitCode, 6) << outcome.out;
    expectHas(outcome.out, "broken: FAILED");
    expectHas(outcome.out, "plain: same bits");
    const std::string before = readText(path("references") / "plain.exr");
    const Outcome update = check({"--update", "--because", "Again.", "--seeds", "4"});
    EXPECT_EQ(update.exitCode, 3) << update.out;
    expectHas(update.err, "broken.json");
    EXPECT_EQ(readText(path("references") / "plain.exr"), before);
}

// The renders work in the suite's folder; the command line and the environment are of ours.
TEST_F(Check, WorksFromAnyFolder) {
    makeReferences();
    fs::create_directory(path("suite"));
    fs::rename(path("suite.json"), path("suite") / "suite.json");
    fs::rename(path("references"), path("suite") / "references");
    for (const char* file : {"box.obj", "box.mtl"}) fs::copy(path(file), path("suite") / file);
    const fs::path plugin = fs::path(PM_HOST).parent_path() / "libpm_plugin.so";
    fs::create_symlink(plugin, path("p.so"));
    const Outcome outcome = run({"check", "suite/suite.json", "--html", "pages"}, nullptr,
                                {{"PM_PLUGIN_PATH", "p.so"}});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.out << outcome.err;
    EXPECT_TRUE(fs::exists(path("pages") / "index.html"));
}

TEST_F(Check, AFailedRenderIsToldWithWhatItSaid) {
    makeReferences();
    fs::remove(path("box.obj"));
    const Outcome outcome = check();
    EXPECT_EQ(outcome.exitCode, 6);
    expectHas(outcome.out, "plain: FAILED");
    expectHas(outcome.out, "exit code 4");
    expectHas(outcome.out, "box.obj");
}

TEST_F(Check, BadSuitesAreRefused) {
    const auto refused = [&](const std::string& text, const std::string& part) {
        write("suite.json", text);
        try {
            const Suite suite = readSuite(path("suite.json"));
            for (const SuiteScene& scene : suite.scenes) checkOptions(suite, scene);
            ADD_FAILURE() << text;
        } catch (const HostError& error) {
            EXPECT_EQ(error.code(), ExitCode::kBadInput) << text;
            expectHas(error.what(), part);
            expectHas(error.what(), "suite.json");
        }
    };
    refused("{", "no JSON");
    refused("{\"schema\": \"pm-suite/2\", \"scenes\": []}", "pm-suite/1");
    refused("{\"schema\": \"pm-suite/1\", \"scenes\": []}", "at least one");
    refused(suiteOf({"a", "A"}), "twice");
    refused(suiteOf({"a b"}), "letters, digits");
    refused(suiteOf({std::string(101, 'a')}), "at most 100");
    refused(suiteOf({"a"}, "\"colour\": 1"), "no 'colour'; allowed are name, scene");
    refused(suiteOf({"a"}, "\"options\": [\"-o\", \"x.exr\"]"), "for the check itself");
    refused(suiteOf({"a"}, "\"options\": [\"-ox.exr\"]"), "not for a suite");
    refused(suiteOf({"a"}, "\"options\": [\"--explain\"]"), "not for a suite");
    refused(suiteOf({"a"}, "\"options\": [\"--frames\", \"1-3\"]"), "--frames is not for a suite");
    refused(suiteOf({"a"}, "\"options\": [\"--frames=1-3\"]"), "--frames is not for a suite");
    refused(suiteOf({"a"}, "\"options\": [\"--write-sidecar\"]"), "--write-sidecar is not for");
    refused(suiteOf({"a"}, "\"tags\": [\"a b\"]"), "'tags' are of letters");
    refused(suiteOf({"a"}, "\"views\": [{\"name\": \"v\", \"options\": [\"--aa\", \"3\"]}]"),
            "--aa is not for a view; allowed are --display");
    refused(suiteOf({"a"}, "\"views\": [{\"name\": \"v\"}, {\"name\": \"V\"}]"), "twice");
    refused(suiteOf({"a"}, "\"views\": [{\"name\": \"v\", \"options\": [\"--view\", \"no\"]}]"),
            "scene 'a', view 'v': ");
    refused(suiteOf({"a"}, "\"name\": \"b\""), "'name' is there twice");
    refused(suiteOf({"a"}, "\"options\": [], \"options\": []"), "'options' is there twice");
    refused(suiteOf({"a"}, "\"options\": [\"--checkpoint\", \"c\"]"), "not for a suite");
    refused(suiteOf({"a"}, "\"display\": true, \"options\": [\"--view\", \"none\"]"), "none");
    refused(suiteOf({"a"}, "\"options\": [\"--pases\", \"3\"]"), "--pases");
    write("suite.json", "{");
    EXPECT_EQ(check().exitCode, 3);
    EXPECT_EQ(run({"check", "none.json"}).exitCode, 4);
    EXPECT_EQ(run({"check"}).exitCode, 2);
}

}  // namespace
}  // namespace pm::host::test
