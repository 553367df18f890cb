// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/scene/host_test.h"

#include <fmt/format.h>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {

Arguments operator+(Arguments left, const Arguments& right) {
    left.insert(left.end(), right.begin(), right.end());
    return left;
}

std::string cropText(const PixelRect& crop) {
    return fmt::format("{},{},{},{}", crop.x0, crop.y0, crop.x1, crop.y1);
}

void HostTest::SetUp() {
    clearColourEnvironment();
    HostProcess::SetUp();
}

Picture HostTest::renderExr(const std::string& name, const Arguments& arguments,
                            const std::vector<std::pair<std::string, std::string>>& variables) {
    const std::string file = name + ".exr";
    const Outcome outcome = run(arguments + Arguments{"-o", file, "-q"}, nullptr, variables);
    m_warnings = outcome.err;
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    if (outcome.exitCode != 0) return {};
    return readExr(path(file));
}

std::string ownScene(const std::string& name) {
    return fmt::format("{}/scenes/{}/{}.obj", PM_SOURCE_DIR, name, name);
}

}  // namespace pm::host::test
