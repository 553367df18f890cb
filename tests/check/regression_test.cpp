// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Our own scenes against their references: scenes/regression, see the README there.
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
};

TEST_F(Regression, Suite) {
    expectRight("suite.json");
}

TEST_F(Regression, AcesConfig) {
    if (!fs::exists(fs::path(PM_SHARED_DATA) / "ocio" / "builtin"))
        GTEST_SKIP() << "no shared data";
    expectRight("suite_aces.json");
}

}  // namespace
}  // namespace pm::host::test
