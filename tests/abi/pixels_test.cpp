// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Layers and readPixels.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

constexpr PmrRectangle kWhole = {0, 0, kWidth, kHeight};

class Pixels : public ::testing::Test {
  protected:
    Pixels()
        : m_render(m_host.makeRender({{"layers", "albedo,N,Z,stderr,halfdiff,samples,aalevel"}})) {}
    ~Pixels() override { EXPECT_EQ(PMR_OK, api().destroyRender(m_render)); }
    void finish() {
        ASSERT_EQ(PMR_OK, api().startRender(m_render));
        ASSERT_EQ(PMR_OK, api().waitRender(m_render, -1.0));
    }
    BoxHost m_host;
    PmrRender m_render;
};

TEST_F(Pixels, LayersOfARender) {
    std::uint32_t count = 0;
    EXPECT_EQ(PMR_OK, api().renderLayerCount(m_render, &count));
    EXPECT_EQ(api().layerCount(), count);
    std::set<std::string> channels;
    for (std::uint32_t i = 0; i < count; ++i) {
        PmrLayerInfo info = PMR_INIT(PmrLayerInfo);
        ASSERT_EQ(PMR_OK, api().renderLayerInfo(m_render, i, &info));
        std::string names = info.channels;
        std::uint32_t found = 1;
        for (const char c : names) found += c == ',';
        EXPECT_EQ(info.channelCount, found);
        EXPECT_TRUE(channels.insert(names).second);
        // Data must not be taken for colour by programs that go by the name.
        if (info.kind == PMR_LAYER_DATA) {
            EXPECT_EQ(std::string::npos, names.find(".R")) << names;
        }
    }
    PmrLayerInfo info = PMR_INIT(PmrLayerInfo);
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().renderLayerInfo(m_render, count, &info));
    EXPECT_EQ(PMR_OK, api().setSettingText(m_render, "layers", "Z"));
    EXPECT_EQ(PMR_OK, api().renderLayerCount(m_render, &count));
    EXPECT_EQ(6u, count);
    ASSERT_EQ(PMR_OK, api().renderLayerInfo(m_render, 5, &info));
    EXPECT_STREQ("Z", info.name);
}

TEST_F(Pixels, WhatEveryFrameHoldsIsReadWithoutBeingAskedFor) {
    const PmrRender plain = m_host.makeRender({});
    ASSERT_EQ(PMR_OK, api().startRender(plain));
    ASSERT_EQ(PMR_OK, api().waitRender(plain, -1.0));
    finish();
    for (const auto& [layer, channels] :
         {std::pair("stderr", 3u), std::pair("samples", 1u), std::pair("aalevel", 1u)}) {
        const auto values = readLayer(plain, layer, channels, kWhole);
        EXPECT_EQ(readLayer(m_render, layer, channels, kWhole), values) << layer;
        EXPECT_GT(*std::max_element(values.begin(), values.end()), 0.0f) << layer;
    }
    float albedo[3] = {};
    const PmrRectangle one{0, 0, 1, 1};
    EXPECT_EQ(PMR_ERROR_NAME, api().readPixels(plain, &one, "albedo", albedo, 0, 0));
    EXPECT_EQ(PMR_OK, api().destroyRender(plain));
}

TEST_F(Pixels, LevelsAreWhatTheSamplesAmountTo) {
    for (const float level : readLayer(m_render, "aalevel", 1, kWhole)) EXPECT_EQ(0.0f, level);
    ASSERT_EQ(PMR_OK, api().setSettingInteger(m_render, "passes", 3));
    finish();
    const auto samples = readLayer(m_render, "samples", 1, kWhole);
    const auto levels = readLayer(m_render, "aalevel", 1, kWhole);
    float most = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        EXPECT_FLOAT_EQ(levels[i], 1 + 0.5f * std::log2(samples[i] * 4 / 3));
        EXPECT_GE(levels[i], 1.0f);
        most = std::max(most, levels[i]);
    }
    // Some pixels differ from sample to sample, and get more than the least.
    EXPECT_GT(most, *std::min_element(levels.begin(), levels.end()));
}

std::vector<float> levelZero(PmrRender render, const char* mostLevel) {
    EXPECT_EQ(PMR_OK, api().setSettingText(render, "aaLevel", "0"));
    EXPECT_EQ(PMR_OK, api().setSettingText(render, "aaLevelMost", mostLevel));
    EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "passes", 4));
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    return readLayer(render, "beauty", 4, kWhole);
}

// Whether the 2 x 2 pixels around (x, y) on even coordinates have one colour.
bool showsAGroup(const std::vector<float>& beauty, std::int32_t x, std::int32_t y) {
    const auto at = [&](std::int32_t i, std::int32_t j) {
        return beauty.data() +
               4 * static_cast<std::size_t>((y & ~1) * kWidth + (x & ~1) + i + j * kWidth);
    };
    for (const float* other : {at(1, 0), at(0, 1), at(1, 1)})
        if (std::memcmp(at(0, 0), other, 4 * sizeof(float)) != 0) return false;
    return true;
}

TEST_F(Pixels, LevelZeroIsOneSampleForFourPixels) {
    const auto beauty = levelZero(m_render, "0");
    for (std::int32_t y = 0; y < kHeight; ++y)
        for (std::int32_t x = 0; x < kWidth; ++x) ASSERT_TRUE(showsAGroup(beauty, x, y));
    for (const float count : readLayer(m_render, "samples", 1, kWhole)) EXPECT_EQ(0.25f, count);
    for (const float level : readLayer(m_render, "aalevel", 1, kWhole)) EXPECT_EQ(0.0f, level);
    const std::string statistics = textOf([&](char* buffer, std::uint64_t size, std::uint64_t* n) {
        return api().renderStatistics(m_render, buffer, size, n);
    });
    EXPECT_NE(std::string::npos, statistics.find("begins at level 0"));
}

// Some groups are divided, and from then on their pixels' samples are their own; what samples there
// are is told by the layer, and adds up to those that were taken.
TEST_F(Pixels, LevelZeroIsDividedWhereItsSamplesDiffer) {
    const auto beauty = levelZero(m_render, "3");
    const auto samples = readLayer(m_render, "samples", 1, kWhole);
    const auto levels = readLayer(m_render, "aalevel", 1, kWhole);
    std::size_t groups = 0;
    double sum = 0;
    for (std::int32_t y = 0; y < kHeight; ++y)
        for (std::int32_t x = 0; x < kWidth; ++x) {
            const auto i = static_cast<std::size_t>(y * kWidth + x);
            sum += static_cast<double>(samples[i]);
            if (levels[i] == 0.0f) {
                ++groups;
                EXPECT_TRUE(showsAGroup(beauty, x, y)) << x << "," << y;
                EXPECT_EQ(0.5f, samples[i]);  // one in each half, shared by four
            } else {
                EXPECT_GE(samples[i], 2.0f);
                EXPECT_FLOAT_EQ(levels[i], 1 + 0.5f * std::log2(samples[i]));
            }
        }
    EXPECT_GT(groups, samples.size() / 10);
    EXPECT_LT(groups, samples.size() * 9 / 10);
    // Pixels that were divided had half a sample more before.
    sum += 0.5 * static_cast<double>(samples.size() - groups);
    const std::string statistics = textOf([&](char* buffer, std::uint64_t size, std::uint64_t* n) {
        return api().renderStatistics(m_render, buffer, size, n);
    });
    EXPECT_NE(std::string::npos,
              statistics.find("\"cameraSamples\": " + std::to_string(std::llround(sum)) + ","));
}

TEST_F(Pixels, BeautyIsTheSumOfItsParts) {
    for (const float value : readLayer(m_render, "beauty", 4, kWhole)) EXPECT_EQ(0.0f, value);
    finish();
    const auto beauty = readLayer(m_render, "beauty", 4, kWhole);
    const auto direct = readLayer(m_render, "direct", 3, kWhole);
    const auto indirect = readLayer(m_render, "indirect", 3, kWhole);
    const auto caustic = readLayer(m_render, "caustic", 3, kWhole);
    const auto emission = readLayer(m_render, "emission", 3, kWhole);
    double sums[4] = {};
    for (std::size_t i = 0; i < direct.size() / 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = 3 * i + c;
            EXPECT_EQ(direct[at] + indirect[at] + caustic[at] + emission[at], beauty[4 * i + c]);
            sums[0] += direct[at];
            sums[1] += indirect[at];
            sums[2] += caustic[at];
            sums[3] += emission[at];
        }
        EXPECT_GE(beauty[4 * i + 3], 0.0f);
        EXPECT_LE(beauty[4 * i + 3], 1.0f);
    }
    for (const double sum : sums) EXPECT_GT(sum, 0.0);
}

TEST_F(Pixels, DataLayers) {
    finish();
    const auto alpha = readLayer(m_render, "beauty", 4, kWhole);
    const auto depth = readLayer(m_render, "Z", 1, kWhole);
    const auto normal = readLayer(m_render, "N", 3, kWhole);
    const auto albedo = readLayer(m_render, "albedo", 3, kWhole);
    const auto samples = readLayer(m_render, "samples", 1, kWhole);
    const auto error = readLayer(m_render, "stderr", 3, kWhole);
    double errorSum = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (alpha[4 * i + 3] == 0.0f) {
            EXPECT_EQ(1e10f, depth[i]);
        } else {
            EXPECT_GE(depth[i], 2.4f);  // the box is from 2.5 to 4.5 before the camera
            EXPECT_LE(depth[i], 4.6f);
        }
        EXPECT_LE(std::hypot(normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]), 1.001f);
        EXPECT_LE(albedo[3 * i], 1.0f);
        EXPECT_GE(samples[i], 1.0f);
        EXPECT_GE(error[3 * i], 0.0f);
        errorSum += error[3 * i];
    }
    EXPECT_GT(errorSum, 0.0);
    // The middle of the picture looks along -z at the back wall or the block: z up to 1.
    const std::size_t middle = (kHeight / 2 - 8) * std::size_t{kWidth} + kWidth / 2;
    EXPECT_NEAR(1.0f, normal[3 * middle + 2], 1e-3f);
    EXPECT_NEAR(0.75f, albedo[3 * middle], 1e-3f);
}

TEST_F(Pixels, StridesAndEdges) {
    finish();
    const auto plain = readLayer(m_render, "beauty", 4, kWhole);
    // Bottom up, RGBA, with a margin between the pixels: as some hosts keep their buffers.
    const std::size_t pixel = 6, row = pixel * kWidth;
    std::vector<float> upside(row * kHeight, -7.0f);
    const auto floatBytes = static_cast<std::int64_t>(sizeof(float));
    EXPECT_EQ(PMR_OK,
              api().readPixels(m_render, &kWhole, "beauty", upside.data() + row * (kHeight - 1),
                               static_cast<std::int64_t>(pixel) * floatBytes,
                               -static_cast<std::int64_t>(row) * floatBytes));
    for (std::size_t y = 0; y < kHeight; ++y)
        for (std::size_t x = 0; x < kWidth; ++x) {
            const float* found = &upside[(kHeight - 1 - y) * row + x * pixel];
            EXPECT_EQ(0, std::memcmp(found, &plain[(y * kWidth + x) * 4], 4 * sizeof(float)));
            EXPECT_EQ(-7.0f, found[4]);
            EXPECT_EQ(-7.0f, found[5]);
        }
    const auto beyond = readLayer(m_render, "beauty", 4, {-3, -2, 5, 4});
    for (int y = -2; y < 4; ++y)
        for (int x = -3; x < 5; ++x)
            for (std::size_t c = 0; c < 4; ++c) {
                const auto at = static_cast<std::size_t>((y + 2) * 8 + x + 3) * 4 + c;
                const bool inside = x >= 0 && y >= 0;
                EXPECT_EQ(inside ? plain[static_cast<std::size_t>(y * kWidth + x) * 4 + c] : 0.0f,
                          beyond[at]);
            }
    for (const float value : readLayer(m_render, "Z", 1, {1000, 1000, 1004, 1004}))
        EXPECT_EQ(0.0f, value);
    const PmrRectangle empty = {4, 4, 4, 9};
    float untouched = -7.0f;
    EXPECT_EQ(PMR_OK, api().readPixels(m_render, &empty, "Z", &untouched, 0, 0));
    EXPECT_EQ(-7.0f, untouched);
}

}  // namespace

}  // namespace pm::test
