// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the statistics of renders and of merged parts share.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "integrator/caches/bounded_cache.h"
#include "integrator/values/error_scale.h"
#include "plugin/session/setting_values.h"
#include "plugin/values/json.h"
#include "scheduler/film/frame_error.h"

namespace pm::plugin {

Json settingsJson(const SettingValues& values);

// For whom a cache missed, by the names of kCacheUserNames.
Json missesOfJson(const std::array<std::uint64_t, kCacheUsers>& misses);

// budget: bytes. made: the name of what it made or read, in bytes.
Json cacheJson(const CacheCounts& counts, std::uint64_t budget, const char* made);

// Adds the estimates of the error, and the scale that they are of; with one pass nothing is known
// of them.
void addError(const std::optional<FrameError>& error, const ErrorScale& scale, Json& json);

}  // namespace pm::plugin
