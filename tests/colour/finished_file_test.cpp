// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/finished_file.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/scratch.h"
#include "tests/colour/test_pictures.h"

namespace pm::host::test {
namespace {

class FinishedFiles : public ScratchTest {};

// While it lives, writing past that many bytes fails with EFBIG: what a full disk does, at any
// byte.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : m_handler(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &m_before);
        const rlimit limit{bytes, m_before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &m_before);
        std::signal(SIGXFSZ, m_handler);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit m_before{};
    void (*m_handler)(int);
};

DisplayPicture noisePicture() {
    DisplayPicture picture{40, 30, 3, {}};
    std::uint32_t state = 1;
    for (int i = 0; i < 3600; ++i) {
        state = state * 1664525u + 1013904223u;
        picture.values.push_back(static_cast<float>(state >> 24) / 255.0f);
    }
    return picture;
}

void writeAny(const std::filesystem::path& path) {
    if (isDisplayReferred(pictureFormat(path))) {
        writeDisplayPicture(path, noisePicture());
    } else {
        writeExr(path, gradientPicture(40, 30));
    }
}

TEST_F(FinishedFiles, AFullDiskAtAnyByteLeavesTheOldFile) {
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.tif"}) {
        writeAny(file(name));
        const auto size = std::filesystem::file_size(file(name));
        ASSERT_GT(size, 500u);
        const std::string old = "the picture of yesterday";
        writeBytes(file(name), old);
        for (std::uintmax_t limit = 0; limit < size; limit += 1 + size / 37) {
            const FileSizeLimit full(limit);
            EXPECT_TRUE(refusesWith(refusal([&] { writeAny(file(name)); }), 4, {name, "File too"}))
                << limit << " of " << size;
            EXPECT_EQ(listing(), name);
        }
        {
            const FileSizeLimit lastByte(size - 1);
            EXPECT_TRUE(refusesWith(refusal([&] { writeAny(file(name)); }), 4, {name}));
        }
        EXPECT_EQ(readBytes(file(name)), old);
        const FileSizeLimit enough(size);
        writeAny(file(name));
        EXPECT_EQ(std::filesystem::file_size(file(name)), size);
        std::filesystem::remove(file(name));
    }
}

TEST_F(FinishedFiles, TextToo) {
    writeFinishedFile(file("s.json"), "{}\n");
    EXPECT_EQ(readBytes(file("s.json")), "{}\n");
    const FileSizeLimit full(10);
    EXPECT_TRUE(
        refusesWith(refusal([&] { writeFinishedFile(file("s.json"), std::string(5000, 'x')); }), 4,
                    {"s.json", "can't be written"}));
    EXPECT_EQ(readBytes(file("s.json")), "{}\n");
    EXPECT_EQ(listing(), "s.json");
}

TEST_F(FinishedFiles, MissingAndUnwritableFolders) {
    for (const char* name : {"nowhere/a.exr", "nowhere/a.png"}) {
        EXPECT_TRUE(refusesWith(refusal([&] { writeAny(file(name)); }), 4, {"nowhere"}));
        EXPECT_TRUE(refusesWith(refusal([&] { checkWritable(file(name)); }), 4,
                                {"nowhere", "does not exist"}));
    }
    // Nobody, not even root, makes a file in there.
    EXPECT_TRUE(refusesWith(refusal([] { checkWritable("/proc/a.exr"); }), 4, {"/proc/a.exr"}));
    EXPECT_TRUE(refusesWith(refusal([] { writeAny("/proc/a.exr"); }), 4, {"/proc/a.exr"}));
    writeBytes(file("plain"), "");
    EXPECT_TRUE(
        refusesWith(refusal([&] { checkWritable(file("plain/a.exr")); }), 4, {"not a folder"}));
}

TEST_F(FinishedFiles, CheckWritableLooksAtTheNameAndLeavesNothing) {
    checkWritable(file("a.exr"));
    EXPECT_EQ(listing(), "");
    writeBytes(file("a.exr"), "old");
    checkWritable(file("a.exr"));
    EXPECT_EQ(readBytes(file("a.exr")), "old");
    std::filesystem::create_directory(file("d.exr"));
    EXPECT_TRUE(refusesWith(refusal([&] { checkWritable(file("d.exr")); }), 4, {"is a folder"}));
    ASSERT_EQ(mkfifo(file("f.png").c_str(), 0600), 0);
    EXPECT_TRUE(refusesWith(refusal([&] { checkWritable(file("f.png")); }), 4, {"regular file"}));
    EXPECT_TRUE(refusesWith(refusal([&] { checkWritable(file("a.bmp")); }), 2, {".png"}));
    EXPECT_EQ(listing(), "a.exr d.exr f.png");
}

TEST_F(FinishedFiles, PermissionsCount) {
    if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    writeBytes(file("a.exr"), "old");
    std::filesystem::permissions(file("a.exr"), std::filesystem::perms::owner_read);
    EXPECT_TRUE(refusesWith(refusal([&] { checkWritable(file("a.exr")); }), 4, {"a.exr"}));
    std::filesystem::create_directory(file("d"));
    std::filesystem::permissions(file("d"), std::filesystem::perms::owner_exec);
    EXPECT_TRUE(refusesWith(refusal([&] { checkWritable(file("d/a.exr")); }), 4, {"d/a.exr"}));
    EXPECT_TRUE(refusesWith(refusal([&] { writeAny(file("d/a.exr")); }), 4, {"d/a.exr"}));
    std::filesystem::permissions(file("d"), std::filesystem::perms::owner_all);
}

TEST_F(FinishedFiles, NothingIsUnderTheNameBeforeCommit) {
    {
        const FinishedFile finished(file("a.exr"));
        EXPECT_EQ(finished.temporaryPath().extension(), ".exr");
        EXPECT_EQ(finished.temporaryPath().parent_path(), folder());
        EXPECT_TRUE(finished.temporaryPath().filename().string().starts_with("a.exr.tmp."));
        writeBytes(finished.temporaryPath(), "half of it");
        EXPECT_FALSE(std::filesystem::exists(file("a.exr")));
    }
    EXPECT_EQ(listing(), "");
    FinishedFile finished(file("a.exr"));
    writeBytes(finished.temporaryPath(), "all of it");
    finished.commit();
    EXPECT_EQ(readBytes(file("a.exr")), "all of it");
    EXPECT_EQ(listing(), "a.exr");
}

TEST_F(FinishedFiles, ASymbolicLinkIsFollowed) {
    std::filesystem::create_directory(file("store"));
    std::filesystem::create_symlink(file("store/real.exr"), file("link.exr"));
    writeAny(file("link.exr"));
    EXPECT_TRUE(std::filesystem::is_symlink(file("link.exr")));
    EXPECT_NO_THROW(readExr(file("store/real.exr")));
}

TEST_F(FinishedFiles, NamesThatSomebodyHasAreLeftAlone) {
    const std::string taken = FinishedFile(file("a.exr")).temporaryPath().string();
    writeBytes(file("mine"), "mine");
    std::filesystem::create_symlink(file("mine"), taken);
    FinishedFile finished(file("a.exr"));
    EXPECT_NE(finished.temporaryPath(), taken);
    EXPECT_EQ(finished.temporaryPath().extension(), ".exr");
    writeAny(file("a.exr"));
    EXPECT_TRUE(std::filesystem::is_symlink(taken));
    EXPECT_EQ(readBytes(file("mine")), "mine");
}

TEST_F(FinishedFiles, ModesOfReplacedFilesAreKept) {
    const mode_t before = umask(022);
    const auto modeOf = [&](const char* name) {
        struct stat status {};
        return ::stat(file(name).c_str(), &status) == 0 ? status.st_mode & 07777u : 0u;
    };
    for (const mode_t mode : {0666u, 0600u, 0664u, 0640u}) {
        writeBytes(file("a.exr"), "old");
        ASSERT_EQ(::chmod(file("a.exr").c_str(), mode), 0);
        writeAny(file("a.exr"));
        EXPECT_EQ(modeOf("a.exr"), mode);
    }
    writeFinishedFile(file("new.json"), "{}");
    EXPECT_EQ(modeOf("new.json"), 0644u);
    // Before it is whole nobody else may read what replaces a private file.
    ASSERT_EQ(::chmod(file("a.exr").c_str(), 0600), 0);
    const FinishedFile finished(file("a.exr"));
    EXPECT_EQ(modeOf(finished.temporaryPath().filename().c_str()), 0600u);
    umask(before);
}

TEST_F(FinishedFiles, NamesMayBeAsLongAsAFileSystemTakesThem) {
    std::string name;
    while (name.size() + 2 <= 250) name += "\u00e9";
    name.resize(250);
    name += "x.exr";
    ASSERT_EQ(name.size(), 255u);
    checkWritable(file(name));
    writeAny(file(name));
    EXPECT_EQ(listing(), name);
    const std::string partial = partialName(file(name)).filename().string();
    EXPECT_EQ(partial.substr(partial.size() - 14), "\u00e9.partial.exr");
    EXPECT_LE(partial.size(), 255u);
    EXPECT_GE(partial.size(), 254u);
}

TEST(PartialName, ComesBeforeTheExtension) {
    EXPECT_EQ(partialName("a/b.c/shot.0001.exr"), "a/b.c/shot.0001.partial.exr");
    EXPECT_EQ(partialName("x.png"), "x.partial.png");
}

}  // namespace
}  // namespace pm::host::test
