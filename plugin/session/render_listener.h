// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "plugin/session/bucket_info.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

// The numbers are those of the levels of the same names in pm_plugin.h.
enum class MessageLevel : std::int32_t { kDebug, kInfo, kWarning, kError };

// Codes of the messages that a render has beside those of notices (NoticeCode).
inline constexpr std::int32_t kMessageNone = 0;
inline constexpr std::int32_t kMessageTexture = 106;
inline constexpr std::int32_t kMessageCheckpoint = 108;
inline constexpr std::int32_t kMessagePhase = 200;

// Who is told how a render goes; each may be empty. Called one at a time (see EventQueue); what
// they throw ends there.
struct RenderListener {
    std::function<void(MessageLevel level, std::int32_t code, const std::string& text)> message;
    // remainingSeconds: NaN where it is not known yet.
    std::function<void(double fraction, double remainingSeconds)> progress;
    std::function<void(const BucketInfo&)> bucketStarted, bucketFinished;
    std::function<void(CallStatus)> finished;
};

}  // namespace pm::plugin
