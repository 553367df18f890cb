// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Render::statisticsJson: the library's part of "pm-stats/1". Keys carry their units; the schema is
// only ever appended to.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plugin/src/call_error.h"
#include "plugin/src/identity.h"
#include "plugin/src/memory_limit.h"
#include "plugin/src/render.h"
#include "plugin/src/version.h"

namespace pm::plugin {

namespace {

using Json = nlohmann::ordered_json;

const char* stopReason(std::int32_t state, PmrStatus status) {
    if (state != PMR_RENDER_FINISHED) return "running";
    if (status == PMR_OK) return "finished";
    return status == PMR_ERROR_CANCELLED ? "cancelled" : "failed";
}

Json countersJson(const RenderCounters& c) {
    return {{"cameraSamples", c.cameraSamples},
            {"rays", c.rays},
            {"badSamples", c.badSamples},
            {"photonsEmitted", c.photonsEmitted},
            {"photonsStoredGlobal", c.photonsStoredGlobal},
            {"photonsStoredCaustic", c.photonsStoredCaustic},
            {"photonsLost", c.photonsLost},
            {"fluxEmittedW", c.fluxEmitted},
            {"fluxAbsorbedW", c.fluxAbsorbed},
            {"fluxEscapedW", c.fluxEscaped},
            {"fluxLostW", c.fluxLost}};
}

Json bucketJson(const RenderWork& work, std::vector<double> seconds) {
    Json json = {{"count", work.bucketCount()}};
    if (seconds.empty()) return json;
    std::sort(seconds.begin(), seconds.end());
    json["minimumSecondsPerPass"] = seconds.front();
    json["medianSecondsPerPass"] = seconds[seconds.size() / 2];
    json["maximumSecondsPerPass"] = seconds.back();
    return json;
}

Json memoryJson(const RenderWork& work, const RenderCounters& counters) {
    const MemoryNeed& need = work.memoryNeed();
    return {{"sceneBytes", need.scene},          {"frameBytes", need.frame},
            {"mapBytes", counters.peakMapBytes}, {"plannedMapBytes", need.maps},
            {"bucketBytes", need.buckets},       {"peakResidentBytes", peakResidentBytes()}};
}

Json warningsJson(const Scene& scene, RenderWork& work) {
    auto entries = work.warnings().entries();
    for (const Notice& notice : scene.notices()) {
        WarningLog::Entry& entry = entries[static_cast<std::int32_t>(notice.code)];
        ++entry.count;
        if (entry.texts.size() < WarningLog::kTextsKept) entry.texts.push_back(notice.text);
    }
    Json json = Json::array();
    for (const auto& [code, entry] : entries)
        json.push_back({{"code", code}, {"count", entry.count}, {"texts", entry.texts}});
    return json;
}

Json planJson(const Plan& plan) {
    return {{"tracePhotons", plan.tracePhotons},
            {"globalMap", plan.globalMap},
            {"causticMap", plan.causticMap},
            {"globalPhotonsPerPass", plan.globalPhotons},
            {"sitePhotonsPerPass", plan.sitePhotons},
            {"causticPhotonsPerPass", plan.causticPhotons},
            {"lines", plan.reasons}};
}

Json settingsJson(const SettingValues& values) {
    Json json = Json::object();
    for (const SettingSpec& spec : settingSpecs()) {
        if (spec.type == PMR_SETTING_INTEGER)
            json[spec.name] = values.integer(spec.id);
        else if (spec.type == PMR_SETTING_NUMBER)
            json[spec.name] = values.number(spec.id);
        else
            json[spec.name] = values.word(spec.id);
    }
    return json;
}

Json relMseJson(const FrameStore& frame) {
    const auto estimate = frame.estimatedRelMse();
    return estimate ? Json(*estimate) : Json(nullptr);
}

}  // namespace

std::string Render::statisticsJson() const {
    const std::shared_ptr<RenderWork> running = work();
    if (!running) throw CallError(PMR_ERROR_STATE, "there are no statistics before startRender");
    std::int32_t state = 0;
    PmrStatus status = PMR_OK;
    stateAndStatus(state, status);
    std::string errorText;
    double totalSeconds = 0;
    {
        const std::lock_guard lock(m_mutex);
        errorText = m_errorText;
        totalSeconds =
            state == PMR_RENDER_FINISHED
                ? m_totalSeconds
                : std::chrono::duration<double>(std::chrono::steady_clock::now() - m_startTime)
                      .count();
    }
    const RenderWork::Timings timings = running->timings();
    const RenderCounters counters = running->counters();
    Json json;
    json["schema"] = "pm-stats/1";
    json["versions"] = versionsJson();
    json["hashes"] = {{"scene", m_scene->hash()}, {"settings", settingsHash(settings())}};
    json["isa"] = running->scene().isa();
    json["stopReason"] = stopReason(state, status);
    json["status"] = status;
    json["error"] = errorText;
    json["passesDone"] = timings.passesDone;
    json["passesPlanned"] = running->passCount();
    json["threads"] = running->threads();
    json["relMseEstimate"] = relMseJson(running->frame());
    json["relMseEstimateCovers"] =
        "noise only, from the spread between passes; bias of the photon estimates is not in it";
    json["phases"] = {
        {"buildSeconds", m_scene->buildSeconds()}, {"photonSeconds", counters.photonSeconds},
        {"mapSeconds", counters.mapSeconds},       {"beginPassSeconds", timings.photonSeconds},
        {"renderSeconds", timings.bucketSeconds},  {"totalSeconds", totalSeconds}};
    json["counters"] = countersJson(counters);
    json["counters"]["textureFailures"] = m_scene->textureFailures();
    json["counters"]["triangles"] = running->scene().triangleCount();
    json["buckets"] = bucketJson(*running, timings.secondsPerBucket);
    json["memory"] = memoryJson(*running, counters);
    json["plan"] = planJson(running->plan());
    json["warnings"] = warningsJson(running->scene(), *running);
    json["settings"] = settingsJson(settings());
    // Names of files may hold bytes that are no UTF-8; they are replaced rather than thrown at.
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace pm::plugin
