// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#if defined(__SSE__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace pm {

// While it lives, the calling thread rounds to nearest, keeps denormals and raises no traps; then
// the caller's modes come back. A host may have set others (many audio and graphics hosts flush
// denormals to zero), and they would change the bits of a picture.
//
// The sticky exception flags start clear and are restored to what they were: what our arithmetic
// raises does not show in the host's. The x87 unit is left alone on x86: nothing of ours computes
// with it.
// Threads: holds for the thread that made it, and must end on that thread.
class FpEnvironment {
  public:
#if defined(__SSE__)
    FpEnvironment() noexcept : m_saved(_mm_getcsr()) {
        _mm_setcsr(kDefaultMxcsr);
    }
    ~FpEnvironment() {
        _mm_setcsr(m_saved);
    }
#else
    FpEnvironment() noexcept {
        std::fegetenv(&m_saved);
        std::fesetenv(FE_DFL_ENV);
    }
    ~FpEnvironment() {
        std::fesetenv(&m_saved);
    }
#endif
    FpEnvironment(const FpEnvironment&) = delete;
    FpEnvironment& operator=(const FpEnvironment&) = delete;

  private:
#if defined(__SSE__)
    // The value at reset: all six exceptions masked (bits 7 to 12), rounding to nearest, neither
    // flush-to-zero (15) nor denormals-are-zero (6), no sticky flag (0 to 5).
    static constexpr unsigned kDefaultMxcsr = 0x1f80;
    unsigned m_saved;
#else
    std::fenv_t m_saved;
#endif
};

}  // namespace pm
