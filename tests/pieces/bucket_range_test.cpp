// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/bucket_range.h"

#include <gtest/gtest.h>

#include "plugin/values/call_error.h"

namespace pm::plugin::test {

namespace {

TEST(BucketRange, TextsMeanRanges) {
    EXPECT_EQ(bucketRange("", 7), (BucketRange{0, 7}));
    EXPECT_EQ(bucketRange("2:5", 7), (BucketRange{2, 5}));
    EXPECT_EQ(bucketRange("0:7", 7), (BucketRange{0, 7}));
    EXPECT_EQ(bucketRange("1/1", 7), (BucketRange{0, 7}));
    EXPECT_EQ(rangeText({2, 5}), "2:5");
}

TEST(BucketRange, RunsAreAllBucketsOnceAndAboutAsMany) {
    for (const std::uint32_t buckets : {1u, 7u, 64u, 4294967295u}) {
        for (std::uint32_t runs = 1; runs <= std::min(buckets, 9u); ++runs) {
            std::uint32_t next = 0;
            for (std::uint32_t run = 1; run <= runs; ++run) {
                const BucketRange range =
                    bucketRange(std::to_string(run) + "/" + std::to_string(runs), buckets);
                EXPECT_EQ(range.first, next);
                EXPECT_GE(range.count(), buckets / runs);
                EXPECT_LE(range.count(), std::uint64_t{buckets} / runs + 1);
                next = range.last;
            }
            EXPECT_EQ(next, buckets);
        }
    }
}

TEST(BucketRange, RefusesOthers) {
    for (const char* text : {":", "/", "3", "a:b", "1:2:3", "5:5", "6:2", "-1:3", "0/3", "4/3",
                             "0/0", " 1:2", "1:2 ", "1:99999999999"}) {
        EXPECT_THROW(checkBucketRange(text), CallError) << text;
        EXPECT_THROW(bucketRange(text, 100), CallError) << text;
    }
    EXPECT_THROW(bucketRange("0:8", 7), CallError);
    EXPECT_THROW(bucketRange("1/9", 7), CallError);  // empty
}

TEST(BucketRange, MissingRunsAreJoined) {
    EXPECT_TRUE(missingRanges({true, true}).empty());
    EXPECT_EQ(missingRanges({false, false, true, false, true, false}),
              (std::vector<BucketRange>{{0, 2}, {3, 4}, {5, 6}}));
}

}  // namespace

}  // namespace pm::plugin::test
