// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// RenderWork with the whole frame: pass after pass, each of them photons first, then the buckets.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <optional>

#include "plugin/session/frame_samples.h"
#include "plugin/session/render_work.h"
#include "plugin/values/call_error.h"
#include "scheduler/film/correlated_choice.h"

namespace pm::plugin {

std::uint32_t RenderWork::resume(const Cancel& cancel, EventQueue& events) {
    const RenderPieces::Resumed resumed =
        m_pieces->resume(*m_frame, static_cast<std::size_t>(m_layout.count), cancel.flag);
    if (resumed.replacesOther)
        warnOfCheckpoint(fmt::format("{}: a checkpoint was there; it is begun anew, as it was not "
                                     "asked to resume",
                                     resumed.file),
                         events);
    if (resumed.droppedBytes > 0)
        warnOfCheckpoint(fmt::format("{}: the checkpoint's last {} bytes were torn or damaged; "
                                     "what they held is rendered again",
                                     resumed.file, resumed.droppedBytes),
                         events);
    if (resumed.foundNone)
        events.message(MessageLevel::kInfo, kMessagePhase,
                       fmt::format("{}: no checkpoint was there to resume; the render begins anew",
                                   resumed.file));
    const bool hasPart = resumed.shareOfNext > 0;
    if (resumed.passes == 0 && !hasPart) return 0;
    events.message(MessageLevel::kInfo, kMessagePhase,
                   fmt::format("resumed with {} passes and {:.0f} % of the next", resumed.passes,
                               100 * resumed.shareOfNext));
    if (const auto limit = m_stopRule.passes();
        limit && resumed.passes + (hasPart ? 1 : 0) > *limit)
        throw CallError(
            CallStatus::kMismatch,
            fmt::format("{}: the checkpoint has {} passes{}; {} were asked for, and none "
                        "can be taken back",
                        resumed.file, resumed.passes, hasPart ? " and a part of the next" : "",
                        *limit));
    m_clock.startAt(resumed.passes, resumed.shareOfNext);
    for (const std::uint32_t cell : m_order)
        events.bucketFinished(
            bucketInfo(cell, m_grid.cellRect(cell), resumed.passes == 0 ? 0 : resumed.passes - 1));
    const std::lock_guard lock(m_mutex);
    m_progress.passesDone = m_progress.passesResumed = resumed.passes;
    return resumed.passes;
}

void RenderWork::runByPasses(const Cancel& cancel, EventQueue& events) {
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

double RenderWork::beginPass(std::uint32_t pass, const Cancel& cancel, EventQueue& events) {
    const Stopwatch watch;
    if (m_plan.tracePhotons)
        events.message(MessageLevel::kInfo, kMessagePhase, passName(pass) + ": photons");
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
BucketInfo RenderWork::bucketInfo(std::uint32_t cell, const Rect& bucket,
                                  std::uint32_t pass) const {
    BucketInfo info;
    info.rectangle = intersect(bucket, m_settings.window);
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

// The buckets of one pass as they come: what all of them share.
struct RenderWork::PassRun {
    std::uint32_t pass;
    const Cancel& cancel;
    EventQueue& events;
    std::optional<CorrelatedChoice> correlated{};
    std::atomic<std::uint32_t> done{0};  // buckets, resumed ones included
};

void RenderWork::deliverBucket(PassRun& run, const RenderedBucket& bucket) {
    if (m_caches) m_caches->bucketDone();
    const std::span<const float> buffer = bucket.pixels;
    const auto channels = static_cast<std::size_t>(m_layout.count);
    const auto area = static_cast<std::size_t>(bucket.rect.area());
    const auto weights = buffer.subspan(area * channels, area);
    m_pieces->takeBucket(run.pass, bucket.rect, buffer, channels,
                         [&](const Rect& part, std::span<const float> floats) {
                             const auto values = static_cast<std::size_t>(part.area()) * channels;
                             m_frame->addPass(run.pass, part, floats.first(values),
                                              floats.subspan(values));
                         });
    if (run.correlated)
        run.correlated->finished(bucket.cell, buffer, channels,
                                 static_cast<std::size_t>(m_layout.beauty));
    BucketInfo info = bucketInfo(bucket.cell, bucket.rect, run.pass);
    double samples = 0;
    for (const float weight : weights) samples += weight;
    info.sampleCount = static_cast<std::uint64_t>(samples);
    BucketTime& time = m_bucketTimes[bucket.cell];
    info.seconds = time.seconds += bucket.seconds;
    info.timedPasses = ++time.passes;
    const BucketMisses::Count missed = m_bucketMisses->of(bucket.cell);
    info.cacheMisses = missed.misses;
    info.cacheBytes = missed.bytes;
    run.events.bucketFinished(info);
    const ProgressClock::Reading reading =
        m_clock.buckets(run.pass, static_cast<double>(++run.done) / bucketCount());
    run.events.progress(reading.fraction, reading.remainingSeconds);
}

void RenderWork::countBuckets(const BucketRun& result, double seconds, bool ofWholeFrame) {
    const std::lock_guard lock(m_mutex);
    m_progress.bucketSeconds += seconds;
    m_progress.idleSeconds += result.idleSeconds;
    if (!ofWholeFrame) return;
    std::vector<double>& means = m_progress.secondsPerBucket;
    means.resize(result.seconds.size());
    ++m_timedPasses;
    for (std::size_t i = 0; i < means.size(); ++i)
        means[i] += (result.seconds[i] - means[i]) / m_timedPasses;
}

double RenderWork::renderBuckets(std::uint32_t pass, const Cancel& cancel, EventQueue& events) {
    const Stopwatch watch;
    const std::vector<std::uint32_t> order = m_pieces->remaining(m_order);
    PassRun run{pass, cancel, events};
    run.done = static_cast<std::uint32_t>(m_order.size() - order.size());
    CorrelatedChoice::Missing missing;
    if (m_bucketNeeds)
        missing = [this](std::uint32_t cell) { return m_bucketNeeds->missing(cell); };
    if (m_isCorrelated) run.correlated.emplace(m_grid, order, m_arena.threads(), missing);
    BucketWork work;
    work.floatsPerPixel = m_layout.count + 1;
    if (m_isCorrelated) work.choose = [&](int worker) { return run.correlated->next(worker); };
    work.started = [&](std::uint32_t cell, const Rect& rect) {
        events.bucketStarted(bucketInfo(cell, rect, pass));
    };
    work.render = [&](std::uint32_t cell, const Rect& rect, const Rect& atom, int worker,
                      std::span<float> buffer) {
        const BucketMisses::Counting counting(*m_bucketMisses, cell);
        const BucketNeeds::Noting noting(m_bucketNeeds.get(), cell);
        renderAtom(rect, atom, pass, worker, buffer, cancel);
    };
    work.deliver = [&](const RenderedBucket& bucket) { deliverBucket(run, bucket); };
    m_clock.buckets(pass, static_cast<double>(run.done) / bucketCount());
    const BucketRun result = runBuckets(m_arena, m_grid, order, cancel.token, work);
    const double seconds = watch.seconds();
    countBuckets(result, seconds, order.size() == m_order.size());
    return seconds;
}

}  // namespace pm::plugin
