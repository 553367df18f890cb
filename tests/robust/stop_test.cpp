// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// --error-target and --time-limit of the real pm_host: exit 0, the reason in the statistics, and
// the picture of so many passes.
#include <nlohmann/json.hpp>

#include "host_shim/pictures/picture_io.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Stop : public HostProcess {
  protected:
    // A small render of the box to NAME.exr; statistics go to NAME.json.
    nlohmann::json render(const std::string& name, std::vector<std::string> more) {
        std::vector<std::string> arguments{
            "box.obj", "--size", "32x24",   "--photons",    "1000", "--aa",       "2",
            "--aov",   "stderr", "--stats", name + ".json", "-o",   name + ".exr"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        m_outcome = run(arguments);
        EXPECT_EQ(m_outcome.exitCode, 0) << m_outcome.err;
        return nlohmann::json::parse(readText(path(name + ".json")));
    }
    // Of pixels and attributes alike.
    void expectSameBytes(const std::string& a, const std::string& b) const {
        EXPECT_EQ(readText(path(a + ".exr")), readText(path(b + ".exr")));
    }
    Outcome m_outcome;
};

TEST_F(Stop, errorTargetRendersUntilItIsReached) {
    const auto two = render("two", {"--passes", "2"});
    const double target = 0.3 * two.at("relMseEstimate").get<double>();
    ASSERT_GT(target, 0.0);
    const auto json = render("a", {"--error-target", std::to_string(target)});
    EXPECT_EQ(json.at("stopReason"), "error target");
    EXPECT_EQ(json.at("exitCode"), 0);
    EXPECT_LE(json.at("relMseEstimate").get<double>(), target);
    EXPECT_NE(m_outcome.err.find("stopped by the error target"), std::string::npos);
    const std::string passes = json.at("passesDone").dump();
    EXPECT_GT(std::stoi(passes), 2);
    const auto again = render("b", {"--passes", passes});
    EXPECT_EQ(again.at("stopReason"), "passes done");
    expectSameBytes("a", "b");
    EXPECT_EQ(std::get<std::string>(readExr(path("a.exr")).attributes.at("pm:passesDone")), passes);
}

TEST_F(Stop, timeLimitMakesAtLeastOnePassAndKeepsToTheTime) {
    const auto tiny = render("a", {"--time-limit", "0.000001"});
    EXPECT_EQ(tiny.at("stopReason"), "time limit");
    EXPECT_EQ(tiny.at("passesDone"), 1);
    EXPECT_TRUE(tiny.at("relMseEstimate").is_null());
    render("b", {"--passes", "1"});
    expectSameBytes("a", "b");
    const auto second = render("c", {"--time-limit", "1", "--error-target", "1e-12"});
    EXPECT_EQ(second.at("stopReason"), "time limit");
    EXPECT_GT(second.at("passesDone"), 4);
    EXPECT_LT(second.at("errorCurve").back().at("seconds").get<double>(), 3.0);
}

TEST_F(Stop, badTargetsAreRefused) {
    expectRefusal(run({"box.obj", "--error-target", "-1"}), 2, {"--error-target", "0 to"});
    expectRefusal(run({"box.obj", "--time-limit", "soon"}), 2, {"--time-limit", "soon"});
    expectRefusal(run({"box.obj", "--time-limit", "nan"}), 2, {"--time-limit"});
}

}  // namespace
}  // namespace pm::host::test
