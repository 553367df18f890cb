// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors

// The promise of the same bits, held by grid, orders, runner and frame store together over a
// synthetic source of pixels: whatever the threads, the bucket size, the order, the crop and the
// host's floating-point modes, the bytes are those of one thread. P14 and P16 of the paper of Yavuz
// et al. 2010.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <thread>

#include "scheduler/buckets/bucket_order.h"
#include "scheduler/buckets/bucket_runner.h"
#include "scheduler/film/correlated_choice.h"
#include "scheduler/film/frame_store.h"

namespace pm {
namespace {

constexpr std::int32_t kChannels = 5, kBeautyFirst = 1;
constexpr int kPasses = 4;
constexpr Rect kWhole{-11, -6, 101, 75};

std::uint32_t hash(std::uint32_t value) {
    value = (value ^ (value >> 16)) * 0x7feb352du;
    value = (value ^ (value >> 15)) * 0x846ca68bu;
    return value ^ (value >> 16);
}

std::uint32_t hashOf(std::int32_t x, std::int32_t y, int pass, std::int32_t channel) {
    std::uint32_t h = hash(static_cast<std::uint32_t>(x) + 0x9e3779b9u);
    h = hash(h ^ static_cast<std::uint32_t>(y));
    h = hash(h ^ static_cast<std::uint32_t>(pass));
    return hash(h ^ static_cast<std::uint32_t>(channel));
}

// Renders an atom of a bucket: C floats a pixel, then one weight a pixel behind them all.
struct Piece {
    int pass = 0;
    std::uint32_t cell = 0;
    Rect rect, atom;  // the bucket's pixels, and of them the atom's
    int worker = 0;
};
using Source =
    std::function<void(const Piece& piece, std::span<float> pixels, std::span<float> weights)>;

void putPixel(const Piece& piece, std::int32_t x, std::int32_t y, float shared,
              std::span<float> pixels, std::span<float> weights) {
    if (!piece.atom.contains(x, y)) return;
    const Rect& rect = piece.rect;
    const auto at = static_cast<std::size_t>((y - rect.y0) * rect.width() + x - rect.x0);
    // 0: no sample in this pass
    weights[at] = static_cast<float>(hashOf(x, y, piece.pass, 99) % 4);
    for (std::int32_t c = 0; c < kChannels; ++c) {
        const float value = std::ldexp(static_cast<float>(hashOf(x, y, piece.pass, c)), -32);
        // Denormals too, so that flush-to-zero would show.
        const float scale = c == 0 ? 1e-42f : 1.0f;
        pixels[at * kChannels + static_cast<std::size_t>(c)] = scale * (value + shared / 3.0f);
    }
}

// A whole atom from the given corner on; its pixels share a sum in their order, as rays in one
// batch share rounding.
void renderFrom(std::int32_t x0, std::int32_t y0, const Piece& piece, std::span<float> pixels,
                std::span<float> weights) {
    float shared = 0.0f;
    for (std::int32_t i = 0; i < kAtomPixels; ++i) {
        const std::int32_t x = x0 + i % kAtomSizePixels, y = y0 + i / kAtomSizePixels;
        shared += std::ldexp(static_cast<float>(hashOf(x, y, piece.pass, 7)), -33);
        putPixel(piece, x, y, shared, pixels, weights);
    }
}

const Source kGoodSource = [](const Piece& piece, std::span<float> pixels,
                              std::span<float> weights) {
    const Rect whole = wholeAtoms(piece.atom);
    renderFrom(whole.x0, whole.y0, piece, pixels, weights);
};

struct Setting {
    int threads = 1;
    std::int32_t bucketSize = 32;
    std::string_view order = "row";
    Rect window = kWhole;
};

// Everything that can be read of the frame over rect, as bytes.
struct Picture {
    std::vector<float> values;
    double relMse = 0.0;  // of the window, so only comparable between equal windows
};

Picture readPicture(const FrameStore& frame, const Rect& rect) {
    const auto area = static_cast<std::size_t>(rect.area());
    constexpr std::size_t kFloats = kChannels + 4;
    const auto error = frame.estimateError();
    Picture picture{std::vector<float>(area * kFloats), error ? error->noise : -1.0};
    constexpr std::int64_t kPixel = kFloats * sizeof(float);
    const std::int64_t row = kPixel * rect.width();
    frame.read(rect, 0, kChannels, picture.values.data(), kPixel, row);
    frame.readStandardError(rect, picture.values.data() + kChannels, kPixel, row);
    frame.readSampleCount(rect, picture.values.data() + kChannels + 3, kPixel, row);
    return picture;
}

Picture renderPicture(const Setting& setting, const Rect& readRect,
                      const Source& source = kGoodSource) {
    WorkerArena arena(setting.threads);
    const BucketGrid grid(setting.window, setting.bucketSize);
    const BucketOrder& named = *findBucketOrder(setting.order);
    const auto order = named.cells(grid.columns(), grid.rows(), 1);
    FrameStore frame(setting.window, kChannels, kBeautyFirst);
    for (int pass = 0; pass < kPasses; ++pass) {
        CorrelatedChoice choice(grid, order, setting.threads);
        BucketWork work;
        if (named.isCorrelated) work.choose = [&](int worker) { return choice.next(worker); };
        work.floatsPerPixel = kChannels + 1;
        const auto split = [](const Rect& rect, auto floats) {
            const auto area = static_cast<std::size_t>(rect.area());
            return std::pair(floats.first(area * kChannels), floats.last(area));
        };
        work.render = [&](std::uint32_t cell, const Rect& rect, const Rect& atom, int worker,
                          std::span<float> floats) {
            const auto [pixels, weights] = split(rect, floats);
            source({pass, cell, rect, atom, worker}, pixels, weights);
        };
        work.deliver = [&](const RenderedBucket& bucket) {
            const auto [pixels, weights] = split(bucket.rect, bucket.pixels);
            frame.addPass(static_cast<std::uint32_t>(pass), bucket.rect, pixels, weights);
            choice.finished(bucket.cell, pixels, kChannels, kBeautyFirst);
        };
        runBuckets(arena, grid, order, CancelToken(), work);
    }
    return readPicture(frame, readRect);
}

bool sameBytes(const Picture& a, const Picture& b) {
    return a.values.size() == b.values.size() &&
           std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}

class SameBits : public ::testing::Test {
  protected:
    // The test as a host that lets TBB have more threads than the machine has: real concurrency.
    oneapi::tbb::global_control m_limit{oneapi::tbb::global_control::max_allowed_parallelism, 8};
};

TEST_F(SameBits, threadsSizesAndOrders) {
    const Picture expected = renderPicture({}, kWhole);
    for (const int threads : {1, 2, 3, 8}) {
        for (const std::int32_t size : {8, 16, 24, 32, 48, 128}) {
            for (const BucketOrder& order : bucketOrders()) {
                const Picture picture = renderPicture({threads, size, order.name}, kWhole);
                EXPECT_TRUE(sameBytes(picture, expected))
                    << threads << " threads, size " << size << ", " << order.name;
                EXPECT_EQ(std::bit_cast<std::uint64_t>(picture.relMse),
                          std::bit_cast<std::uint64_t>(expected.relMse));
            }
        }
    }
}

TEST_F(SameBits, cropAgainstTheWhole) {
    const Rect crops[] = {{-11, -6, 1, 1}, {13, 5, 61, 50}, {-3, 9, 100, 10}, {40, 40, 41, 41}};
    for (const Rect& crop : crops) {
        const Picture expected = renderPicture({}, crop);
        for (const std::int32_t size : {8, 16, 24, 32, 48}) {
            EXPECT_TRUE(sameBytes(renderPicture({3, size, "hilbert", crop}, crop), expected))
                << "size " << size << ", crop from " << crop.x0 << ", " << crop.y0;
        }
    }
}

#if defined(__SSE__)
TEST_F(SameBits, modesOfTheHost) {
    const Picture expected = renderPicture({}, kWhole);
    const unsigned saved = _mm_getcsr();
    _mm_setcsr(saved | 0xe040);  // flush-to-zero, denormals-are-zero, towards zero
    const Picture picture = renderPicture({3, 16, "hilbert"}, kWhole);
    _mm_setcsr(saved);
    EXPECT_TRUE(sameBytes(picture, expected));
    EXPECT_EQ(picture.relMse, expected.relMse);
}
#endif

// The comparison sees what it is for: three sources with the classic faults.
TEST_F(SameBits, brokenSourcesAreSeen) {
    const Source byBucket = [](const Piece& piece, std::span<float> pixels,
                               std::span<float> weights) {
        kGoodSource(piece, pixels, weights);
        pixels[0] += static_cast<float>(piece.cell) * 1e-3f;
        weights[0] = 1.0f;
    };
    EXPECT_FALSE(sameBytes(renderPicture({1, 16}, kWhole, byBucket),
                           renderPicture({1, 32}, kWhole, byBucket)));
    const Source byWorker = [](const Piece& piece, std::span<float> pixels,
                               std::span<float> weights) {
        const Rect whole = wholeAtoms(piece.atom);
        std::this_thread::sleep_for(std::chrono::microseconds(50));
        Piece shifted = piece;
        shifted.pass += 100 * piece.worker;
        renderFrom(whole.x0, whole.y0, shifted, pixels, weights);
    };
    EXPECT_FALSE(sameBytes(renderPicture({1, 16}, kWhole, byWorker),
                           renderPicture({8, 16}, kWhole, byWorker)));
    // Atoms that begin at the bucket's corner: right for the whole frame, wrong for a crop.
    const Source byCorner = [](const Piece& piece, std::span<float> pixels,
                               std::span<float> weights) {
        renderFrom(piece.atom.x0, piece.atom.y0, piece, pixels, weights);
    };
    const Rect crop{13, 5, 61, 50};
    EXPECT_FALSE(sameBytes(renderPicture({1, 32, "row", crop}, crop, byCorner),
                           renderPicture({1, 32}, crop, byCorner)));
}

}  // namespace
}  // namespace pm
