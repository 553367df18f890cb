// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Render::statisticsJson: the library's part of "pm-stats/1". Keys carry their units; the schema is
// only ever appended to.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "plugin/session/memory_limit.h"
#include "plugin/session/render.h"
#include "plugin/session/render_identity.h"
#include "plugin/session/statistics_json.h"
#include "plugin/values/call_error.h"
#include "plugin/values/processor.h"
#include "plugin/values/version.h"

namespace pm::plugin {

namespace {

const char* stopText(StopReason reason) {
    switch (reason) {
        case StopReason::kPasses:
            return "passes done";
        case StopReason::kErrorTarget:
            return "error target";
        case StopReason::kTimeLimit:
            return "time limit";
        case StopReason::kCancelled:
            return "cancelled";
        case StopReason::kFailed:
            return "failed";
        default:
            return "running";
    }
}

Json countersJson(const RenderCounters& c) {
    return {{"cameraSamples", c.cameraSamples},
            {"rays", c.rays},
            {"badSamples", c.badSamples.total()},
            {"photonsEmitted", c.photonsEmitted},
            {"photonsStoredGlobal", c.photonsStoredGlobal},
            {"photonsStoredCaustic", c.photonsStoredCaustic},
            {"photonsLost", c.photonsLost},
            {"pathsCut", c.pathsCut},
            {"throughputCut", c.throughputCut},
            {"fluxEmittedW", c.fluxEmitted},
            {"fluxAbsorbedW", c.fluxAbsorbed},
            {"fluxEscapedW", c.fluxEscaped},
            {"fluxLostW", c.fluxLost}};
}

Json badSamplesJson(const BadSamples& bad) {
    constexpr std::array<const char*, kSampleFaults> kFaults{"NaN", "infinite", "negative"};
    constexpr std::array<const char*, 4> kParts{"emission", "direct", "caustic", "indirect"};
    Json json;
    for (std::size_t i = 0; i < kSampleFaults; ++i)
        if (bad.counts[i] > 0) json["counts"][kFaults[i]] = bad.counts[i];
    const BadSamples::Place& first = *bad.first;
    json["first"] = {{"x", first.x},
                     {"y", first.y},
                     {"pass", first.pass},
                     {"sample", first.sample},
                     {"fault", kFaults[static_cast<std::size_t>(first.what.fault)]},
                     {"part", kParts[static_cast<std::size_t>(first.what.part)]}};
    return json;
}

Json bucketJson(const RenderWork& work, const RenderWork::Progress& progress) {
    Json json = {{"count", work.bucketCount()},
                 {"sizePixels", work.bucketSize()},
                 {"idleTailThreadSeconds", progress.idleSeconds}};
    std::vector<double> seconds = progress.secondsPerBucket;
    if (seconds.empty()) return json;
    std::sort(seconds.begin(), seconds.end());
    json["minimumSecondsPerPass"] = seconds.front();
    json["medianSecondsPerPass"] = seconds[seconds.size() / 2];
    json["maximumSecondsPerPass"] = seconds.back();
    return json;
}

Json memoryJson(const RenderWork& work, const RenderCounters& counters) {
    const MemoryNeed& need = work.memory().need;
    return {{"sceneBytes", need.scene},          {"frameBytes", need.frame},
            {"mapBytes", counters.peakMapBytes}, {"plannedMapBytes", need.maps},
            {"bucketBytes", need.buckets},       {"plannedTextureBytes", need.textures},
            {"processBytes", need.process},      {"peakResidentBytes", peakResidentBytes()}};
}

Json texturesJson(const SceneTextures& textures,
                  const std::array<std::uint64_t, kCacheUsers>& missesOf) {
    const TextureReads reads = textures.reads();
    return {{"texels", textures.texels()},
            {"texelsRead", reads.texelsOnce},
            {"misses", reads.tiles},
            {"bytesRead", reads.bytes},
            {"tilesReadOnce", reads.tilesOnce},
            {"bytesReadOnce", reads.bytesOnce},
            {"missesOf", missesOfJson(missesOf)}};
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

Json planJson(const Plan& plan, const RenderCounters& counters) {
    return {{"tracePhotons", plan.tracePhotons},
            {"globalMap", plan.globalMap},
            {"causticMap", plan.causticMap},
            {"globalPhotonsPerPass", plan.globalPhotons},
            {"gatherRaysPerPoint", counters.gatherRaysOfPoint},
            {"gatherRaysGuided", counters.gatherRaysGuided},
            {"photonsInFocus", counters.photonsInFocus},
            {"causticPhotonsPerPass", plan.causticPhotons},
            {"lampSamples", counters.lampSamples},
            {"lines", plan.reasons}};
}

// Of a render with a photon map. Its hash is not among the render's: the picture is the same
// without.
void addPhotons(const RenderPhotons& photons, const RenderWork::Progress& progress, Json& json) {
    if (photons.file().empty()) return;
    json["photonMap"] = {
        {"file", photons.file()},
        {"use", photons.isOnly() ? "written" : "read"},
        {"passesHeld", photons.passesHeld()},
        {"fileBytes", photons.bytes()},
        {"hash", photons.isOnly() ? progress.photonHash : photons.hash(progress.passesDone)}};
}

Json curveJson(const ErrorCurve& curve) {
    Json json = Json::array();
    for (const ErrorCurve::Point& point : curve.points()) {
        const auto& e = point.error;
        json.push_back({{"passes", point.passes},
                        {"seconds", point.seconds},
                        {"processorSeconds", point.processorSeconds},
                        {"estimatedRelMse", e ? Json(e->total()) : Json(nullptr)},
                        {"noise", e ? Json(e->noise) : Json(nullptr)},
                        {"bias", e ? Json(e->bias) : Json(nullptr)}});
    }
    return json;
}

void addPasses(const RenderWork& work, const RenderWork::Progress& progress, Json& json) {
    json["passesDone"] = progress.passesDone;
    json["passesResumed"] = progress.passesResumed;
    json["passesPlanned"] = work.passCount();
    json["threads"] = work.threads();
    json["delivery"] = work.memory().byBuckets ? "buckets" : "frame";
    // Of a torn picture it would be that of its finished buckets alone.
    const bool isTorn = work.memory().byBuckets && progress.passesDone == 0;
    std::optional<FrameError> error = progress.lastError;
    if (!error && !isTorn) error = work.estimateError();
    addError(error, work.plan().errorScale, json);
    json["errorCurve"] = curveJson(progress.curve);
}

}  // namespace

Render::End Render::endSoFar() const {
    End end;
    RenderState state = RenderState::kCreated;
    stateAndStatus(state, end.status);
    const std::lock_guard lock(m_mutex);
    end.errorText = m_errorText;
    end.totalSeconds =
        state == RenderState::kFinished
            ? m_totalSeconds
            : std::chrono::duration<double>(std::chrono::steady_clock::now() - m_startTime).count();
    return end;
}

std::string Render::statisticsJson() const {
    const std::shared_ptr<RenderWork> running = work();
    if (!running) throw CallError(CallStatus::kState, "there are no statistics before startRender");
    const End end = endSoFar();
    const RenderWork::Progress progress = running->progress();
    const RenderCounters counters = running->counters();
    Json json;
    json["schema"] = "pm-stats/1";
    json["versions"] = versionsJson();
    json["hashes"] = {
        {"scene", identityHash(m_scene->identity)},
        {"settings", identityHash(settingsIdentity(settings().with(running->plan().errorScale)))}};
    if (settings().integer(Setting::kInputHashes) != 0)
        for (const IdentityPart& part :
             sceneInputs(*m_scene->scene, *m_scene->textures, m_scene->tables))
            json["hashes"][part.name.c_str()] = part.value;
    addPhotons(running->photons(), progress, json);
    json["isa"] = running->scene().isa();
    json["processorVendors"] = Json::array();
    json["processorVendors"].push_back(processorVendor());
    json["stopReason"] = stopText(stopReason());
    json["status"] = static_cast<std::int32_t>(end.status);
    json["error"] = end.errorText;
    addPasses(*running, progress, json);
    json["phases"] = {
        {"buildSeconds", m_scene->buildSeconds},   {"photonSeconds", counters.photonSeconds},
        {"mapSeconds", counters.mapSeconds},       {"beginPassSeconds", progress.photonSeconds},
        {"renderSeconds", progress.bucketSeconds}, {"totalSeconds", end.totalSeconds}};
    json["counters"] = countersJson(counters);
    if (counters.badSamples.total() > 0) json["badSamples"] = badSamplesJson(counters.badSamples);
    json["counters"]["textureFailures"] = m_scene->textures->failureCount();
    json["counters"]["triangles"] = running->scene().triangleCount();
    json["buckets"] = bucketJson(*running, progress);
    json["memory"] = memoryJson(*running, counters);
    json["textureCache"] = texturesJson(*m_scene->textures, running->texelMissesOf());
    // Of triangles that are cut where rays meet them; by all renders of the scene.
    json["geometryCache"] =
        cacheJson(m_scene->scene->groupCounts(), m_scene->scene->groupBudget(), "bytesMade");
    if (const RenderPages* const pages = running->pages())
        json["photonPages"] = pages->statistics();
    if (const RenderCaches* const caches = running->caches()) json["caches"] = caches->statistics();
    json["plan"] = planJson(running->plan(), counters);
    json["warnings"] = warningsJson(running->scene(), *running);
    json["settings"] = settingsJson(settings());
    return json.dump(2);
}

}  // namespace pm::plugin
