// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/frame_store_bytes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <optional>
#include <random>

#include "integrator/values/error.h"

namespace pm::test {

namespace {

constexpr std::int32_t kChannels = 11;
constexpr std::int32_t kSeen = 6;  // of adaptive renders, in a pass only
const Rect kWindow{-3, 5, 22, 26}, kArea{-8, 0, 24, 32};

std::unique_ptr<FrameStore> makeStore(bool adaptive) {
    std::optional<SampleRule> rule;
    // Passes that share no noise: of adaptive stores the one with most.
    if (adaptive) rule = SampleRule{1, 16, 0.01, false, false};
    return std::make_unique<FrameStore>(kWindow, kChannels + (adaptive ? kSeen : 0), 0, 5, 3, rule);
}

void addPass(FrameStore& store, bool adaptive, std::uint32_t pass) {
    std::mt19937 random(pass + 1);
    const Rect area = FrameStoreBytes::area(store);
    const auto pixels = static_cast<std::size_t>(area.area());
    std::vector<float> values(pixels * (kChannels + (adaptive ? kSeen : 0))), weights(pixels);
    for (float& value : values) value = static_cast<float>(random() % 1000) / 7.0f;
    for (float& weight : weights) weight = static_cast<float>(random() % 4);  // 0 too
    store.addPass(pass, area, values, weights);
}

// All that can be read of a store.
std::vector<float> contents(const FrameStore& store) {
    const auto pixels = static_cast<std::size_t>(kWindow.area());
    std::vector<float> all(pixels * (kChannels + 4));
    float* at = all.data();
    store.read(kWindow, 0, kChannels, at, kChannels * 4, kChannels * 4 * kWindow.width());
    at += pixels * kChannels;
    store.readStandardError(kWindow, at, 12, 12 * kWindow.width());
    store.readSampleCount(kWindow, at + pixels * 3, 4, 4 * kWindow.width());
    const auto error = store.estimateError();
    all.push_back(error ? static_cast<float>(error->noise) : -1.0f);
    all.push_back(error ? static_cast<float>(error->bias) : -1.0f);
    return all;
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * 4) == 0;
}

class FrameStoreBytesOf : public ::testing::TestWithParam<bool> {};

TEST_P(FrameStoreBytesOf, GoOnAsIfNothingHadHappened) {
    const auto store = makeStore(GetParam());
    for (std::uint32_t pass = 0; pass < 5; ++pass) addPass(*store, GetParam(), pass);
    std::vector<std::byte> left, right;
    const Rect a{-8, 0, 9, 32}, b{9, 0, 24, 32};
    FrameStoreBytes::append(*store, a, left);
    right.push_back(std::byte{77});  // what is there stays
    FrameStoreBytes::append(*store, b, right);
    EXPECT_EQ(left.size(),
              static_cast<std::size_t>(a.area()) * FrameStoreBytes::bytesPerPixel(*store));

    const auto copy = makeStore(GetParam());
    addPass(*copy, GetParam(), 9);  // is replaced
    FrameStoreBytes::restore(*copy, b, std::span(right).subspan(1));
    FrameStoreBytes::restore(*copy, a, left);
    EXPECT_TRUE(sameBits(contents(*store), contents(*copy)));
    std::vector<std::byte> again, whole;
    FrameStoreBytes::append(*copy, kArea, again);
    FrameStoreBytes::append(*store, kArea, whole);
    EXPECT_TRUE(again == whole);

    for (std::uint32_t pass = 5; pass < 8; ++pass) {
        addPass(*store, GetParam(), pass);
        addPass(*copy, GetParam(), pass);
    }
    EXPECT_TRUE(sameBits(contents(*store), contents(*copy)));
    again.clear();
    whole.clear();
    FrameStoreBytes::append(*copy, kArea, again);
    FrameStoreBytes::append(*store, kArea, whole);
    EXPECT_TRUE(again == whole);
}

// A new array of the store that the bytes don't have would show here: all the store's memory but
// the locks and the object itself is pixels.
TEST_P(FrameStoreBytesOf, AreAllThatTheStoreHas) {
    const auto store = makeStore(GetParam());
    EXPECT_EQ(FrameStoreBytes::area(*store), kArea);
    const std::uint64_t memory =
        FrameStore::memoryBytes(kWindow, kChannels + (GetParam() ? kSeen : 0), 5, GetParam());
    const std::uint64_t bytes =
        FrameStoreBytes::bytesPerPixel(*store) * static_cast<std::uint64_t>(kArea.area());
    EXPECT_GE(memory, bytes);
    EXPECT_LT(memory - bytes, sizeof(FrameStore) + 5 * sizeof(std::mutex));
}

INSTANTIATE_TEST_SUITE_P(Stores, FrameStoreBytesOf, ::testing::Bool());

TEST(FrameStoreBytes, RefuseOtherSizes) {
    const auto store = makeStore(false);
    std::vector<std::byte> bytes;
    EXPECT_THROW(FrameStoreBytes::append(*store, {-9, 5, 0, 6}, bytes), Error);
    FrameStoreBytes::append(*store, {0, 5, 4, 9}, bytes);
    EXPECT_THROW(FrameStoreBytes::restore(*store, {0, 5, 4, 10}, bytes), Error);
    EXPECT_THROW(FrameStoreBytes::restore(*store, {22, 5, 26, 9}, bytes), Error);
    bytes.pop_back();
    EXPECT_THROW(FrameStoreBytes::restore(*store, {0, 5, 4, 9}, bytes), Error);
}

}  // namespace

}  // namespace pm::test
