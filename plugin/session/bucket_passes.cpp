// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/bucket_passes.h"

#include <algorithm>
#include <atomic>

#include "plugin/session/frame_samples.h"
#include "plugin/session/render_caches.h"
#include "plugin/session/render_work.h"

namespace pm::plugin {

BucketPasses::BucketPasses(const Frame& frame, std::uint32_t bucketsHeld)
    : m_frame(frame),
      m_shelf(static_cast<std::uint32_t>(frame.order.size()), bucketsHeld),
      m_errors(frame.grid) {
    const ChannelLayout layout = channelLayout(frame.settings);
    const Scratch scratch{std::vector<float>(static_cast<std::size_t>(kAtomPixels) *
                                             static_cast<std::size_t>(layout.count)),
                          std::vector<float>(kAtomPixels), std::vector<SampleRun>(kAtomPixels)};
    m_scratch.assign(static_cast<std::size_t>(frame.workers), scratch);
}

BucketInfo BucketPasses::info(std::uint32_t cell, const Rect& rect) const {
    const Rect inWindow = intersect(rect, m_frame.settings.window);
    BucketInfo info;
    info.rectangle = inWindow;
    info.bucketIndex = m_frame.placeOf[cell];
    info.bucketCount = static_cast<std::uint32_t>(m_frame.order.size());
    info.passCount = m_frame.settings.passes;
    return info;
}

void BucketPasses::begin(std::uint32_t cell, const Rect& rect, EventQueue& events) {
    RenderSettings settings = m_frame.settings;
    settings.window = intersect(rect, settings.window);
    m_shelf.put(m_frame.placeOf[cell], std::make_shared<FrameStore>(makeFrame(
                                           settings, m_frame.sharesNoise, m_frame.errorScale)));
    events.bucketStarted(info(cell, rect));
}

void BucketPasses::renderAtom(const FrameRenderer& renderer, FrameStore& pixels, const Rect& atom,
                              Scratch& scratch, const Cancel& cancel) const {
    for (std::uint32_t pass = 0; pass < m_frame.settings.passes; ++pass) {
        findSamples(m_frame.settings, pixels, pass, atom, scratch.runs);
        renderer.renderRegion(pass, atom, scratch.runs, scratch.pixels, cancel.flag);
        if (cancel.isSet()) return;  // it may have given up half-way
        std::ranges::transform(scratch.runs, scratch.weights.begin(),
                               [](SampleRun run) { return run.weight(); });
        pixels.addPass(pass, atom, scratch.pixels, scratch.weights);
    }
}

void BucketPasses::finish(const RenderedBucket& bucket, EventQueue& events) {
    if (m_caches) m_caches->bucketDone();
    BucketInfo finished = info(bucket.cell, bucket.rect);
    const FrameStore& pixels = m_shelf.pixels(finished.bucketIndex);
    m_errors.add(bucket.cell, pixels);
    std::vector<float> counts(static_cast<std::size_t>(pixels.window().area()));
    pixels.readSampleCount(pixels.window(), counts.data(), sizeof(float),
                           static_cast<std::int64_t>(sizeof(float)) * pixels.window().width());
    double samples = 0;
    for (const float count : counts) samples += static_cast<double>(count);
    finished.sampleCount = static_cast<std::uint64_t>(samples);
    finished.passIndex = m_frame.settings.passes - 1;
    finished.seconds = bucket.seconds;
    finished.timedPasses = m_frame.settings.passes;
    const BucketMisses::Count missed = m_frame.misses.of(bucket.cell);
    finished.cacheMisses = missed.misses;
    finished.cacheBytes = missed.bytes;
    m_shelf.finish(finished, [&events](const BucketInfo& told) { events.bucketFinished(told); });
}

BucketRun BucketPasses::run(const FrameRenderer& renderer, WorkerArena& arena, double firstShare,
                            const Cancel& cancel, EventQueue& events) {
    // Those who wait for a free place must not wait for a bucket that failed.
    const auto guarded = [this](const auto& work) {
        try {
            work();
        } catch (...) {
            m_shelf.close();
            throw;
        }
    };
    std::atomic<std::uint32_t> done{0};
    ProgressClock::Ends ends;
    ends.passes = 1;
    ProgressClock clock(ends, false);
    BucketWork work;
    work.floatsPerPixel = 1;  // pixels go to the shelf
    work.choose = [&](int) { return std::size_t{m_shelf.draw(cancel.flag)}; };
    work.started = [&](std::uint32_t cell, const Rect& rect) {
        guarded([&] { begin(cell, rect, events); });
    };
    work.render = [&](std::uint32_t cell, const Rect&, const Rect& atom, int worker,
                      std::span<float>) {
        guarded([&] {
            const BucketMisses::Counting counting(m_frame.misses, cell);
            renderAtom(renderer, m_shelf.pixels(m_frame.placeOf[cell]), atom,
                       m_scratch[static_cast<std::size_t>(worker)], cancel);
        });
    };
    work.deliver = [&](const RenderedBucket& bucket) {
        guarded([&] {
            renderer.forget(bucket.rect, m_frame.grid.window());
            finish(bucket, events);
        });
        const double share =
            static_cast<double>(++done) / static_cast<double>(m_frame.order.size());
        const ProgressClock::Reading reading = clock.buckets(0, share);
        events.progress(firstShare + (1 - firstShare) * reading.fraction, reading.remainingSeconds);
    };
    return runBuckets(arena, m_frame.grid, m_frame.order, cancel.token, work);
}

}  // namespace pm::plugin
