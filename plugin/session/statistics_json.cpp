// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/statistics_json.h"

namespace pm::plugin {

namespace {

constexpr const char* kEstimateCovers =
    "noise, from what even and odd passes differ by, and bias of the density estimates, from what "
    "they change by at radii narrowed by sqrt(2), and what was cut off; not light that no pass has "
    "found, nor what is finer than the narrower radius, of which it is a lower bound";

}  // namespace

Json settingsJson(const SettingValues& values) {
    Json json = Json::object();
    for (const SettingSpec& spec : settingSpecs()) {
        if (spec.type == SettingType::kInteger)
            json[spec.name] = values.integer(spec.id);
        else if (spec.type == SettingType::kNumber)
            json[spec.name] = values.number(spec.id);
        else
            json[spec.name] = values.word(spec.id);
    }
    return json;
}

Json missesOfJson(const std::array<std::uint64_t, kCacheUsers>& misses) {
    Json json;
    for (std::size_t i = 0; i < kCacheUsers; ++i) json[kCacheUserNames[i]] = misses[i];
    return json;
}

Json cacheJson(const CacheCounts& counts, std::uint64_t budget, const char* made) {
    return {{"budgetBytes", budget},
            {"misses", counts.misses},
            {"madeAgain", counts.madeAgain},
            {"waits", counts.waits},
            {made, counts.bytesMade},
            {"bytesHeld", counts.bytesHeld},
            {"mostBytesHeld", counts.mostBytesHeld},
            {"missesOf", missesOfJson(counts.missesOf)}};
}

void addError(const std::optional<FrameError>& error, const ErrorScale& scale, Json& json) {
    const auto put = [&](const char* key, auto figure) {
        json[key] = error ? Json(figure(*error)) : Json(nullptr);
    };
    put("relMseEstimate", [](const FrameError& e) { return Json(e.total()); });
    put("relMseEstimateTrimmed", [](const FrameError& e) { return Json(e.totalTrimmed()); });
    put("relMseEstimateNoise", [](const FrameError& e) { return Json(e.noise); });
    put("relMseEstimateBias", [](const FrameError& e) { return Json(e.bias); });
    put("relMseEstimateCut", [](const FrameError& e) { return Json(e.cut); });
    put("relMseEstimateBiasStandardError", [](const FrameError& e) {
        return e.biasStandardError ? Json(*e.biasStandardError) : Json(nullptr);
    });
    put("relMseEstimateDegreesOfFreedom", [](const FrameError& e) {
        return e.noiseDegreesOfFreedom ? Json(*e.noiseDegreesOfFreedom) : Json(nullptr);
    });
    put("relMseEstimateUnresolvedShare",
        [](const FrameError& e) { return Json(e.unresolvedShare); });
    put("relMseEstimateIsLowerBound", [](const FrameError& e) { return Json(e.isLowerBound()); });
    json["relMseEstimateCovers"] = kEstimateCovers;
    json["errorScaleStops"] = scale.stops();
}

}  // namespace pm::plugin
