// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"
#include "integrator/transport/plan/plan.h"
#include "integrator/values/error.h"
#include "integrator/values/stopwatch.h"
#include "plugin/session/bucket_info.h"
#include "plugin/session/bucket_misses.h"
#include "plugin/session/bucket_needs.h"
#include "plugin/session/bucket_passes.h"
#include "plugin/session/error_curve.h"
#include "plugin/session/event_queue.h"
#include "plugin/session/memory_plan.h"
#include "plugin/session/progress_clock.h"
#include "plugin/session/render_caches.h"
#include "plugin/session/render_pages.h"
#include "plugin/session/render_photons.h"
#include "plugin/session/render_pieces.h"
#include "plugin/session/render_scene.h"
#include "plugin/session/setting_values.h"
#include "plugin/session/stop_rule.h"
#include "plugin/session/warning_log.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/buckets/bucket_runner.h"
#include "scheduler/buckets/cancel_token.h"
#include "scheduler/buckets/worker_arena.h"
#include "scheduler/film/frame_store.h"

namespace pm::plugin {

// Both kinds of flag that the parts look at, set together.
struct Cancel {
    CancelToken token;
    std::atomic<bool> flag{false};

    // The token first: whoever gave up because of the flag must find it set, or a bucket that was
    // left half-way would count as finished.
    void set() {
        token.cancel();
        flag.store(true, std::memory_order_release);
    }
    bool isSet() const { return flag.load(std::memory_order_acquire); }
    void throwIfSet() const {
        if (isSet()) throw Error(Status::kCancelled, "the render was cancelled");
    }
};

// Where light meets pixels: one render's passes, photons first, then the buckets in their order;
// or, by buckets, the photons of all passes, then each bucket with all passes (see MemoryPlan).
// Made when the render starts, run once by its thread.
class RenderWork {
  public:
    // Plans, where none is given, checks the memory limit before anything is allocated, then makes
    // frame and renderer. Errors: MEMORY with all figures; those of FrameRenderer and RenderPieces;
    // CallError(CANCELLED) soon after scene.cancelPlans is set.
    RenderWork(const RenderScene& scene, const SettingValues& values,
               const std::optional<Plan>& plan);

    // Before run: who is told of each bucket that is done.
    void divideMemory(std::unique_ptr<RenderCaches> caches) { m_caches = std::move(caches); }
    const RenderCaches* caches() const { return m_caches.get(); }
    // Before run: tells the host what the plan found.
    void announce(EventQueue& events);
    // All passes that the stop rule wants, from those on that the checkpoint has. Errors:
    // Error(kCancelled) soon after `cancel` is set, those of the renderer.
    void run(const Cancel& cancel, EventQueue& events);

    // What has been done, and what it took.
    struct Progress {
        std::uint32_t passesDone = 0;
        std::uint32_t passesResumed = 0;  // of these from the checkpoint
        StopReason stopReason = StopReason::kNone;
        ErrorCurve curve;
        std::optional<FrameError> lastError;   // once the last pass has ended
        std::string photonHash;                // of a photon map that was written
        double photonSeconds = 0;              // beginPass: photons and their maps
        double bucketSeconds = 0;              // the buckets of all passes
        double idleSeconds = 0;                // of workers at the ends of passes, summed
        std::vector<double> secondsPerBucket;  // mean of a pass, by bucket; empty before the first
    };
    // All of these: any thread, any time.
    Progress progress() const;
    RenderCounters counters() const { return m_renderer->counters(); }
    const Scene& scene() const { return *m_scene; }
    const Plan& plan() const { return m_plan; }
    RenderPages* pages() const { return m_pages.get(); }  // null: maps are in memory
    // What textures missed in the buckets so far, by CacheUser.
    std::array<std::uint64_t, kCacheUsers> texelMissesOf() const {
        return m_bucketMisses ? m_bucketMisses->texelMissesOf()
                              : std::array<std::uint64_t, kCacheUsers>{};
    }
    const RenderPhotons& photons() const { return m_photons; }
    const MemoryPlan& memory() const { return m_memory; }
    // The pixels that can be read now; by buckets null where no bucket is being delivered.
    std::shared_ptr<const FrameStore> frame() const;
    // Of the pixels so far. inParallel: in the threads of the arena that it is called in.
    std::optional<FrameError> estimateError(bool inParallel = false) const;
    // By buckets: the host is about to be called back for one, or has returned from that.
    void beforeDelivery(std::uint32_t bucketIndex);
    void afterDelivery(std::uint32_t bucketIndex);
    // The passes that pixels which can be read now have had.
    std::uint32_t passesOfPixels() const;
    const ChannelLayout& layout() const { return m_layout; }
    WarningLog& warnings() { return m_warnings; }
    int threads() const { return m_arena.threads(); }
    std::uint32_t passCount() const { return m_settings.passes; }    // at most
    std::int32_t bucketSize() const { return m_grid.bucketSize(); }  // pixels
    std::uint32_t bucketCount() const { return static_cast<std::uint32_t>(m_order.size()); }

  private:
    struct Scratch {
        std::vector<float> pixels;  // of one atom
        std::vector<SampleRun> runs;
    };
    // Of a bucket, over the passes that were rendered here.
    struct BucketTime {
        double seconds = 0;
        std::uint32_t passes = 0;
    };

    void orderBuckets(const Identity& sceneIdentity, const SettingValues& values);
    void makeRenderer();
    void makePlaces();
    void runPhotonsOnly(const Cancel& cancel, EventQueue& events);
    void tracePass(std::uint32_t pass, const Cancel& cancel, EventQueue& events);
    void runByBuckets(const Cancel& cancel, EventQueue& events);
    void runByPasses(const Cancel& cancel, EventQueue& events);
    double addPass(std::uint32_t pass, double share, const Cancel& cancel, EventQueue& events);
    // Returns the first pass to make.
    std::uint32_t resume(const Cancel& cancel, EventQueue& events);
    void warnOfCheckpoint(const std::string& text, EventQueue& events);
    void closePieces(const Cancel& cancel, EventQueue& events) noexcept;
    void makePasses(std::uint32_t first, const Cancel& cancel, EventQueue& events);
    std::string passName(std::uint32_t pass) const;
    // Whether the pass that just ended was the last.
    bool endPass(std::uint32_t pass, double photonSeconds, double bucketSeconds);
    void warn(const Notice& notice, EventQueue& events);
    double beginPass(std::uint32_t pass, const Cancel& cancel, EventQueue& events);
    double renderBuckets(std::uint32_t pass, const Cancel& cancel, EventQueue& events);
    struct PassRun;
    void deliverBucket(PassRun& run, const RenderedBucket& bucket);
    void countBuckets(const BucketRun& result, double seconds, bool ofWholeFrame);
    void renderAtom(const Rect& rect, const Rect& atom, std::uint32_t pass, int worker,
                    std::span<float> buffer, const Cancel& cancel);
    BucketInfo bucketInfo(std::uint32_t cell, const Rect& bucket, std::uint32_t pass) const;

    const Stopwatch m_watch;
    const double m_processorStart;
    const std::shared_ptr<const Scene> m_scene;
    const RenderSettings m_settings;
    const StopRule m_stopRule;
    WorkerArena m_arena;
    const Plan m_plan;
    const BucketGrid m_grid;
    const MemoryPlan m_memory;
    std::vector<std::uint32_t> m_order;       // cells in the order of rendering
    std::vector<std::uint32_t> m_orderIndex;  // and where each cell is in it
    std::unique_ptr<RenderPieces> m_pieces;
    std::unique_ptr<RenderCaches> m_caches;
    std::uint32_t m_timedPasses = 0;  // that secondsPerBucket is the mean of
    bool m_isCorrelated = false;      // the next bucket is chosen while rendering
    ChannelLayout m_layout;
    std::unique_ptr<RenderPages> m_pages;  // outlives the renderer, as does
    RenderPhotons m_photons;               // outlives who reads from it:
    std::unique_ptr<FrameRenderer> m_renderer;
    std::shared_ptr<FrameStore> m_frame;         // the whole one
    std::unique_ptr<BucketPasses> m_buckets;     // or, by buckets, these, and no pieces
    std::vector<Scratch> m_scratch;              // one a worker
    std::vector<BucketTime> m_bucketTimes;       // by cell, each its worker's; pass by pass
    std::unique_ptr<BucketNeeds> m_bucketNeeds;  // of correlated, where something is cut on demand
    std::unique_ptr<BucketMisses> m_bucketMisses;  // null: photons alone
    ProgressClock m_clock;
    WarningLog m_warnings;

    mutable std::mutex m_mutex;
    Progress m_progress;
};

}  // namespace pm::plugin
