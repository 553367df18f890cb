// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <fstream>
#include <thread>

#include "tests/textures/texture_support.h"

namespace pm::host::test {
namespace {

class TextureCaching : public TextureTest {
  protected:
    void writeGrey(const std::string& name, float value, int side = 8) const {
        const auto count = static_cast<std::size_t>(side * side) * 3;
        writeTexture(file(name), side, side, 3, OIIO::TypeDesc::UINT8,
                     std::vector<float>(count, value));
    }
    TextureCounts countsOf(const std::vector<TextureRequest>& requests) const {
        TexturePreparer preparing = preparer();
        preparing.prepare(requests);
        for (const TextureRequest& request : requests) preparing.texture(request);
        return preparing.counts();
    }
    // The files of the cache that end so.
    std::vector<std::filesystem::path> files(const std::string& part,
                                             const std::string& extension) const {
        std::vector<std::filesystem::path> found;
        for (const auto& entry : std::filesystem::directory_iterator(cacheFolder() / part))
            if (entry.path().extension() == extension) found.push_back(entry.path());
        std::ranges::sort(found);
        return found;
    }
};

TEST_F(TextureCaching, ASecondRunOpensNoOriginal) {
    std::vector<TextureRequest> requests;
    for (int i = 0; i < 100; ++i) {
        const std::string name = fmt::format("t{}.png", i);
        writeGrey(name, static_cast<float>(i) / 100.0f, 2);
        requests.push_back({file(name), i % 3 == 0 ? TextureKind::kMask : TextureKind::kColour});
    }
    const TextureCounts first = countsOf(requests), second = countsOf(requests);
    EXPECT_EQ(first.originalsOpened, 100u);
    EXPECT_EQ(first.converted, 100u);
    EXPECT_EQ(second.originalsOpened, 0u);
    EXPECT_EQ(second.found, 100u);
    // Without the record of what was seen it would have to be.
    std::filesystem::remove(files("index", ".rec")[0]);
    EXPECT_EQ(countsOf(requests).originalsOpened, 1u);
}

TEST_F(TextureCaching, WhatChangedIsMadeAnew) {
    writeGrey("a.png", 0.2f);
    const BakedTexture before = baked({file("a.png")});
    writeGrey("a.png", 0.4f);
    const BakedTexture after = baked({file("a.png")});
    EXPECT_NE(after.file, before.file);
    EXPECT_NE(after.facts.texelHash, before.facts.texelHash);
    // Of the same size and date, but not of the same time of change.
    struct stat status {};
    stat(file("a.png").c_str(), &status);
    std::string bytes = readBytes(file("a.png"));
    writeGrey("b.png", 0.4f);
    const std::string other = readBytes(file("b.png"));
    ASSERT_EQ(bytes.size(), other.size());
    writeGrey("a.png", 0.6f);
    const timespec times[2] = {status.st_atim, status.st_mtim};
    utimensat(AT_FDCWD, file("a.png").c_str(), times, 0);
    EXPECT_NE(baked({file("a.png")}).facts.texelHash, after.facts.texelHash);
}

TEST_F(TextureCaching, WhatWasOnlyTouchedOrCopiedIsNot) {
    writeGrey("a.png", 0.2f);
    const auto first = baked({file("a.png")}).file;
    utimensat(AT_FDCWD, file("a.png").c_str(), nullptr, 0);
    const TextureCounts touched = countsOf({{file("a.png")}});
    EXPECT_EQ(touched.originalsOpened, 1u);
    EXPECT_EQ(touched.converted, 0u);
    EXPECT_EQ(baked({file("a.png")}).file, first);
}

TEST_F(TextureCaching, DamageIsFoundAndMended) {
    writeGrey("a.png", 0.2f, 64);
    const auto texture = baked({file("a.png")}).file;
    const std::string bytes = readBytes(texture);
    std::string changed = bytes;
    changed[changed.size() - 100] = static_cast<char>(~changed[changed.size() - 100]);
    for (const std::string& damage : {bytes.substr(0, bytes.size() / 2), std::string(), changed,
                                      std::string(bytes.size(), 0)}) {
        writeBytes(texture, damage);
        EXPECT_EQ(countsOf({{file("a.png")}}).converted, 1u);
        EXPECT_EQ(readBytes(texture), bytes);
    }
    // The same bytes written again are no damage.
    writeBytes(texture, bytes);
    EXPECT_EQ(countsOf({{file("a.png")}}).converted, 0u);
    for (const char* part : {"textures", "index"}) {
        const auto record = files(part, ".rec")[0];
        const std::string text = readBytes(record);
        for (const std::string& damage : {text.substr(0, text.size() / 2), std::string("nonsense"),
                                          std::string(), "x" + text}) {
            writeBytes(record, damage);
            EXPECT_EQ(countsOf({{file("a.png")}}).originalsOpened, 1u) << part;
        }
    }
    std::filesystem::remove(texture);
    EXPECT_EQ(countsOf({{file("a.png")}}).converted, 1u);
}

TEST_F(TextureCaching, OldestGoFirstAndNoneThatIsInUse) {
    std::vector<std::filesystem::path> textures;
    for (int i = 0; i < 4; ++i) {
        writeGrey(fmt::format("{}.png", i), static_cast<float>(i) / 4, 64);
        textures.push_back(baked({file(fmt::format("{}.png", i))}).file);
        // Used that many hours ago.
        const timespec then{std::time(nullptr) - (10 - i) * 3600, 0};
        const timespec times[2] = {then, then};
        std::filesystem::path record = textures.back();
        record.replace_extension(".rec");
        for (const auto& path : {textures.back(), record})
            utimensat(AT_FDCWD, path.c_str(), times, 0);
    }
    const auto bytes =
        std::filesystem::file_size(textures[0]) + std::filesystem::file_size(textures[3]);
    const auto holder = cache();
    // The oldest, used by a process that lives; flock knows descriptors apart, not processes.
    ASSERT_TRUE(holder->find(textures[0].stem().string()));
    std::filesystem::path record = textures[0];
    const timespec then{std::time(nullptr) - 11 * 3600, 0};
    const timespec times[2] = {then, then};
    utimensat(AT_FDCWD, record.replace_extension(".rec").c_str(), times, 0);
    utimensat(AT_FDCWD, textures[0].c_str(), times, 0);
    cache(bytes)->makeRoom();
    EXPECT_TRUE(std::filesystem::exists(textures[0]));
    EXPECT_FALSE(std::filesystem::exists(textures[1]));
    EXPECT_FALSE(std::filesystem::exists(textures[2]));
    EXPECT_TRUE(std::filesystem::exists(textures[3]));
    EXPECT_EQ(cache()->list().size(), 2u);
}

TEST_F(TextureCaching, ListsVerifiesAndClears) {
    writeGrey("a.png", 0.2f, 64);
    writeGrey("b.png", 0.3f, 64);
    const auto a = baked({file("a.png")}).file;
    baked({file("b.png")});
    const auto entries = cache()->list();
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(entries[0].source, file("a.png"));
    EXPECT_TRUE(cache()->verify().empty());
    std::string bytes = readBytes(a);
    bytes[bytes.size() / 2] = static_cast<char>(~bytes[bytes.size() / 2]);
    writeBytes(a, bytes);
    const auto faults = cache()->verify();
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_NE(faults[0].find(a.filename().string()), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(a));
    writeBytes(cacheFolder() / "textures" / "somebody's.txt", "not ours");
    EXPECT_EQ(cache()->clear(), 1u);
    EXPECT_TRUE(cache()->list().empty());
    EXPECT_TRUE(std::filesystem::exists(cacheFolder() / "textures" / "somebody's.txt"));
    EXPECT_EQ(countsOf({{file("a.png")}}).converted, 1u);
}

// Each makes what it doesn't find; nobody waits and all get whole ones.
TEST_F(TextureCaching, SeveralProcessesAtOnce) {
    std::vector<TextureRequest> requests;
    for (int i = 0; i < 6; ++i) {
        writeGrey(fmt::format("{}.png", i), static_cast<float>(i) / 6, 64);
        requests.push_back({file(fmt::format("{}.png", i))});
    }
    std::vector<std::jthread> users;
    std::atomic<int> good{0};
    for (int i = 0; i < 4; ++i)
        users.emplace_back([&] {
            TexturePreparer preparing = preparer();
            preparing.prepare(requests);
            for (const TextureRequest& request : requests)
                good += readLevels(preparing.texture(request).file).size() == 7 ? 1 : 0;
        });
    users.clear();
    EXPECT_EQ(good, 24);
    EXPECT_EQ(countsOf(requests).found, 6u);
    EXPECT_TRUE(cache()->verify().empty());
    EXPECT_TRUE(files("leases", ".lease").empty());
}

TEST_F(TextureCaching, AFolderThatCantBeWritten) {
    writeBytes(file("cache"), "a file is in the way");
    EXPECT_FALSE(cache()->isWritable());
    writeGrey("a.png", 0.2f);
    EXPECT_TRUE(refusesWith(refusal([&] { baked({file("a.png")}); }), 4, {"cache"}));
}

}  // namespace
}  // namespace pm::host::test
