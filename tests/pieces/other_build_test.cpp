// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Pieces of a picture are of one build of the library: another one may draw other samples, allot
// them by another rule, keep sums in another order, and nothing else in a file would show it.
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class OtherBuild : public HostProcess {
  protected:
    // A copy of the library that says of itself that it is of another build.
    void SetUp() override {
        HostProcess::SetUp();
        std::string library = readText(fs::path(PM_HOST).parent_path() / "libpm_plugin.so");
        // The note's sizes (name 4, id 20 or 16), its type, its name; then the id.
        using namespace std::string_literals;
        std::size_t note = std::string::npos;
        for (const std::string& size : {"\x14\0\0\0"s, "\x10\0\0\0"s})
            note = std::min(note, library.find("\4\0\0\0"s + size + "\3\0\0\0GNU\0"s));
        if (note == std::string::npos) GTEST_SKIP() << "the library has no build id";
        library[note + 16] ^= 1;
        write("other.so", library);
    }
    Outcome adaptive(std::vector<std::string> more) const {
        more.insert(more.begin(), {"--aa", "1:4", "--bucket-size", "8"});
        return render(std::move(more));
    }
    // The run is refused, and says which builds these are.
    void expectRefusedBuild(const Outcome& outcome) const {
        EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
        EXPECT_NE(outcome.err.find("build ("), std::string::npos) << outcome.err;
        EXPECT_FALSE(fs::exists(path("b.exr")));
    }
};

TEST_F(OtherBuild, DoesNotResumeACheckpoint) {
    const Outcome made =
        adaptive({"-o", "a.exr", "--checkpoint", "c", "--keep-checkpoint", "--plugin", "other.so"});
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const std::string before = readText(path("c"));
    expectRefusedBuild(adaptive({"-o", "b.exr", "--checkpoint", "c", "--resume"}));
    EXPECT_TRUE(before == readText(path("c")));
    const Outcome same =
        adaptive({"-o", "b.exr", "--checkpoint", "c", "--resume", "--plugin", "other.so"});
    EXPECT_EQ(same.exitCode, 0) << same.err;
}

TEST_F(OtherBuild, DoesNotMergeParts) {
    const Outcome first = adaptive({"--buckets", "1/2", "-o", "p1.pmpart"});
    ASSERT_EQ(first.exitCode, 0) << first.err;
    ASSERT_EQ(adaptive({"--buckets", "2/2", "-o", "p2.pmpart", "--plugin", "other.so"}).exitCode,
              0);
    expectRefusedBuild(run({"merge", "p1.pmpart", "p2.pmpart", "-o", "b.exr", "-q"}));
}

}  // namespace
}  // namespace pm::host::test
