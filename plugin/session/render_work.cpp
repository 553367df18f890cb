// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/render_work.h"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <optional>
#include <utility>

#include "integrator/values/error.h"
#include "integrator/values/stopwatch.h"
#include "plugin/session/frame_samples.h"
#include "plugin/session/memory_limit.h"
#include "plugin/session/pass_samples.h"
#include "plugin/values/call_error.h"
#include "scheduler/buckets/bucket_order.h"

namespace pm::plugin {

namespace {

const BucketOrder& orderNamed(const std::string& name) {
    const BucketOrder* order = findBucketOrder(name);
    if (order == nullptr)
        throw CallError(CallStatus::kInternal, fmt::format("bucket order '{}' is not there", name));
    return *order;
}

double processorSeconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Buckets of adaptive passes over those of the first, which knows nothing yet.
constexpr double kAdaptiveGrowth = 1.25;

ProgressClock::Ends endsOf(const StopRule& rule, bool isAdaptive) {
    ProgressClock::Ends ends;
    if (isAdaptive) ends.growth = kAdaptiveGrowth;
    if (rule.passes()) ends.passes = *rule.passes();
    if (rule.timeLimitSeconds() > 0) ends.seconds = rule.timeLimitSeconds();
    return ends;
}

}  // namespace

RenderWork::RenderWork(const RenderScene& scene, const SettingValues& values,
                       const std::optional<Plan>& plan)
    : m_processorStart(processorSeconds()),
      m_scene(scene.scene),
      m_settings(values.toRenderSettings()),
      m_stopRule(values),
      m_arena(static_cast<int>(values.integer(Setting::kThreads))),
      m_plan(plan ? *plan : planOf(scene, values, m_arena)),
      m_grid(bucketsOf(values)),
      m_memory(planMemory(*m_scene, m_plan, values, m_grid, scene.textures->texelBytes())),
      m_layout(channelLayout(m_settings)),
      m_pages(m_memory.pages > 0 ? std::make_unique<RenderPages>(values, m_memory) : nullptr),
      m_photons(values, scene.identity, *m_scene, m_plan),
      m_clock(endsOf(m_stopRule, m_settings.isAdaptive()), m_plan.tracePhotons) {
    m_memory.check();
    if (m_photons.isOnly()) {
        makeRenderer();
        return;
    }
    orderBuckets(scene.identity, values);
    makeRenderer();
    makePlaces();
}

void RenderWork::orderBuckets(const Identity& sceneIdentity, const SettingValues& values) {
    const BucketOrder& order = orderNamed(values.word(Setting::kBucketOrder));
    m_order = order.cells(m_grid.columns(), m_grid.rows(), m_settings.seed);
    m_isCorrelated = order.isCorrelated;
    if (!m_memory.byBuckets)
        m_pieces = std::make_unique<RenderPieces>(values.with(m_plan.errorScale), sceneIdentity,
                                                  m_grid, m_isCorrelated, m_order);
    m_orderIndex.resize(m_grid.cellCount());
    for (std::uint32_t i = 0; i < m_order.size(); ++i) m_orderIndex[m_order[i]] = i;
}

// Where pixels go: a frame, or places for buckets.
void RenderWork::makePlaces() {
    m_bucketMisses = std::make_unique<BucketMisses>(m_grid.cellCount());
    if (m_memory.byBuckets) {
        m_buckets = std::make_unique<BucketPasses>(
            BucketPasses::Frame{m_settings, m_grid, m_order, m_orderIndex, *m_bucketMisses,
                                m_arena.threads(), m_plan.tracePhotons, m_plan.errorScale},
            m_memory.bucketsHeld);
        return;
    }
    m_frame =
        std::make_shared<FrameStore>(makeFrame(m_settings, m_plan.tracePhotons, m_plan.errorScale));
    m_bucketTimes.resize(m_grid.cellCount());
    if (m_isCorrelated && m_scene->groupCache())
        m_bucketNeeds = std::make_unique<BucketNeeds>(m_grid, *m_scene->groupCache());
    const Scratch scratch{std::vector<float>(static_cast<std::size_t>(kAtomPixels) *
                                             static_cast<std::size_t>(m_layout.count)),
                          std::vector<SampleRun>(kAtomPixels)};
    m_scratch.assign(static_cast<std::size_t>(m_arena.threads()), scratch);
}

void RenderWork::makeRenderer() {
    m_renderer = m_arena.execute(
        [this] { return std::make_unique<FrameRenderer>(m_scene, m_settings, m_plan); });
    if (m_pages)
        m_renderer->pageMaps(
            {&m_pages->paging(), m_memory.roomForSites,
             static_cast<float>(m_order.size()) / static_cast<float>(m_grid.cellCount())});
    if (m_photons.source() != nullptr) m_renderer->readPhotons(*m_photons.source());
}

void RenderWork::warn(const Notice& notice, EventQueue& events) {
    const auto code = static_cast<std::int32_t>(notice.code);
    m_warnings.add(code, notice.text);
    events.message(MessageLevel::kWarning, code, notice.text);
}

void RenderWork::announce(EventQueue& events) {
    for (const Notice& notice : m_plan.notices) warn(notice, events);
}

void RenderWork::warnOfCheckpoint(const std::string& text, EventQueue& events) {
    m_warnings.add(kMessageCheckpoint, text);
    events.message(MessageLevel::kWarning, kMessageCheckpoint, text);
}

std::shared_ptr<const FrameStore> RenderWork::frame() const {
    return m_buckets ? m_buckets->shelf().shown() : m_frame;
}

std::optional<FrameError> RenderWork::estimateError(bool inParallel) const {
    if (m_photons.isOnly()) return std::nullopt;
    std::optional<FrameError> error =
        m_buckets ? m_buckets->estimateError() : m_frame->estimateError(inParallel);
    if (error) error->cut = std::pow(counters().shareCut(), 2);
    return error;
}

void RenderWork::beforeDelivery(std::uint32_t bucketIndex) {
    if (m_buckets) m_buckets->shelf().show(bucketIndex);
}

void RenderWork::afterDelivery(std::uint32_t bucketIndex) {
    if (m_buckets) m_buckets->shelf().release(bucketIndex);
}

std::uint32_t RenderWork::passesOfPixels() const {
    return m_buckets ? m_settings.passes : progress().passesDone;
}

void RenderWork::run(const Cancel& cancel, EventQueue& events) {
    if (m_photons.isOnly()) return runPhotonsOnly(cancel, events);
    if (m_buckets) return runByBuckets(cancel, events);
    runByPasses(cancel, events);
}

bool RenderWork::endPass(std::uint32_t pass, double photonSeconds, double bucketSeconds) {
    PassEnd end;
    end.passesDone = pass + 1;
    const bool inCurve = progress().curve.wants(end.passesDone);
    const auto estimate = [&] { return m_arena.execute([&] { return estimateError(true); }); };
    if (inCurve || m_stopRule.hasErrorTarget()) end.error = estimate();
    end.seconds = m_watch.seconds();
    const std::uint32_t made = end.passesDone - progress().passesResumed;
    end.longestPassSeconds =
        made == 0 ? 0 : std::max(end.seconds / made, photonSeconds + bucketSeconds);
    const StopReason stop = m_stopRule.after(end);
    const bool isLast = stop != StopReason::kNone;
    if (isLast && !end.error) end.error = estimate();
    m_clock.endPass(
        photonSeconds, bucketSeconds, m_stopRule.passesToErrorTarget(end),
        isLast || !m_frame ? 1.0 : samplesOverPassBefore(m_settings, *m_frame, end.passesDone));

    const std::lock_guard lock(m_mutex);
    m_progress.passesDone = end.passesDone;
    m_progress.stopReason = stop;
    if (isLast) m_progress.lastError = end.error;
    if (inCurve || isLast)
        m_progress.curve.add(
            {end.passesDone, end.seconds, processorSeconds() - m_processorStart, end.error});
    return isLast;
}

std::string RenderWork::passName(std::uint32_t pass) const {
    if (const auto passes = m_stopRule.passes())
        return fmt::format("pass {} of {}", pass + 1, *passes);
    return fmt::format("pass {}", pass + 1);
}

RenderWork::Progress RenderWork::progress() const {
    const std::lock_guard lock(m_mutex);
    return m_progress;
}

}  // namespace pm::plugin
