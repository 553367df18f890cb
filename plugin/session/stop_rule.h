// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>

#include "plugin/session/setting_values.h"
#include "scheduler/film/frame_error.h"

namespace pm::plugin {

// What is known when a pass has ended.
// Why a render ended. The numbers are those of PMR_STOP_* in pm_plugin.h.
enum class StopReason : std::int32_t {
    kNone,  // it has not
    kPasses,
    kErrorTarget,
    kTimeLimit,
    kCancelled,
    kFailed,
};

struct PassEnd {
    std::uint32_t passesDone = 0;     // this one included
    double seconds = 0;               // since the render was started
    double longestPassSeconds = 0;    // of the mean pass and of the latest, the longer
    std::optional<FrameError> error;  // where it is known
};

// When a render ends: after so many passes, at an error or at a time, whichever comes first. It is
// asked between passes only, so that every picture is one of whole passes. A plain value.
class StopRule {
  public:
    explicit StopRule(const SettingValues& values);

    // kPasses, kErrorTarget or kTimeLimit; kNone where another pass is to come. The time limit ends
    // a render before a pass that wouldn't fit.
    StopReason after(const PassEnd& end) const;

    bool hasErrorTarget() const { return m_errorTarget > 0; }
    double timeLimitSeconds() const { return m_timeLimitSeconds; }  // 0 = none
    // Passes at most; nothing where only a target or a limit ends the render.
    std::optional<std::uint32_t> passes() const { return m_passes; }
    // Passes in all until the error target is reached, noise falling as 1/passes and bias staying;
    // nothing where there is no target or too little is known.
    std::optional<double> passesToErrorTarget(const PassEnd& end) const;

  private:
    std::optional<std::uint32_t> m_passes;
    std::uint32_t m_passLimit = 0;    // m_passes, or the most there can be
    std::uint32_t m_leastPasses = 0;  // that make a picture without holes
    double m_errorTarget = 0;         // relMSE
    double m_timeLimitSeconds = 0;
};

}  // namespace pm::plugin
