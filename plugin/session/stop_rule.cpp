// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/stop_rule.h"

#include <algorithm>

namespace pm::plugin {

namespace {
// At level 1 a pixel has its one sample in one of so many passes.
constexpr std::uint32_t kPassesOfLevel1 = 4;
// Of a pixel, for its error to be known.
constexpr std::uint32_t kPassesToKnowError = 2;
}  // namespace

StopRule::StopRule(const SettingValues& values)
    : m_passLimit(values.passLimit()),
      m_leastPasses(values.integer(Setting::kAaLevel) > 1 ? 1 : kPassesOfLevel1),
      m_errorTarget(values.number(Setting::kErrorTarget)),
      m_timeLimitSeconds(values.number(Setting::kTimeLimit)) {
    if (values.limitsPasses()) m_passes = m_passLimit;
}

StopReason StopRule::after(const PassEnd& end) const {
    if (end.passesDone >= m_passLimit) return StopReason::kPasses;
    if (m_errorTarget > 0 && end.passesDone >= kPassesToKnowError * m_leastPasses && end.error &&
        end.error->total() <= m_errorTarget)
        return StopReason::kErrorTarget;
    if (m_timeLimitSeconds > 0 && end.passesDone >= m_leastPasses &&
        end.seconds + end.longestPassSeconds > m_timeLimitSeconds)
        return StopReason::kTimeLimit;
    return StopReason::kNone;
}

std::optional<double> StopRule::passesToErrorTarget(const PassEnd& end) const {
    if (m_errorTarget <= 0 || !end.error) return std::nullopt;
    const double bias = std::max(0.0, end.error->bias);
    // Bias above the target falls as well, but nobody knows how fast: taken as if it were noise.
    const double share = bias < m_errorTarget ? end.error->noise / (m_errorTarget - bias)
                                              : end.error->total() / m_errorTarget;
    return std::max(end.passesDone * share, static_cast<double>(end.passesDone));
}

}  // namespace pm::plugin
