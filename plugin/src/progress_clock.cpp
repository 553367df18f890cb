// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/progress_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pm::plugin {

namespace {
constexpr double kFirstGuess = 0.3;     // share of the photons in a pass
constexpr double kQuietSeconds = 2.0;   // too early to tell what remains
constexpr double kLeastPasses = 1e-3;   // as well
constexpr double kMostOnTheWay = 0.99;  // of a target that may lie further than foreseen
}  // namespace

ProgressClock::ProgressClock(const Ends& ends, bool hasPhotons, std::function<double()> seconds)
    : m_seconds(std::move(seconds)), m_ends(ends), m_photonShare(hasPhotons ? kFirstGuess : 0.0) {}

void ProgressClock::startAt(std::uint32_t passes) {
    const std::lock_guard lock(m_mutex);
    m_first = passes;
}

ProgressClock::Reading ProgressClock::photons(std::uint32_t pass, double fraction) {
    const std::lock_guard lock(m_mutex);
    return advance(pass + m_photonShare * std::clamp(fraction, 0.0, 1.0));
}

ProgressClock::Reading ProgressClock::buckets(std::uint32_t pass, double fraction) {
    const std::lock_guard lock(m_mutex);
    return advance(pass + m_photonShare + (1.0 - m_photonShare) * std::clamp(fraction, 0.0, 1.0));
}

void ProgressClock::endPass(double photonSeconds, double bucketSeconds,
                            std::optional<double> errorPasses) {
    const std::lock_guard lock(m_mutex);
    m_photonSeconds += photonSeconds;
    m_bucketSeconds += bucketSeconds;
    const double all = m_photonSeconds + m_bucketSeconds;
    if (m_photonShare > 0.0 && all > 0.0) m_photonShare = m_photonSeconds / all;
    m_ends.errorPasses = errorPasses;
}

ProgressClock::Reading ProgressClock::advance(double passes) {
    const double elapsed = m_seconds();
    const double made = passes - m_first;
    const bool knowsSpeed = elapsed >= kQuietSeconds && made >= kLeastPasses;
    double fraction = 0, remaining = std::numeric_limits<double>::infinity();
    const auto endsAfter = [&](double wanted, double most) {
        fraction = std::max(fraction, std::min(passes / wanted, most));
        if (knowsSpeed)
            remaining = std::min(remaining, elapsed * std::max(0.0, (wanted - passes) / made));
    };
    if (m_ends.passes) endsAfter(*m_ends.passes, 1);
    if (m_ends.errorPasses) endsAfter(*m_ends.errorPasses, kMostOnTheWay);
    if (m_ends.seconds) {
        fraction = std::max(fraction, std::min(elapsed / *m_ends.seconds, kMostOnTheWay));
        if (elapsed >= kQuietSeconds)
            remaining = std::min(remaining, std::max(0.0, *m_ends.seconds - elapsed));
    }
    m_fraction = std::clamp(fraction, m_fraction, 1.0);
    return {m_fraction,
            std::isinf(remaining) ? std::numeric_limits<double>::quiet_NaN() : remaining};
}

}  // namespace pm::plugin
