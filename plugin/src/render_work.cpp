// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/render_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <optional>
#include <utility>

#include "integrator/values/error.h"
#include "integrator/values/stopwatch.h"
#include "plugin/src/call_error.h"
#include "plugin/src/frame_samples.h"
#include "plugin/src/memory_limit.h"
#include "plugin/src/pass_samples.h"
#include "scheduler/bucket_order.h"
#include "scheduler/correlated_choice.h"

namespace pm::plugin {

namespace {

const BucketOrder& orderNamed(const std::string& name) {
    const BucketOrder* order = findBucketOrder(name);
    if (order == nullptr)
        throw CallError(PMR_ERROR_INTERNAL, fmt::format("bucket order '{}' is not there", name));
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

RenderWork::RenderWork(std::shared_ptr<const Scene> scene, const Identity& sceneIdentity,
                       const SettingValues& values)
    : m_processorStart(processorSeconds()),
      m_scene(std::move(scene)),
      m_settings(values.toRenderSettings()),
      m_stopRule(values),
      m_plan(makePlan(*m_scene, m_settings)),
      m_arena(static_cast<int>(values.integer(Setting::kThreads))),
      m_grid(bucketsOf(values)),
      m_memory(planMemory(*m_scene, m_plan, values, m_grid)),
      m_layout(channelLayout(m_settings)),
      m_photons(values, sceneIdentity, *m_scene, m_plan),
      m_clock(endsOf(m_stopRule, m_settings.isAdaptive()), m_plan.tracePhotons) {
    m_memory.check();
    if (m_photons.isOnly()) {
        makeRenderer();
        return;
    }
    const BucketOrder& order = orderNamed(values.word(Setting::kBucketOrder));
    m_order = order.cells(m_grid.columns(), m_grid.rows(), m_settings.seed);
    m_isCorrelated = order.isCorrelated;
    if (!m_memory.byBuckets)
        m_pieces =
            std::make_unique<RenderPieces>(values, sceneIdentity, m_grid, m_isCorrelated, m_order);
    m_orderIndex.resize(m_grid.cellCount());
    for (std::uint32_t i = 0; i < m_order.size(); ++i) m_orderIndex[m_order[i]] = i;
    makeRenderer();
    if (m_memory.byBuckets) {
        m_buckets = std::make_unique<BucketPasses>(
            BucketPasses::Frame{m_settings, m_grid, m_order, m_orderIndex, m_arena.threads(),
                                m_plan.tracePhotons},
            m_memory.bucketsHeld);
        return;
    }
    m_frame = std::make_shared<FrameStore>(makeFrame(m_settings, m_plan.tracePhotons));
    const Scratch scratch{std::vector<float>(static_cast<std::size_t>(kAtomPixels) *
                                             static_cast<std::size_t>(m_layout.count)),
                          std::vector<SampleRun>(kAtomPixels)};
    m_scratch.assign(static_cast<std::size_t>(m_arena.threads()), scratch);
}

void RenderWork::makeRenderer() {
    m_renderer = m_arena.execute(
        [this] { return std::make_unique<FrameRenderer>(m_scene, m_settings, m_plan); });
    if (m_photons.source() != nullptr) m_renderer->readPhotons(*m_photons.source());
}

void RenderWork::warn(const Notice& notice, EventQueue& events) {
    const auto code = static_cast<std::int32_t>(notice.code);
    m_warnings.add(code, notice.text);
    events.message(PMR_LEVEL_WARNING, code, notice.text);
}

void RenderWork::announce(EventQueue& events) {
    for (const Notice& notice : m_plan.notices) warn(notice, events);
}

void RenderWork::warnOfCheckpoint(const std::string& text, EventQueue& events) {
    m_warnings.add(PMR_MESSAGE_CHECKPOINT, text);
    events.message(PMR_LEVEL_WARNING, PMR_MESSAGE_CHECKPOINT, text);
}

std::uint32_t RenderWork::resume(const Cancel& cancel, EventQueue& events) {
    const RenderPieces::Resumed resumed =
        m_pieces->resume(*m_frame, static_cast<std::size_t>(m_layout.count), cancel.flag);
    if (resumed.droppedBytes > 0)
        warnOfCheckpoint(fmt::format("the checkpoint's last {} bytes were torn or damaged; what "
                                     "they held is rendered again",
                                     resumed.droppedBytes),
                         events);
    const bool hasPart = resumed.shareOfNext > 0;
    if (resumed.passes == 0 && !hasPart) return 0;
    events.message(PMR_LEVEL_INFO, PMR_MESSAGE_PHASE,
                   fmt::format("resumed with {} passes and {:.0f} % of the next", resumed.passes,
                               100 * resumed.shareOfNext));
    if (const auto limit = m_stopRule.passes();
        limit && resumed.passes + (hasPart ? 1 : 0) > *limit)
        throw CallError(
            PMR_ERROR_MISMATCH,
            fmt::format("the checkpoint has {} passes{}; {} were asked for, and none "
                        "can be taken back",
                        resumed.passes, hasPart ? " and a part of the next" : "", *limit));
    m_clock.startAt(resumed.passes, resumed.shareOfNext);
    for (const std::uint32_t cell : m_order)
        events.bucketFinished(
            bucketInfo(cell, m_grid.cellRect(cell), resumed.passes == 0 ? 0 : resumed.passes - 1));
    const std::lock_guard lock(m_mutex);
    m_progress.passesDone = m_progress.passesResumed = resumed.passes;
    return resumed.passes;
}

std::shared_ptr<const FrameStore> RenderWork::frame() const {
    return m_buckets ? m_buckets->shelf().shown() : m_frame;
}

std::optional<FrameError> RenderWork::estimateError() const {
    if (m_photons.isOnly()) return std::nullopt;
    return m_buckets ? m_buckets->estimateError() : m_frame->estimateError();
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
    // However it ends, the checkpoint is free for another render.
    const struct Close {
        RenderWork& work;
        const Cancel& cancel;
        EventQueue& events;
        ~Close() { work.closePieces(cancel, events); }
    } close{*this, cancel, events};
    const std::uint32_t pass = resume(cancel, events);
    // Between two passes a resumed render ends as it would have; within one it can't.
    const bool isBetween = pass > 0 && !m_pieces->isWithinPass();
    if (!isBetween || !endPass(pass - 1, 0, 0)) makePasses(pass, cancel, events);
    const std::uint32_t passes = progress().passesDone;
    m_pieces->finish(*m_frame, passes, m_photons.hash(passes));
}

// Who cancels doesn't wait for disks.
void RenderWork::closePieces(const Cancel& cancel, EventQueue& events) noexcept {
    m_pieces->close(cancel.flag);
    try {
        if (const std::string text = m_pieces->takeTrouble(); !text.empty())
            warnOfCheckpoint("the checkpoint may not be whole: " + text, events);
    } catch (...) {
        // Without memory for the text there is no telling.
    }
}

void RenderWork::makePasses(std::uint32_t first, const Cancel& cancel, EventQueue& events) {
    m_photons.check(cancel.flag);
    for (std::uint32_t pass = first;; ++pass) {
        cancel.throwIfSet();
        const double photonSeconds = beginPass(pass, cancel, events);
        const double bucketSeconds = renderBuckets(pass, cancel, events);
        for (const Notice& notice : m_renderer->takeNotices()) warn(notice, events);
        cancel.throwIfSet();
        m_pieces->endPass(*m_frame, pass + 1, cancel.flag);
        if (const std::string text = m_pieces->takeTrouble(); !text.empty())
            warnOfCheckpoint("the render goes on without checkpoint: " + text, events);
        if (endPass(pass, photonSeconds, bucketSeconds)) return;
    }
}

bool RenderWork::endPass(std::uint32_t pass, double photonSeconds, double bucketSeconds) {
    PassEnd end;
    end.passesDone = pass + 1;
    const bool inCurve = progress().curve.wants(end.passesDone);
    if (inCurve || m_stopRule.hasErrorTarget()) end.error = estimateError();
    end.seconds = m_watch.seconds();
    const std::uint32_t made = end.passesDone - progress().passesResumed;
    end.longestPassSeconds =
        made == 0 ? 0 : std::max(end.seconds / made, photonSeconds + bucketSeconds);
    const std::int32_t stop = m_stopRule.after(end);
    const bool isLast = stop != PMR_STOP_NONE;
    if (isLast && !end.error) end.error = estimateError();
    m_clock.endPass(
        photonSeconds, bucketSeconds, m_stopRule.passesToErrorTarget(end),
        isLast || !m_frame ? 1.0 : samplesOverPassBefore(m_settings, *m_frame, end.passesDone));

    const std::lock_guard lock(m_mutex);
    m_progress.passesDone = end.passesDone;
    m_progress.stopReason = stop;
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

double RenderWork::beginPass(std::uint32_t pass, const Cancel& cancel, EventQueue& events) {
    const Stopwatch watch;
    if (m_plan.tracePhotons)
        events.message(PMR_LEVEL_INFO, PMR_MESSAGE_PHASE, passName(pass) + ": photons");
    m_arena.execute([&] {
        m_renderer->beginPass(pass, cancel.flag, [&](double fraction) {
            const ProgressClock::Reading reading = m_clock.photons(pass, fraction);
            events.progress(reading.fraction, reading.remainingSeconds);
        });
    });
    const double seconds = watch.seconds();
    for (const Notice& notice : m_renderer->takeNotices()) warn(notice, events);
    const std::lock_guard lock(m_mutex);
    m_progress.photonSeconds += seconds;
    return seconds;
}

// bucket: whole atoms, of which the host gets what lies in the window.
PmrBucketInfo RenderWork::bucketInfo(std::uint32_t cell, const Rect& bucket,
                                     std::uint32_t pass) const {
    const Rect rect = intersect(bucket, m_settings.window);
    PmrBucketInfo info{};
    info.size = sizeof info;
    info.rectangle = {rect.x0, rect.y0, rect.x1, rect.y1};
    info.bucketIndex = m_orderIndex[cell];
    info.bucketCount = bucketCount();
    info.passIndex = pass;
    info.passCount = m_settings.passes;
    return info;
}

// A bucket's buffer: its pixels' floats, then its pixels' weights.
void RenderWork::renderAtom(const Rect& rect, const Rect& atom, std::uint32_t pass, int worker,
                            std::span<float> buffer, const Cancel& cancel) {
    Scratch& scratch = m_scratch[static_cast<std::size_t>(worker)];
    findSamples(m_settings, *m_frame, pass, atom, scratch.runs);
    m_renderer->renderRegion(atom, scratch.runs, scratch.pixels, cancel.flag);
    const auto floats = static_cast<std::ptrdiff_t>(kAtomSizePixels) * m_layout.count;
    const auto weightsAt = static_cast<std::ptrdiff_t>(rect.area()) * m_layout.count;
    for (std::ptrdiff_t row = 0; row < kAtomSizePixels; ++row) {
        const std::ptrdiff_t to = (atom.y0 + row - rect.y0) * rect.width() + (atom.x0 - rect.x0);
        std::copy_n(scratch.pixels.begin() + row * floats, floats,
                    buffer.begin() + to * m_layout.count);
        const auto runs = scratch.runs.begin() + row * kAtomSizePixels;
        std::transform(runs, runs + kAtomSizePixels, buffer.begin() + weightsAt + to,
                       [](SampleRun run) { return run.weight(); });
    }
}

double RenderWork::renderBuckets(std::uint32_t pass, const Cancel& cancel, EventQueue& events) {
    const Stopwatch watch;
    const auto channels = static_cast<std::size_t>(m_layout.count);
    std::atomic<std::uint32_t> done{0};
    const std::vector<std::uint32_t> order = m_pieces->remaining(m_order);
    done += static_cast<std::uint32_t>(m_order.size() - order.size());
    std::optional<CorrelatedChoice> correlated;
    if (m_isCorrelated) correlated.emplace(m_grid, order, m_arena.threads());
    BucketWork work;
    work.floatsPerPixel = m_layout.count + 1;
    if (correlated) work.choose = [&](int worker) { return correlated->next(worker); };
    work.started = [&](std::uint32_t cell, const Rect& rect) {
        events.bucketStarted(bucketInfo(cell, rect, pass));
    };
    work.render = [&](std::uint32_t, const Rect& rect, const Rect& atom, int worker,
                      std::span<float> buffer) {
        renderAtom(rect, atom, pass, worker, buffer, cancel);
    };
    work.deliver = [&](std::uint32_t cell, const Rect& rect, std::span<const float> buffer) {
        const auto area = static_cast<std::size_t>(rect.area());
        const auto weights = buffer.subspan(area * channels, area);
        m_pieces->takeBucket(
            pass, rect, buffer, channels, [&](const Rect& part, std::span<const float> floats) {
                const auto values = static_cast<std::size_t>(part.area()) * channels;
                m_frame->addPass(pass, part, floats.first(values), floats.subspan(values));
            });
        if (correlated)
            correlated->finished(cell, buffer, channels, static_cast<std::size_t>(m_layout.beauty));
        PmrBucketInfo info = bucketInfo(cell, rect, pass);
        double samples = 0;
        for (const float weight : weights) samples += weight;
        info.sampleCount = static_cast<std::uint64_t>(samples);
        events.bucketFinished(info);
        const ProgressClock::Reading reading =
            m_clock.buckets(pass, static_cast<double>(++done) / bucketCount());
        events.progress(reading.fraction, reading.remainingSeconds);
    };
    m_clock.buckets(pass, static_cast<double>(done) / bucketCount());
    const BucketRun result = runBuckets(m_arena, m_grid, order, cancel.token, work);
    const double seconds = watch.seconds();

    const std::lock_guard lock(m_mutex);
    m_progress.bucketSeconds += seconds;
    m_progress.idleSeconds += result.idleSeconds;
    if (order.size() != m_order.size()) return seconds;
    std::vector<double>& means = m_progress.secondsPerBucket;
    means.resize(result.seconds.size());
    ++m_timedPasses;
    for (std::size_t i = 0; i < means.size(); ++i)
        means[i] += (result.seconds[i] - means[i]) / m_timedPasses;
    return seconds;
}

RenderWork::Progress RenderWork::progress() const {
    const std::lock_guard lock(m_mutex);
    return m_progress;
}

}  // namespace pm::plugin
