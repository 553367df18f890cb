// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Outputs of the real pm_host: checked before the first ray, whole under their names, the same in
// any locale.
#include <nlohmann/json.hpp>

#include "host_shim/pictures/image_output.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/values/host_error.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Outputs : public HostProcess {};

TEST_F(Outputs, areCheckedBeforeTheFirstRay) {
    expectRefusal(run({"box.obj", "-o", "none/a.exr"}), 4, {"none", "--make-output-path"});
    expectRefusal(run({"box.obj", "-o", "a.gif"}), 2, {"a.gif", ".exr"});
    expectRefusal(run({"box.obj", "-o", "a.png", "-o", "./a.png"}), 2, {"twice"});
    expectRefusal(run({"box.obj", "--stats", "box.obj"}), 2, {"box.obj", "input"});
    expectRefusal(run({"box.obj", "--log", "box.mtl"}), 2, {"box.mtl", "input", ".log"});
    fs::create_symlink("box.mtl", path("innocent.log"));
    const Outcome link = run({"box.obj", "--stats", "innocent.log"});
    EXPECT_EQ(link.exitCode, 2) << link.err;
    fs::create_directory(path("folder.exr"));
    const Outcome folder = run({"box.obj", "-o", "folder.exr"});
    EXPECT_EQ(folder.exitCode, 4) << folder.err;
    expectRefusal(run({"box.obj", "-o", "/proc/a.png"}), 4, {"/proc/a.png"});
    expectRefusal(run({"box.obj", "-o", "/dev/null"}), 2, {"/dev/null"});
    expectRefusal(run({"box.obj", "--stats", "none/s.json"}), 4, {"none"});
    EXPECT_NE(readText(path("box.obj")).find("mtllib"), std::string::npos);
    EXPECT_NE(readText(path("box.mtl")).find("newmtl"), std::string::npos);
}

TEST_F(Outputs, areWrittenWithTheirLayersAndMessages) {
    const Outcome outcome =
        run({"box.obj", "--size", "16x16", "--aa", "2", "--photons", "1000", "-o", "new/a b.exr",
             "-o", "b.png", "--make-output-path", "--aov", "albedo,N,Z", "--stats", "s.json"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("wrote new/a b.exr, estimated relMSE "), std::string::npos)
        << outcome.err;
    const Picture picture = readExr(path("new/a b.exr"));
    for (const char* name :
         {"R", "A", "direct.R", "indirect.G", "caustic.B", "emission.R", "albedo.R", "N.X", "Z"}) {
        EXPECT_NE(picture.find(name), nullptr) << name;
    }
    EXPECT_EQ(std::get<std::int32_t>(picture.attributes.at("pm:complete")), 1);
    EXPECT_TRUE(fs::exists(path("b.png")));
    EXPECT_EQ(leftFiles(), (std::vector<std::string>{"b.png", "new", "s.json"}));
    const auto json = nlohmann::json::parse(readText(path("s.json")));
    EXPECT_EQ(json.at("outputs").size(), 2u);
    EXPECT_EQ(json.at("exitCode"), 0);
    EXPECT_EQ(json.at("stopReason"), "passes done");
    EXPECT_TRUE(json.at("relMseEstimate").is_number());
}

TEST_F(Outputs, texturesChangeThePictureAndLeaveNothing) {
    addTexture();
    const Outcome outcome = render({"-o", "a.exr", "--aov", "albedo"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(textureFolder(), "");
    // Code 128 of 255 in sRGB is 0.216 in linear light.
    const Picture picture = readExr(path("a.exr"));
    EXPECT_NEAR(picture.find("albedo.R")->values[8 * 16 + 8], 0.216f, 0.01f);
    fs::remove(path("wall.png"));
    const Outcome missing = render({"-o", "b.exr"});
    EXPECT_EQ(missing.exitCode, 0) << missing.err;
    EXPECT_NE(missing.err.find("wall.png"), std::string::npos) << missing.err;
    expectRefusal(run({"box.obj", "-o", "wall.png"}), 2, {"wall.png", "input"});
}

TEST_F(Outputs, theSameBytesTwiceAndInAnyLocale) {
    ASSERT_EQ(render({"-o", "a.exr"}).exitCode, 0);
    const std::string first = readText(path("a.exr"));
    const Outcome comma = run({"box.obj", "--size", "16x16", "--passes", "2", "--photons", "1000",
                               "--aa", "2", "-q", "-o", "a.exr", "--threads", "1"},
                              nullptr, {{"LC_ALL", "de_DE.UTF-8"}});
    ASSERT_EQ(comma.exitCode, 0) << comma.err;
    EXPECT_EQ(readText(path("a.exr")), first);
}

// OpenColorIO would take another default view from this variable.
TEST_F(Outputs, foreignVariablesChangeNothing) {
    const std::vector<std::string> arguments = {"box.obj", "--size", "16x16", "--passes",
                                                "1",       "-q",     "-o",    "x.png"};
    ASSERT_EQ(run(arguments).exitCode, 0);
    const std::string before = readText(path("x.png"));
    const Outcome outcome = run(arguments, nullptr, {{"OCIO_ACTIVE_VIEWS", "raw"}});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(readText(path("x.png")), before);
}

TEST_F(Outputs, resultsGoToStandardOutputOnly) {
    EXPECT_NE(run({"--list", "settings"}).out.find("bucketOrder"), std::string::npos);
    EXPECT_EQ(run({"--list", "orders"}).out,
              "hilbert\nrow\ncolumn\ndiagonal\nspiral\nrandom\ncorrelated\n");
    EXPECT_NE(run({"-h"}).out.find("--bucket-order"), std::string::npos);
    EXPECT_NE(run({"box.obj", "--explain"}).out.find("photons"), std::string::npos);
    const Outcome pixel = render({"--only-pixel", "8,8", "--stats", "-"});
    EXPECT_TRUE(pixel.out.starts_with("R ")) << pixel.out;
    EXPECT_NE(pixel.out.find("\"pm-stats/1\""), std::string::npos);
    EXPECT_EQ(pixel.err, "");
    EXPECT_TRUE(leftFiles().empty());
}

TEST_F(Outputs, onePixelAloneHasTheValueOfTheWhole) {
    ASSERT_EQ(render({"-o", "a.exr"}).exitCode, 0);
    const Picture picture = readExr(path("a.exr"));
    const Outcome pixel = render({"--only-pixel", "9,7"});
    float red = -1;
    std::istringstream(pixel.out.substr(2)) >> red;
    EXPECT_EQ(red, picture.find("R")->values[7 * 16 + 9]);
}

// What is wrong with options together is told by the option's name, too.
TEST_F(Outputs, refusedSettingsNameTheirOption) {
    expectRefusal(render({"--bucket-size", "8", "--buckets", "0:99", "-o", "a.pmpart"}), 2,
                  {"--buckets: setting buckets is '0:99'", "within the 4 buckets of the picture"});
    expectRefusal(render({"--only-pixel", "16,3"}), 2, {"--only-pixel '16,3'", "X from 0 to 15"});
}

TEST_F(Outputs, aRenderWithNothingToResumeSaysSo) {
    std::vector<std::string> arguments{
        "box.obj", "--size", "8x8",          "--passes", "1",  "--photons", "100",
        "--aa",    "1",      "--checkpoint", "c",        "-o", "a.exr",     "--keep-checkpoint"};
    const std::string line = "c: no checkpoint was there to resume; the render begins anew";
    const Outcome notAsked = run(arguments);
    EXPECT_EQ(notAsked.exitCode, 0) << notAsked.err;
    EXPECT_EQ(notAsked.err.find(line), std::string::npos) << notAsked.err;
    arguments.push_back("--resume");
    const Outcome there = run(arguments);
    EXPECT_EQ(there.exitCode, 0) << there.err;
    EXPECT_EQ(there.err.find(line), std::string::npos) << there.err;
    fs::remove(path("c"));
    const Outcome none = run(arguments);
    EXPECT_EQ(none.exitCode, 0) << none.err;
    EXPECT_NE(none.err.find(line), std::string::npos) << none.err;
}

// Runs PM_HOST by a shell, in the folder.
int shell(const fs::path& folder, const std::string& arguments) {
    return std::system(
        ("cd '" + folder.string() + "' && '" PM_HOST "' box.obj --size 8x8 " + arguments).c_str());
}

TEST_F(Outputs, closedDescriptorsTakeNoFile) {
    EXPECT_EQ(shell(m_folder,
                    "--passes 2 --photons 1000 -o a.exr --checkpoint c --keep-checkpoint "
                    "--log l --stats s <&- >&- 2>&-"),
              0);
    EXPECT_EQ(readText(path("c")).find("Progress"), std::string::npos);
    EXPECT_NO_THROW(readExr(path("a.exr")));
    EXPECT_TRUE(nlohmann::json::parse(readText(path("s"))).is_object());
    // Of results that go nowhere the exit code tells.
    EXPECT_EQ(shell(m_folder, "--explain >&- 2>&-"), 4 << 8);
}

TEST_F(Outputs, aLogThatCannotBeWrittenIsTold) {
    // Files of 0 blocks: what a full disk does.
    EXPECT_EQ(std::system(("cd '" + m_folder.string() +
                           "' && (ulimit -f 0; '" PM_HOST
                           "' box.obj --size 8x8 --explain --log l >/dev/null 2>/dev/null)")
                              .c_str()),
              4 << 8);
    EXPECT_FALSE(fs::exists(path("l")));
    EXPECT_EQ(std::system(("cd '" + m_folder.string() +
                           "' && (ulimit -f 0; '" PM_HOST
                           "' box.obj --size 8x8 --explain --log l --stats - 2>/dev/null)"
                           " | grep -q '\"exitCode\": 4'")
                              .c_str()),
              0);
}

// Libraries that run out of memory say nothing.
TEST_F(Outputs, aWriterThatGivesNoReasonIsNotQuoted) {
    const OIIO::ImageSpec spec(4, 4, 3, OIIO::TypeDesc::FLOAT);
    try {
        writeImage(path("a.exr"), spec, [](OIIO::ImageOutput&) { return false; });
        ADD_FAILURE() << "written";
    } catch (const HostError& error) {
        EXPECT_EQ(error.exitCode(), 4);
        EXPECT_EQ(error.what(),
                  path("a.exr").string() +
                      ": can't be written: its library gives no reason; memory may be lacking");
    }
    EXPECT_TRUE(leftFiles().empty());
}

TEST_F(Outputs, errorLimit) {
    ASSERT_EQ(render({"-o", "a.exr"}).exitCode, 0);
    const Outcome same = render({"-o", "b.exr", "--reference", "a.exr", "--error-limit", "0"});
    EXPECT_EQ(same.exitCode, 0) << same.err;
    EXPECT_EQ(same.out, "relMSE 0\n");
    const Outcome other =
        render({"-o", "b.exr", "--reference", "a.exr", "--error-limit", "1e-9", "--seed", "2"});
    EXPECT_EQ(other.exitCode, 6) << other.err;
    EXPECT_TRUE(fs::exists(path("b.exr")));
    expectRefusal(run({"box.obj", "--size", "16x16", "--reference", "a.exr", "-o", "a.exr"}), 2,
                  {"a.exr", "input"});
}

TEST_F(Outputs, progressForProgramsGoesLineByLine) {
    const Outcome alf = render({"--progress", "alf"});
    EXPECT_NE(alf.out.find("ALF_PROGRESS 100%\n"), std::string::npos) << alf.out;
    const Outcome json = render({"--progress", "json"});
    const std::string line = json.err.substr(0, json.err.find('\n'));
    EXPECT_TRUE(nlohmann::json::parse(line).contains("remaining_seconds")) << json.err;
}

TEST_F(Outputs, PartialPicturesReplaceOnlyTheirOwn) {
    EXPECT_EQ(partialName(path("a.exr")), path("a.partial.exr"));
    write("a.partial.exr", "somebody's");
    EXPECT_EQ(partialName(path("a.exr")), path("a.partial.2.exr"));
    write("a.partial.2.exr", "v/1 with pm:complete in its head");
    EXPECT_EQ(partialName(path("a.exr")), path("a.partial.2.exr"));
    fs::create_symlink("nowhere", path("b.partial.png"));
    EXPECT_EQ(partialName(path("b.png")), path("b.partial.2.png"));
}

}  // namespace
}  // namespace pm::host::test
