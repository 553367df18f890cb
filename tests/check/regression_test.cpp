// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Our own scenes against their references: scenes/regression, see the README there.
#include <cstdlib>
#include <iostream>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Regression : public HostProcess {
  protected:
    void expectRight(const std::string& suite) {
        const Outcome outcome = run(
            {"check", std::string(PM_SOURCE_DIR) + "/scenes/regression/" + suite, "--jobs", "2"});
        EXPECT_EQ(outcome.exitCode, 0) << outcome.out << outcome.err;
        std::cout << outcome.out;
    }
    const std::string m_suites = std::string(PM_SOURCE_DIR) + "/scenes/regression/";
};

TEST_F(Regression, Suite) {
    expectRight("suite.json");
}

// No alarm where only the seed is another. PM_SUITES=N in the environment: N whole suites.
TEST_F(Regression, OtherSeeds) {
    const char* const asked = std::getenv("PM_SUITES");
    const int suites = asked != nullptr ? std::atoi(asked) : 1;
    for (int i = 0; i < suites; ++i) {
        std::vector<std::string> words{"check",  m_suites + "suite.json", "--jobs", "2",
                                       "--seed", std::to_string(5000 + i)};
        if (asked == nullptr)
            words.insert(words.end(), {"--only", "cornell_box_path,no_lamp,smooth_ball,shot_a"});
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.out << outcome.err;
        EXPECT_EQ(outcome.out.find("same bits"), std::string::npos) << outcome.out;
    }
}

TEST_F(Regression, AcesConfig) {
    if (!fs::exists(fs::path(PM_SHARED_DATA) / "ocio" / "builtin"))
        GTEST_SKIP() << "no shared data";
    expectRight("suite_aces.json");
}

}  // namespace
}  // namespace pm::host::test
