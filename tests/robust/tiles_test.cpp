// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Pictures that don't fit into the memory limit, by the real pm_host: in tiles, with the pixels of
// the whole, within the limit; and what can't be done so is refused with what it would need.
#include <OpenImageIO/imageio.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Tiles : public HostProcess {
  protected:
    void SetUp() override {
        HostProcess::SetUp();
        // In one plane, so without maps: what is left is what goes with pixels.
        write("flat.obj",
              "mtllib box.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 -1 0\nv 0 1 0\n"
              "usemtl light\nf 1 5 6 4\nusemtl wall\nf 5 2 3 6\n");
    }
    static std::vector<std::string> large(std::vector<std::string> more) {
        std::vector<std::string> arguments{"flat.obj", "--size", "1024x1024", "--aa", "1",
                                           "--passes", "2",      "--threads", "2",    "-q",
                                           "--eye",    "0,0,3",  "--look-at", "0,0,0"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    nlohmann::json json(const std::string& name) const {
        return nlohmann::json::parse(readText(path(name)));
    }
    static void expectSamePicture(const Picture& wanted, const Picture& found) {
        EXPECT_EQ(wanted.width, found.width);
        EXPECT_EQ(wanted.dataWindow, found.dataWindow);
        ASSERT_EQ(wanted.channels.size(), found.channels.size());
        for (std::size_t c = 0; c < wanted.channels.size(); ++c) {
            EXPECT_EQ(wanted.channels[c].name, found.channels[c].name);
            const auto &a = wanted.channels[c].values, &b = found.channels[c].values;
            ASSERT_EQ(a.size(), b.size());
            EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0)
                << wanted.channels[c].name;
        }
        Attributes attributes = found.attributes;
        for (const auto& [name, value] : wanted.attributes) {
            ASSERT_TRUE(attributes.contains(name)) << name;
            EXPECT_EQ(attributes[name], value) << name;
        }
    }
};

TEST_F(Tiles, HoldThePixelsOfTheWhole) {
    const std::vector<std::string> scene{
        "box.obj", "--size",   "432x288", "--photons",    "2000",
        "-q",      "--passes", "3",       "--aov",        "Z,samples,stderr,aalevel",
        "--aa",    "1:2",      "--crop",  "8,16,421,277", "--bucket-size",
        "16"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), scene.begin(), scene.end());
        return run(more);
    };
    ASSERT_EQ(with({"-o", "whole.exr"}).exitCode, 0);
    ASSERT_EQ(with({"--stats", "s.json", "-o", "half.exr", "--exr-half"}).exitCode, 0);
    EXPECT_EQ(json("s.json")["delivery"], "frame");
    const auto need = json("s.json")["memory"];
    // A limit that the frame doesn't fit in, and the maps of three passes and a few buckets do.
    const double bytes = need["sceneBytes"].get<double>() +
                         0.85 * need["frameBytes"].get<double>() +
                         need["plannedMapBytes"].get<double>() + need["processBytes"].get<double>();
    const std::string limit = std::to_string(bytes / 1073741824);
    for (const char* threads : {"1", "3"}) {
        const std::string name = std::string("tiles") + threads + ".exr";
        const Outcome outcome = with({"--memory-limit", limit, "--threads", threads, "-o", name,
                                      "--stats", "t.json", "-o", std::string("h") + name});
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(json("t.json")["delivery"], "buckets");
        EXPECT_TRUE(json("t.json")["relMseEstimate"].is_number());
    }
    expectSamePicture(readExr(path("whole.exr")), readExr(path("tiles1.exr")));
    EXPECT_EQ(readText(path("tiles1.exr")), readText(path("tiles3.exr")));
    EXPECT_EQ(readText(path("tiles1.exr")), readText(path("htiles1.exr")));
    const auto input = OIIO::ImageInput::open(path("tiles1.exr").string());
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().tile_width, 16);
    EXPECT_EQ(input->spec().tile_height, 16);
    EXPECT_EQ(input->spec().get_int_attribute("pm:complete"), 1);
}

TEST_F(Tiles, TakeLittleMemory) {
    ASSERT_EQ(run(large({"--size", "64x64", "-o", "small.exr", "--stats", "small.json"})).exitCode,
              0);
    const Outcome outcome = run(large({"--memory-limit", "0.3", "-o", "a.exr", "--exr-half",
                                       "--stats", "s.json", "--bucket-size", "64"}));
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto memory = json("s.json")["memory"];
    EXPECT_EQ(json("s.json")["delivery"], "buckets");
    // The frame alone would take 0.25 GiB. What a picture of 64 x 64 takes is the program itself.
    const double more = memory["peakResidentBytes"].get<double>() -
                        json("small.json")["memory"]["peakResidentBytes"].get<double>();
    EXPECT_LT(more, 0.1 * 1073741824);
    EXPECT_LT(memory["peakResidentBytes"].get<double>(), 0.3 * 1073741824);
}

TEST_F(Tiles, RefuseWhatNeedsTheWhole) {
    const std::vector<std::string> limit{"--memory-limit", "0.3"};
    const auto refused = [&](std::vector<std::string> more, int code,
                             const std::vector<std::string>& parts) {
        more.insert(more.end(), limit.begin(), limit.end());
        expectRefusal(run(large(more)), code, parts);
    };
    const std::vector<std::string> needs{"GiB (scene", "the memory limit is 0.30 GiB"};
    const auto and_ = [&](const std::string& text) {
        std::vector<std::string> parts = needs;
        parts.push_back(text);
        return parts;
    };
    refused({"-o", "a.png"}, 5, and_("-o a.png needs the whole picture at once"));
    refused({"-o", "a.tif", "-o", "b.exr"}, 5, and_("-o a.tif"));
    refused({"-o", "a.exr", "--crop", "4,0,1024,1024"}, 5, and_("--crop from 4,0"));
    refused({"-o", "a.exr", "--checkpoint", "a.pmcheck"}, 5, and_("checkpoint"));
    refused({"-o", "a.exr", "--passes", "9"}, 5, and_("more than 8 passes"));
    refused({"-o", "a.exr", "--time-limit", "1"}, 5, and_("timeLimitSeconds"));
    refused({"-o", "a.exr", "--error-target", "0.1"}, 5, and_("errorTarget"));
    refused({"--buckets", "1/2", "-o", "a.pmpart"}, 5, and_("buckets"));
    const Outcome explained = run(large({"--memory-limit", "0.3", "--explain"}));
    EXPECT_EQ(explained.exitCode, 0);
    EXPECT_NE(explained.out.find("bucket by bucket"), std::string::npos) << explained.out;
}

TEST_F(Tiles, LeaveAPartialPictureWhenInterrupted) {
    const Outcome outcome =
        run(large({"--memory-limit", "0.3", "-o", "a.exr", "--aa", "4", "--progress", "plain",
                   "--stats", "s.json"}),
            [this](pid_t child) {
                for (int tries = 0; tries < 2000; ++tries) {
                    for (const auto& entry : fs::directory_iterator(path("")))
                        if (entry.path().filename().string().starts_with("a.exr.tmp") &&
                            fs::file_size(entry.path()) > 50'000)
                            tries = 2000;
                    usleep(5000);
                }
                ::kill(child, SIGINT);
            });
    EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
    EXPECT_FALSE(fs::exists(path("a.exr")));
    const Picture picture = readExr(path("a.partial.exr"));
    EXPECT_EQ(std::get<std::int32_t>(picture.attributes.at("pm:complete")), 0);
    const std::vector<float>& alpha = picture.find("A")->values;
    EXPECT_GT(std::count(alpha.begin(), alpha.end(), 1.0f), 0);
    EXPECT_GT(std::count(alpha.begin(), alpha.end(), 0.0f), 200'000);
    // What its finished buckets have is not the picture's error.
    for (const char* key : {"relMseEstimate", "relMseEstimateNoise", "relMseEstimateBias"})
        EXPECT_TRUE(json("s.json")[key].is_null()) << key;
    EXPECT_EQ(leftFiles(), (std::vector<std::string>{"a.partial.exr", "flat.obj", "s.json"}));
}

}  // namespace
}  // namespace pm::host::test
