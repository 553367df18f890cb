// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/fp_environment.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>

#include "scheduler/buckets/worker_arena.h"

#if defined(__SSE__)

namespace pm {
namespace {

constexpr unsigned kClean = 0x1f80;
constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040, kTowardsZero = 0x6000;
constexpr unsigned kStickyFlags = 0x003f;

// A host with other modes, for the length of a scope.
class HostModes {
  public:
    explicit HostModes(unsigned mxcsr) : m_saved(_mm_getcsr()) { _mm_setcsr(mxcsr); }
    ~HostModes() { _mm_setcsr(m_saved); }

  private:
    unsigned m_saved;
};

// The bits of two floats: where denormals count as zero, floats compare equal that are not.
struct Sample {
    std::uint32_t halfDenormal, third;
    friend bool operator==(const Sample&, const Sample&) = default;
};

// Two operations that tell the modes apart; volatile, or the compiler does them in advance.
Sample compute() {
    volatile float denormal = 0x1p-146f;  // 8 times the smallest
    volatile float one = 1.0f, three = 3.0f, two = 2.0f;
    const float halfDenormal = denormal / two, third = one / three;
    return {std::bit_cast<std::uint32_t>(halfDenormal), std::bit_cast<std::uint32_t>(third)};
}

const Sample kRight{4, 0x3eaaaaab};

TEST(FpEnvironment, setsModesAndRestoresTheCallers) {
    const unsigned dirty = kClean | kFlushToZero | kDenormalsAreZero | kTowardsZero;
    const HostModes host(dirty);
    EXPECT_NE(compute(), kRight);  // the broken twin: without the guard the bits differ
    {
        _mm_setcsr(dirty | 0x01);  // a sticky flag of the host's own
        const FpEnvironment guard;
        EXPECT_EQ(_mm_getcsr(), kClean);
        EXPECT_EQ(compute(), kRight);
        EXPECT_NE(_mm_getcsr() & kStickyFlags, 0u);  // ours: inexact, underflow
    }
    EXPECT_EQ(_mm_getcsr(), dirty | 0x01);
}

TEST(FpEnvironment, masksTrapsOfTheCaller) {
    const HostModes host(0x0000);  // everything unmasked: the division would end the process
    const FpEnvironment guard;
    volatile float zero = 0.0f;
    EXPECT_EQ(1.0f / zero, std::numeric_limits<float>::infinity());
}

TEST(FpEnvironment, nests) {
    const HostModes host(kClean | kFlushToZero);
    {
        const FpEnvironment outer;
        { const FpEnvironment inner; }
        EXPECT_EQ(_mm_getcsr() & ~kStickyFlags, kClean);
    }
    EXPECT_EQ(_mm_getcsr(), kClean | kFlushToZero);
}

// Every thread of an arena that a dirty host made and uses, TBB's own included.
TEST(FpEnvironment, holdsInEveryTaskOfAnArena) {
    // The test as a host that lets TBB have more threads than the machine has.
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            8);
    const unsigned dirty = kClean | kFlushToZero | kDenormalsAreZero | kTowardsZero;
    const HostModes host(dirty);
    WorkerArena arena(8);
    std::atomic<int> wrong{0};
    arena.execute([&] {
        oneapi::tbb::parallel_for(0, 4000, [&](int) {
            if (!(compute() == kRight)) ++wrong;
        });
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(_mm_getcsr(), dirty);
}

}  // namespace
}  // namespace pm

#endif
