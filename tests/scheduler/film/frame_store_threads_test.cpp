// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "scheduler/film/frame_store.h"

namespace pm {
namespace {

constexpr Rect kWindow{-4, -4, 60, 28};
constexpr std::int32_t kChannels = 32;
constexpr int kPasses = 300;

// All channels of pass k are k, so in between passes every channel has the same mean. Waits for
// the reader now and then, or a busy machine may let it run only when all is written.
void addPasses(FrameStore& frame, const Rect& rect, const std::atomic<int>& reads) {
    const auto area = static_cast<std::size_t>(rect.area());
    const std::vector<float> weights(area, 1.0f);
    for (int k = 1; k <= kPasses; ++k) {
        // Of two reads that end from now on, the second also began from now on.
        const int due = k % 8 == 0 ? reads + 2 : 0;
        while (reads < due) std::this_thread::yield();
        const std::vector<float> pixels(area * kChannels, static_cast<float>(k));
        frame.addPass(static_cast<std::uint32_t>(k - 1), rect, pixels, weights);
    }
}

// Pixels of values whose channels differ.
int tornPixels(const std::vector<float>& values) {
    int torn = 0;
    for (std::size_t i = 0; i < values.size(); i += kChannels) {
        for (std::size_t c = 1; c < kChannels; ++c) {
            if (values[i + c] != values[i]) {
                ++torn;
                break;
            }
        }
    }
    return torn;
}

std::vector<float> readAll(const FrameStore& frame) {
    std::vector<float> values(static_cast<std::size_t>(kWindow.area()) * kChannels);
    constexpr std::int64_t kPixel = kChannels * sizeof(float);
    frame.read(kWindow, 0, kChannels, values.data(), kPixel, kPixel * kWindow.width());
    return values;
}

TEST(FrameStoreThreads, readersNeverSeeAPixelWithinAPass) {
    FrameStore frame(kWindow, kChannels, 0);
    std::vector<std::thread> writers;
    std::atomic<int> writing{4}, reads{0};
    for (const Rect& rect :
         {Rect{-4, -4, 16, 12}, Rect{16, -4, 60, 12}, Rect{-4, 12, 30, 28}, Rect{30, 12, 60, 28}}) {
        writers.emplace_back([&frame, &writing, &reads, rect] {
            addPasses(frame, rect, reads);
            --writing;
        });
    }
    int torn = 0, partial = 0;
    float least = 0.0f;
    while (writing > 0 || reads == 0) {
        const std::vector<float> values = readAll(frame);
        torn += tornPixels(values);
        partial += values[0] > 0.0f && values[0] < 0.5f * (kPasses + 1) ? 1 : 0;
        EXPECT_GE(values[0], least);  // the mean of 1, 2, 3, ... only rises
        least = values[0];
        if (const auto error = frame.standardError(0, 0)) {
            EXPECT_EQ((*error)[0], (*error)[2]);
        }
        frame.estimateError();
        ++reads;
    }
    for (std::thread& writer : writers) writer.join();
    EXPECT_EQ(torn, 0);
    EXPECT_GT(partial, 0) << "the reader never ran beside the writers";
    for (const float value : readAll(frame)) ASSERT_EQ(value, 0.5f * (kPasses + 1));
    EXPECT_EQ(frame.sampleCount(59, 27), kPasses);
}

TEST(FrameStoreThreads, checkSeesTornPixels) {
    std::vector<float> values(kChannels * 4, 1.0f);
    EXPECT_EQ(tornPixels(values), 0);
    values[kChannels + 5] = 2.0f;
    EXPECT_EQ(tornPixels(values), 1);
}

}  // namespace
}  // namespace pm
