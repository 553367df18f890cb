// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The settings of a render, each written down once: the header's enumeration, the checks, the
// manual and every host's panel come from here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace pm::plugin {

inline constexpr std::uint32_t kMaxThreads = 1024;
inline constexpr std::int64_t kMaxFramePixels = 65536;  // along either side

enum class Setting : std::size_t {
    kWidth,
    kHeight,
    kCrop,
    kThreads,
    kBucketSize,
    kBucketOrder,
    kAaLevel,
    kAaLevelMost,
    kAaThreshold,
    kFilter,
    kIntegrator,
    kPhotons,
    kEstimatePhotons,
    kGatherRays,
    kPasses,
    kSeed,
    kLayers,
    kMemoryLimit,
    kErrorTarget,
    kTimeLimit,
    kPlan,
    kBuckets,
    kPart,
    kCheckpoint,
    kResume,
    kHostIdentity,
    kDelivery,
    kPhotonMap,
    kPhotonsOnly,
    kHostNote,
    kPhotonPages,
    kScratchFolder,
    kHostPeak,
    kInputHashes,
    kErrorScale,
    kCount
};
inline constexpr std::size_t kSettingCount = static_cast<std::size_t>(Setting::kCount);

// The numbers are those of PMR_SETTING_* in pm_plugin.h.
enum class SettingType : std::int32_t { kInteger, kNumber, kChoice, kText };

// One setting; texts end with 0 and live as long as the library.
struct SettingSpec {
    Setting id;
    const char* name;
    SettingType type;
    const char* unit;
    const char* defaultText;
    std::int64_t minimum;  // INTEGER and NUMBER, both ends allowed
    std::int64_t maximum;
    std::int64_t step;  // INTEGER: a multiple of it
    const char* choices;
    bool changesPixels;
    const char* help;
    const char* cost;
};

// In the order of Setting.
std::span<const SettingSpec, kSettingCount> settingSpecs();

// Null where there is none of that name.
const SettingSpec* findSetting(std::string_view name);

}  // namespace pm::plugin
