// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// --report of the real pm_host: a page that needs no other file, for renders that end in whatever
// way, and that changes nothing of the picture.
#include "host_shim/session/report.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "host_shim/report/report_command.h"
#include "host_shim/report/report_html.h"
#include "host_shim/report/report_pictures.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

constexpr std::size_t kMostBytes = 5'000'000;

class ReportPage : public HostProcess {
  protected:
    // Whole, well-formed as XML, small, and without anything to fetch.
    std::string checkedPage(const std::string& name) const {
        const std::string page = readText(path(name));
        EXPECT_LT(page.size(), kMostBytes);
        EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
        EXPECT_TRUE(page.ends_with("</html>\n"));
        for (const char* link : {"http:", "https:", "<link", "<script", "@import", "src=\"/"})
            EXPECT_EQ(page.find(link), std::string::npos) << link;
        const std::string parse =
            "python3 -c 'import sys, xml.etree.ElementTree as e; "
            "e.parse(sys.argv[1])' '" +
            path(name).string() + "'";
        EXPECT_EQ(std::system(parse.c_str()), 0);
        return page;
    }

    static void expectSections(const std::string& page, const std::vector<std::string>& ids) {
        for (const std::string& id : ids)
            EXPECT_NE(page.find("<section id=\"" + id + "\">"), std::string::npos) << id;
    }
    static std::string between(const std::string& text, const std::string& before,
                               const std::string& after) {
        const auto begin = text.find(before);
        if (begin == std::string::npos) return {};
        const auto end = text.find(after, begin + before.size());
        return text.substr(begin + before.size(), end - begin - before.size());
    }
    static std::size_t count(const std::string& text, const std::string& part) {
        std::size_t found = 0;
        for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
            ++found;
        return found;
    }
};

TEST_F(ReportPage, showsARenderAndChangesNothingOfIt) {
    ASSERT_EQ(render({"--passes", "4", "-o", "a.exr"}).exitCode, 0);
    const Outcome outcome = render({"--passes", "4", "-o", "b.exr", "--bucket-size", "8",
                                    "--reference", "a.exr", "--report", "r.html"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(readText(path("a.exr")), readText(path("b.exr")));
    const std::string page = checkedPage("r.html");
    expectSections(page, {"status", "warnings", "command", "picture", "difference", "error",
                          "buckets", "slowest", "stderr", "levels", "brightest", "time", "memory"});
    EXPECT_NE(page.find("Done: passes done."), std::string::npos);
    EXPECT_NE(page.find("type=\"range\""), std::string::npos);
    // Picture, reference, difference, heat map of the buckets, standard error, levels.
    EXPECT_EQ(count(page, "data:image/png;base64,"), 6u);
    // 16 x 16 pixels in buckets of 8, along the Hilbert curve: each next to the one before.
    const std::string curve = between(page, "vector-effect=\"non-scaling-stroke\" points=\"", "\"");
    EXPECT_TRUE(curve == "4,4 4,12 12,12 12,4 " || curve == "4,4 12,4 12,12 4,12 ") << curve;
    EXPECT_EQ(leftFiles(), (std::vector<std::string>{"a.exr", "b.exr", "r.html"}));
}

TEST_F(ReportPage, aCommandOfItPrintsThePixelThatItNames) {
    ASSERT_EQ(render({"--crop", "2,3,14,15", "-o", "a.exr", "--report", "r.html"}).exitCode, 0);
    const std::string page = checkedPage("r.html");
    const std::string brightest = between(page, "<section id=\"brightest\">", "</section>");
    const std::string pixel = between(brightest, "<code>--only-pixel ", "</code>");
    ASSERT_FALSE(pixel.empty()) << brightest;
    const Picture picture = readExr(path("a.exr"));
    std::size_t most = 0;
    const auto& red = picture.find("R")->values;
    for (std::size_t i = 0; i < red.size(); ++i)
        if (red[i] > red[most]) most = i;
    EXPECT_EQ(pixel, std::to_string(2 + most % 12) + "," + std::to_string(3 + most / 12));
    // The light is grey, so the brightest is the reddest; words of this command need no quotes.
    std::istringstream words(between(brightest, "<pre><code>pm_host ", "</code></pre>"));
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    arguments.insert(arguments.end(), {"--only-pixel", pixel});
    const Outcome alone = run(arguments);
    ASSERT_EQ(alone.exitCode, 0) << alone.err;
    EXPECT_EQ(std::stof(between(alone.out, "R ", "\n")), red[most]) << alone.out;
    EXPECT_EQ(leftFiles(), (std::vector<std::string>{"a.exr", "r.html"}));
}

TEST_F(ReportPage, saysWhatFailed) {
    write("bad <b>.obj", "mtllib none.mtl\nv 0 0 0\nf 1 2 3\n");
    const Outcome outcome = run({"bad <b>.obj", "-q", "-o", "a.exr", "--report", "r.html"});
    EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
    const std::string page = checkedPage("r.html");
    expectSections(page, {"status", "warnings", "command", "picture", "buckets", "time"});
    EXPECT_NE(page.find("Not done: failed. Exit code 3."), std::string::npos);
    EXPECT_NE(page.find("pm_host &#39;bad &lt;b&gt;.obj&#39; -q"), std::string::npos);
    EXPECT_EQ(page.find("bad <b>"), std::string::npos);
    EXPECT_EQ(count(page, "data:image"), 0u);
    // A limit that was passed fails the render, but the picture is there.
    ASSERT_EQ(render({"-o", "a.exr"}).exitCode, 0);
    const Outcome limit = render({"--seed", "2", "-o", "b.exr", "--reference", "a.exr",
                                  "--error-limit", "0", "--report", "l.html"});
    EXPECT_EQ(limit.exitCode, 6) << limit.err;
    const std::string limitPage = checkedPage("l.html");
    EXPECT_NE(limitPage.find("Not done: error limit. Exit code 6."), std::string::npos);
    EXPECT_NE(limitPage.find("type=\"range\""), std::string::npos);
}

TEST_F(ReportPage, showsAMergeWithItsStandardError) {
    for (const char* half : {"1/2", "2/2"}) {
        const std::string part = std::string("p") + half[0] + ".pmpart";
        ASSERT_EQ(render({"--bucket-size", "8", "--buckets", half, "-o", part, "--report",
                          part + ".html"})
                      .exitCode,
                  0);
    }
    checkedPage("p1.pmpart.html");
    const Outcome merge =
        run({"merge", "p1.pmpart", "p2.pmpart", "-q", "-o", "m.exr", "--report", "m.html"});
    ASSERT_EQ(merge.exitCode, 0) << merge.err;
    const std::string page = checkedPage("m.html");
    EXPECT_NE(page.find("Done: passes done."), std::string::npos);
    // 8 x 8 pixels of one sample in each of two passes.
    EXPECT_NE(page.find("Samples a bucket. None was timed here"), std::string::npos);
    EXPECT_NE(page.find("128 samples"), std::string::npos);
    // Picture, samples, standard error, levels.
    EXPECT_EQ(count(page, "data:image/png;base64,"), 4u);
    ASSERT_EQ(render({"-o", "a.exr", "--report", "a.html"}).exitCode, 0);
    const std::string whole = checkedPage("a.html");
    for (const char* id : {"stderr", "levels", "brightest"}) {
        const auto table = [&](const std::string& text) {
            const std::string content =
                between(text, "<section id=\"" + std::string(id) + "\">", "</section>");
            return content.substr(0, content.find("A pixel alone"));
        };
        EXPECT_EQ(table(page), table(whole)) << id;
    }
}

TEST_F(ReportPage, isCheckedBeforeTheFirstRay) {
    expectRefusal(run({"box.obj", "--report", "r.txt"}), 2, {"--report 'r.txt'", ".html"});
    expectRefusal(run({"box.obj", "--report", "R.TXT"}), 2, {"--report 'R.TXT'", ".html"});
    ASSERT_EQ(render({"-o", "a.exr", "--report", "R.HTML"}).exitCode, 0);
    expectSections(checkedPage("R.HTML"), {"status", "picture"});
    fs::remove(path("R.HTML"));
    fs::remove(path("a.exr"));
    expectRefusal(run({"box.obj", "--report", "none/r.html"}), 4, {"none", "--make-output-path"});
    expectRefusal(run({"box.obj", "--report", "r.html", "--log", "./r.html"}), 2, {"twice"});
    fs::create_symlink("box.mtl", path("link.html"));
    EXPECT_EQ(run({"box.obj", "--report", "link.html"}).exitCode, 2);
    EXPECT_NE(readText(path("box.mtl")).find("newmtl"), std::string::npos);
}

TEST(ReportHtml, textsCanHoldNoTags) {
    EXPECT_EQ(escaped("<a b=\"c\">&'"), "&lt;a b=&quot;c&quot;&gt;&amp;&#39;");
    EXPECT_EQ(escaped(std::string("a\x01\x1b[31m\n\tb")), "a\\x01\\x1b[31m\n\tb");
}

// An interrupted render's reason is its error, too.
TEST(ReportHtml, theReasonIsToldOnce) {
    const std::string page =
        Report().page(R"({"stopReason": "interrupted", "error": "interrupted", "exitCode": 130})");
    EXPECT_NE(page.find("Not done: interrupted. Exit code 130. 0.00 s in all.</p>"),
              std::string::npos)
        << page;
}

// Errors of 4e-3 to 1e-3 over 1 to 4 s; a target below and a reference's error above them.
TEST(ReportHtml, plotsTheErrorOverTimeWithItsTarget) {
    const std::string curve =
        R"("errorCurve": [{"seconds": 1, "noise": 3e-3, "estimatedRelMse": 4e-3},
        {"seconds": 4, "noise": 9e-4, "estimatedRelMse": 1e-3}])";
    const std::string page = Report().page(
        "{" + curve + R"(, "settings": {"errorTarget": 2e-4}, "relMseReference": 5e-3})");
    for (const char* text :
         {">time, s</text>", ">error (relMSE), lower is better</text>", "target: 2.00e-04",
          "against the reference: 5.00e-03", "<p>Lower is better: "})
        EXPECT_NE(page.find(text), std::string::npos) << text;
    // The level lines stand where their values are on the axis from 1e-4 to 1e-2.
    const auto height = [&](const std::string& before) {
        const auto at = page.find(before);
        if (at == std::string::npos) return std::nan("");
        const auto line = page.rfind("<line", at);
        return std::stod(page.substr(page.find("y1=\"", line) + 4));
    };
    const double target = height("stroke=\"#2a7d3c\" stroke-width=\"1.5\" stroke-dasharray"),
                 reference = height("stroke=\"#b3261e\" stroke-width=\"1.5\" stroke-dasharray");
    const double decade = (320 - 54 - 12) / 2.0;  // of the chart's height
    EXPECT_NEAR(target - reference, decade * std::log10(5e-3 / 2e-4), 0.2);
    // Without a target or a reference neither has a line.
    const std::string bare = Report().page("{" + curve + "}");
    EXPECT_NE(bare.find("lower is better</text>"), std::string::npos);
    EXPECT_EQ(bare.find("stroke-dasharray"), std::string::npos);
}

TEST(ReportCommand, isReadByAShellAsItWasGiven) {
    EXPECT_EQ(shellCommand({"pm_host", "a b.obj", "it's", "", "x=$y", "--size", "8x8"}),
              "pm_host 'a b.obj' 'it'\\''s' '' 'x=$y' --size 8x8");
}

TEST(ReportCommand, ofOnePixelWritesNothing) {
    // Of -qo FILE the flag goes too: it only says less.
    const Arguments kept{"pm_host", "s.obj", "--eye", "-1,0,2", "-q", "--aov", "N"};
    const Arguments all = {
        "pm_host", "s.obj",      "-o",      "a.exr",   "--eye",      "-1,0,2",       "-ob.png",
        "-q",      "--output=d", "--stats", "s.json",  "--report=x", "--aov",        "N",
        "-qo",     "c.exr",      "--crop",  "0,0,1,1", "--resume",   "--checkpoint", "k.pmcheck"};
    EXPECT_EQ(ofOnePixel(all), kept);
    EXPECT_EQ(ofPasses({"pm_host", "s.obj", "--error-target", "1e-3", "--passes=9"}, 5),
              (Arguments{"pm_host", "s.obj", "--passes", "5"}));
}

// Noise, which no PNG makes smaller, is shrunk until it fits.
TEST(ReportPictures, fitTheirBytes) {
    DisplayPicture noise{1201, 801, 3, {}};
    std::uint32_t state = 1;
    for (int i = 0; i < noise.width * noise.height * 3; ++i) {
        state = state * 1664525u + 1013904223u;
        noise.values.push_back(static_cast<float>(state >> 8) / 16777216.0f);
    }
    const EmbeddedPicture picture = embedded(noise, 400'000);
    EXPECT_LE(picture.dataUri.size(), 400'000u);
    EXPECT_GT(picture.dataUri.size(), 200'000u);
    // 1201 x 801 x 3 x 4/3 bytes over 3^2 are 430 000; means of 9 values are a little less noisy.
    EXPECT_EQ(picture.shrunk, 3);
    EXPECT_EQ(picture.width, 1201);
    EXPECT_LE(picture.shownWidth, 1068);
}

TEST(ReportPictures, heatMapsShowTheirEndsAndWhatIsNotFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Plane plane{4, 1, {-1.0f, 0.0f, 5.0f, nan}};
    const DisplayPicture picture = heatMap(plane, 0, 4);
    const std::vector<float>& v = picture.values;
    ASSERT_EQ(v.size(), 12u);
    EXPECT_TRUE(std::equal(v.begin(), v.begin() + 3, v.begin() + 3));
    EXPECT_NEAR(v[3], 0x44 / 255.0, 1e-6);
    EXPECT_NEAR(v[6], 0xfd / 255.0, 1e-6);
    EXPECT_GT(v[9], 0.8f);
    EXPECT_LT(v[10], 0.2f);
    EXPECT_EQ(quantile(plane, 1), 5.0f);
    EXPECT_EQ(quantile(plane, 0), -1.0f);
    EXPECT_EQ(quantile({1, 1, {nan}}, 0.5), 0.0f);
}

}  // namespace
}  // namespace pm::host::test
