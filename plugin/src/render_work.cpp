// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/render_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "integrator/values/error.h"
#include "integrator/values/stopwatch.h"
#include "plugin/src/call_error.h"
#include "plugin/src/memory_limit.h"
#include "scheduler/bucket_order.h"

namespace pm::plugin {

namespace {

std::vector<std::uint32_t> cellsInOrder(const BucketGrid& grid, const std::string& name) {
    const BucketOrder* order = findBucketOrder(name);
    if (order == nullptr)
        throw CallError(PMR_ERROR_INTERNAL, fmt::format("bucket order '{}' is not there", name));
    return order->cells(grid.columns(), grid.rows());
}

void throwIfCancelled(const Cancel& cancel) {
    if (cancel.isSet()) throw Error(Status::kCancelled, "the render was cancelled");
}

double processorSeconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

ProgressClock::Ends endsOf(const StopRule& rule) {
    ProgressClock::Ends ends;
    if (rule.passes()) ends.passes = *rule.passes();
    if (rule.timeLimitSeconds() > 0) ends.seconds = rule.timeLimitSeconds();
    return ends;
}

}  // namespace

RenderWork::RenderWork(std::shared_ptr<const Scene> scene, const SettingValues& values)
    : m_processorStart(processorSeconds()),
      m_scene(std::move(scene)),
      m_settings(values.toRenderSettings()),
      m_stopRule(values),
      m_plan(makePlan(*m_scene, m_settings)),
      m_arena(static_cast<int>(values.integer(Setting::kThreads))),
      m_grid(m_settings.window, static_cast<std::int32_t>(values.integer(Setting::kBucketSize))),
      m_layout(channelLayout(m_settings)),
      m_clock(endsOf(m_stopRule), m_plan.tracePhotons) {
    checkMemory(values);
    m_order = cellsInOrder(m_grid, values.word(Setting::kBucketOrder));
    m_orderIndex.resize(m_order.size());
    for (std::uint32_t i = 0; i < m_order.size(); ++i) m_orderIndex[m_order[i]] = i;
    m_renderer =
        m_arena.execute([this] { return std::make_unique<FrameRenderer>(m_scene, m_settings); });
    m_frame = std::make_unique<FrameStore>(m_settings.window, m_layout.count, m_layout.beauty,
                                           m_layout.biasProbe, m_layout.emission);
    m_scratch.resize(static_cast<std::size_t>(m_arena.threads()));
}

void RenderWork::checkMemory(const SettingValues& values) {
    const auto bucketSize = static_cast<std::uint64_t>(m_grid.bucketSize());
    m_need.scene = m_scene->memoryBytes();
    m_need.frame = FrameStore::memoryBytes(m_settings.window, m_layout.count, m_layout.biasProbe);
    m_need.maps = m_plan.mapBytes;
    m_need.buckets = static_cast<std::uint64_t>(m_arena.threads()) * bucketSize * bucketSize *
                         static_cast<std::uint64_t>(m_layout.count + 1) * sizeof(float) +
                     m_grid.cellCount() * sizeof(PmrBucketInfo) * 2;
    const std::uint64_t limit = memoryLimitBytes(values.number(Setting::kMemoryLimit));
    if (m_need.total() > limit)
        throw CallError(
            PMR_ERROR_MEMORY,
            fmt::format("the render needs {:.2f} GiB (scene {:.2f}, frame {:.2f}, photon maps "
                        "{:.2f}, buckets {:.2f}); the memory limit is {:.2f} GiB",
                        toGib(m_need.total()), toGib(m_need.scene), toGib(m_need.frame),
                        toGib(m_need.maps), toGib(m_need.buckets), toGib(limit)));
}

void RenderWork::warn(const Notice& notice, EventQueue& events) {
    const auto code = static_cast<std::int32_t>(notice.code);
    m_warnings.add(code, notice.text);
    events.message(PMR_LEVEL_WARNING, code, notice.text);
}

void RenderWork::announce(EventQueue& events) {
    for (const Notice& notice : m_plan.notices) warn(notice, events);
}

void RenderWork::run(const Cancel& cancel, EventQueue& events) {
    for (std::uint32_t pass = 0;; ++pass) {
        throwIfCancelled(cancel);
        const double photonSeconds = beginPass(pass, cancel, events);
        const double bucketSeconds = renderBuckets(pass, cancel, events);
        for (const Notice& notice : m_renderer->takeNotices()) warn(notice, events);
        throwIfCancelled(cancel);
        if (endPass(pass, photonSeconds, bucketSeconds)) return;
    }
}

bool RenderWork::endPass(std::uint32_t pass, double photonSeconds, double bucketSeconds) {
    PassEnd end;
    end.passesDone = pass + 1;
    const bool inCurve = progress().curve.wants(end.passesDone);
    if (inCurve || m_stopRule.hasErrorTarget()) end.error = m_frame->estimateError();
    end.seconds = m_watch.seconds();
    end.longestPassSeconds = std::max(end.seconds / end.passesDone, photonSeconds + bucketSeconds);
    const std::int32_t stop = m_stopRule.after(end);
    const bool isLast = stop != PMR_STOP_NONE;
    if (isLast && !end.error) end.error = m_frame->estimateError();
    m_clock.endPass(photonSeconds, bucketSeconds, m_stopRule.passesToErrorTarget(end));

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

PmrBucketInfo RenderWork::bucketInfo(std::uint32_t cell, const Rect& rect,
                                     std::uint32_t pass) const {
    PmrBucketInfo info{};
    info.size = sizeof info;
    info.rectangle = {rect.x0, rect.y0, rect.x1, rect.y1};
    info.bucketIndex = m_orderIndex[cell];
    info.bucketCount = bucketCount();
    info.passIndex = pass;
    info.passCount = m_settings.passes;
    return info;
}

// A bucket's buffer: its pixels' floats, then its pixels' weights. Always whole atoms are rendered,
// so that rays travel in the same company whatever the crop.
void RenderWork::renderBucket(const Rect& rect, int worker, std::span<float> buffer,
                              const Cancel& cancel) {
    const auto channels = static_cast<std::size_t>(m_layout.count);
    const auto area = static_cast<std::size_t>(rect.area());
    const std::span<float> pixels = buffer.first(area * channels);
    const std::span<float> weights = buffer.subspan(area * channels, area);
    const Rect atoms = wholeAtoms(rect);
    if (atoms == rect) {
        m_renderer->renderRegion(rect, pixels, weights, cancel.flag);
        return;
    }
    Scratch& scratch = m_scratch[static_cast<std::size_t>(worker)];
    scratch.pixels.assign(static_cast<std::size_t>(atoms.area()) * channels, 0.0f);
    scratch.weights.assign(static_cast<std::size_t>(atoms.area()), 0.0f);
    m_renderer->renderRegion(atoms, scratch.pixels, scratch.weights, cancel.flag);
    const auto width = static_cast<std::size_t>(rect.width());
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        const auto from =
            static_cast<std::ptrdiff_t>((y - atoms.y0) * atoms.width() + (rect.x0 - atoms.x0));
        const auto to = static_cast<std::ptrdiff_t>((y - rect.y0) * rect.width());
        const auto step = static_cast<std::ptrdiff_t>(channels);
        std::copy_n(scratch.pixels.begin() + from * step, width * channels,
                    pixels.begin() + to * step);
        std::copy_n(scratch.weights.begin() + from, width, weights.begin() + to);
    }
}

double RenderWork::renderBuckets(std::uint32_t pass, const Cancel& cancel, EventQueue& events) {
    const Stopwatch watch;
    const auto channels = static_cast<std::size_t>(m_layout.count);
    std::atomic<std::uint32_t> done{0};
    BucketWork work;
    work.floatsPerPixel = m_layout.count + 1;
    work.started = [&](std::uint32_t cell, const Rect& rect) {
        events.bucketStarted(bucketInfo(cell, rect, pass));
    };
    work.render = [&](std::uint32_t, const Rect& rect, int worker, std::span<float> buffer) {
        renderBucket(rect, worker, buffer, cancel);
    };
    work.deliver = [&](std::uint32_t cell, const Rect& rect, std::span<const float> buffer) {
        const auto area = static_cast<std::size_t>(rect.area());
        const auto weights = buffer.subspan(area * channels, area);
        m_frame->addPass(rect, buffer.first(area * channels), weights);
        PmrBucketInfo info = bucketInfo(cell, rect, pass);
        double samples = 0;
        for (const float weight : weights) samples += weight;
        info.sampleCount = static_cast<std::uint64_t>(samples);
        events.bucketFinished(info);
        const ProgressClock::Reading reading =
            m_clock.buckets(pass, static_cast<double>(++done) / bucketCount());
        events.progress(reading.fraction, reading.remainingSeconds);
    };
    const BucketRun result = runBuckets(m_arena, m_grid, m_order, cancel.token, work);
    const double seconds = watch.seconds();

    const std::lock_guard lock(m_mutex);
    m_progress.bucketSeconds += seconds;
    std::vector<double>& means = m_progress.secondsPerBucket;
    means.resize(result.seconds.size());
    for (std::size_t i = 0; i < means.size(); ++i)
        means[i] += (result.seconds[i] - means[i]) / (pass + 1.0);
    return seconds;
}

RenderWork::Progress RenderWork::progress() const {
    const std::lock_guard lock(m_mutex);
    return m_progress;
}

}  // namespace pm::plugin
