// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/progress_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pm::plugin {

namespace {
constexpr double kFirstGuess = 0.3;      // share of the photons in a pass
constexpr double kQuietSeconds = 2.0;    // too early to tell what remains
constexpr double kLeastShare = 1e-3;     // of a phase, as well
constexpr double kForeseenWeight = 0.1;  // of a phase: as much does what was foreseen count for
constexpr double kMostOnTheWay = 0.99;   // of a target that may lie further than foreseen
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
// Passes before the first one that goes by what others have found.
constexpr std::uint32_t kEvenPasses = 1;
}  // namespace

std::optional<double> ProgressClock::Phase::cost(double now) const {
    const double share = done - from, seconds = now - start;
    if (foreseen) return (seconds + kForeseenWeight * *foreseen) / (share + kForeseenWeight);
    if (share < kLeastShare) return std::nullopt;
    return seconds / share;
}

ProgressClock::ProgressClock(const Ends& ends, bool hasPhotons, std::function<double()> seconds)
    : m_seconds(std::move(seconds)),
      m_hasPhotons(hasPhotons),
      m_ends(ends),
      m_photonShare(hasPhotons ? kFirstGuess : 0.0),
      m_inBuckets(!hasPhotons) {}

void ProgressClock::startAt(std::uint32_t passes, double shareOfNext) {
    const std::lock_guard lock(m_mutex);
    if (passes >= kEvenPasses) m_ends.growth = 1.0;
    m_buckets.from = m_buckets.done = shareOfNext;
}

ProgressClock::Reading ProgressClock::photons(std::uint32_t pass, double fraction) {
    const std::lock_guard lock(m_mutex);
    return advance(pass, false, std::clamp(fraction, 0.0, 1.0));
}

ProgressClock::Reading ProgressClock::buckets(std::uint32_t pass, double fraction) {
    const std::lock_guard lock(m_mutex);
    return advance(pass, true, std::clamp(fraction, 0.0, 1.0));
}

void ProgressClock::endPass(double photonSeconds, double bucketSeconds,
                            std::optional<double> errorPasses, double nextOverThis) {
    const std::lock_guard lock(m_mutex);
    m_ends.errorPasses = errorPasses;
    const double share = 1.0 - m_buckets.from;
    if (photonSeconds + bucketSeconds <= 0.0 || share <= 0.0) return;
    m_photonSeconds += photonSeconds;
    m_bucketSeconds += bucketSeconds;
    if (m_photonShare > 0.0) m_photonShare = m_photonSeconds / (m_photonSeconds + m_bucketSeconds);
    const double now = m_seconds();
    m_photons = {now, 0, 0, photonSeconds};
    m_buckets = {now, 0, 0, bucketSeconds / share * nextOverThis};
    m_inBuckets = !m_hasPhotons;
}

ProgressClock::Costs ProgressClock::costs(std::uint32_t pass, bool inBuckets, double now) const {
    Costs costs;
    if (m_hasPhotons)
        costs.photons =
            inBuckets ? m_buckets.start - m_photons.start : m_photons.cost(now).value_or(kUnknown);
    // Before there is anything to go by: as the guess has it.
    const double guess =
        m_hasPhotons ? costs.photons * (1.0 - kFirstGuess) / kFirstGuess : kUnknown;
    costs.buckets = (inBuckets ? m_buckets.cost(now) : m_buckets.foreseen).value_or(guess);
    costs.thisPass = costs.buckets * (1.0 - m_buckets.done);
    if (!inBuckets) costs.thisPass += costs.photons * (1.0 - m_photons.done);
    costs.growth = pass < kEvenPasses ? m_ends.growth : 1.0;
    return costs;
}

// All passes end whole.
double ProgressClock::Costs::toTheEndOf(std::uint32_t pass, double wanted) const {
    const double later = std::max(0.0, std::ceil(wanted) - pass - 1);
    const double even = std::min(later, std::max(0.0, kEvenPasses - 1.0 - pass));
    return thisPass + later * photons + (even + (later - even) * growth) * buckets;
}

// No pass is begun that wouldn't fit.
double ProgressClock::Costs::untilLimit(std::uint32_t pass, double left) const {
    const double next = photons + buckets * (pass + 1 < kEvenPasses ? 1.0 : growth);
    if (!(next > 0)) return left;
    return thisPass + next * std::floor(std::max(0.0, left - thisPass) / next);
}

ProgressClock::Reading ProgressClock::advance(std::uint32_t pass, bool inBuckets, double fraction) {
    const double now = m_seconds();
    if (inBuckets && !std::exchange(m_inBuckets, true)) m_buckets.start = now;
    Phase& phase = inBuckets ? m_buckets : m_photons;
    phase.done = std::max(phase.done, fraction);
    const double passes = inBuckets ? pass + m_photonShare + (1.0 - m_photonShare) * fraction
                                    : pass + m_photonShare * fraction;
    const Costs costs = this->costs(pass, inBuckets, now);
    double share = 0, seconds = std::numeric_limits<double>::infinity();
    const auto endsAfter = [&](double wanted, double most) {
        share = std::max(share, std::min(passes / wanted, most));
        seconds = std::min(seconds, costs.toTheEndOf(pass, wanted));
    };
    if (m_ends.passes) endsAfter(*m_ends.passes, 1);
    if (m_ends.errorPasses) endsAfter(*m_ends.errorPasses, kMostOnTheWay);
    if (m_ends.seconds) {
        const double left = std::max(0.0, *m_ends.seconds - now);
        share = std::max(share, std::min(now / *m_ends.seconds, kMostOnTheWay));
        seconds =
            std::min(seconds, std::isnan(costs.thisPass) ? left : costs.untilLimit(pass, left));
    }
    m_fraction = std::clamp(share, m_fraction, 1.0);
    const bool isKnown = now >= kQuietSeconds && std::isfinite(seconds);
    return {m_fraction, isKnown ? seconds : kUnknown};
}

}  // namespace pm::plugin
