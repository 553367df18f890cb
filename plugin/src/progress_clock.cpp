// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/progress_clock.h"

#include <algorithm>
#include <limits>

namespace pm::plugin {

namespace {
constexpr double kFirstGuess = 0.3;      // share of the photons in a pass
constexpr double kQuietSeconds = 2.0;    // too early to tell what remains
constexpr double kLeastFraction = 1e-3;  // as well
}  // namespace

ProgressClock::ProgressClock(std::uint32_t passCount, bool hasPhotons)
    : m_passCount(passCount), m_photonShare(hasPhotons ? kFirstGuess : 0.0) {}

ProgressClock::Reading ProgressClock::photons(std::uint32_t pass, double fraction) {
    const std::lock_guard lock(m_mutex);
    return advance((pass + m_photonShare * std::clamp(fraction, 0.0, 1.0)) / m_passCount);
}

ProgressClock::Reading ProgressClock::buckets(std::uint32_t pass, double fraction) {
    const std::lock_guard lock(m_mutex);
    return advance((pass + m_photonShare + (1.0 - m_photonShare) * std::clamp(fraction, 0.0, 1.0)) /
                   m_passCount);
}

void ProgressClock::endPass(double photonSeconds, double bucketSeconds) {
    const std::lock_guard lock(m_mutex);
    m_photonSeconds += photonSeconds;
    m_bucketSeconds += bucketSeconds;
    const double all = m_photonSeconds + m_bucketSeconds;
    if (m_photonShare > 0.0 && all > 0.0) m_photonShare = m_photonSeconds / all;
}

ProgressClock::Reading ProgressClock::advance(double fraction) {
    m_fraction = std::clamp(fraction, m_fraction, 1.0);
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - m_start).count();
    if (elapsed < kQuietSeconds || m_fraction < kLeastFraction)
        return {m_fraction, std::numeric_limits<double>::quiet_NaN()};
    return {m_fraction, elapsed * (1.0 - m_fraction) / m_fraction};
}

}  // namespace pm::plugin
