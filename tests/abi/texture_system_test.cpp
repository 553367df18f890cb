// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Texture systems after each other in one process, with threads that outlive them.
#include "plugin/textures/texture_system.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace pm::plugin::test {
namespace {

constexpr int kSide = 512;

std::string picture() {
    const std::string file = testing::TempDir() + "texture_system.tif";
    OIIO::ImageSpec spec(kSide, kSide, 1, OIIO::TypeDesc::UINT8);
    spec.tile_width = spec.tile_height = 64;
    const std::vector<std::uint8_t> texels(std::size_t{kSide} * kSide, 51);
    const auto out = OIIO::ImageOutput::create("tiff");
    EXPECT_TRUE(out->open(file, spec) && out->write_image(OIIO::TypeDesc::UINT8, texels.data()) &&
                out->close());
    return file;
}

// A thread that does what it is given, one after the other, and lives on.
class Worker {
  public:
    Worker() : m_thread([this] { run(); }) {}
    ~Worker() {
        give({});
        m_thread.join();
    }
    // Returns when it is done; empty: the end.
    void give(std::function<void()> work) {
        std::unique_lock lock(m_mutex);
        const bool isEnd = !work;
        m_work = std::move(work);
        m_isGiven = true;
        m_changed.notify_all();
        if (!isEnd) m_changed.wait(lock, [this] { return !m_isGiven; });
    }

  private:
    void run() {
        std::unique_lock lock(m_mutex);
        for (;;) {
            m_changed.wait(lock, [this] { return m_isGiven; });
            if (!m_work) return;
            m_work();
            m_isGiven = false;
            m_changed.notify_all();
        }
    }

    std::mutex m_mutex;
    std::condition_variable m_changed;
    std::function<void()> m_work;
    bool m_isGiven = false;
    std::thread m_thread;
};

TEST(TextureSystem, OneAfterTheOtherForThreadsThatLiveOn) {
    TextureDescription description;
    description.fileName = picture();
    Worker worker;
    for (int i = 0; i < 20; ++i) {
        TextureSystem system;
        const TexturePicture found = system.open(description);
        ASSERT_EQ(found.width, static_cast<std::uint32_t>(kSide));
        const auto lookUp = [&] {
            for (int y = 0; y < 8; ++y) {
                for (int x = 0; x < 8; ++x) {
                    Texel texel;
                    ASSERT_TRUE(system.lookUp(
                        found,
                        {(static_cast<float>(x) + 0.5f) / 8, (static_cast<float>(y) + 0.5f) / 8},
                        {}, texel));
                    ASSERT_NEAR(texel.r, 0.2f, 1e-6f);
                }
            }
        };
        worker.give(lookUp);
        lookUp();
        EXPECT_EQ(system.reads(found).tiles, 64u) << "of system " << i;
    }
    std::filesystem::remove(description.fileName);
}

}  // namespace
}  // namespace pm::plugin::test
