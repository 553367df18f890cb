// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the statistics of renders and of merged parts share.
#pragma once

#include <optional>

#include "plugin/session/setting_values.h"
#include "plugin/values/json.h"
#include "scheduler/film/frame_error.h"

namespace pm::plugin {

Json settingsJson(const SettingValues& values);

// Adds the estimates of the error; with one pass nothing is known of it.
void addError(const std::optional<FrameError>& error, Json& json);

}  // namespace pm::plugin
