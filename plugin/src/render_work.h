// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"
#include "integrator/transport/plan.h"
#include "integrator/values/stopwatch.h"
#include "plugin/src/error_curve.h"
#include "plugin/src/event_queue.h"
#include "plugin/src/progress_clock.h"
#include "plugin/src/setting_values.h"
#include "plugin/src/stop_rule.h"
#include "plugin/src/warning_log.h"
#include "scheduler/bucket_grid.h"
#include "scheduler/bucket_runner.h"
#include "scheduler/cancel_token.h"
#include "scheduler/frame_store.h"
#include "scheduler/worker_arena.h"

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
};

// What a render needs, in bytes.
struct MemoryNeed {
    std::uint64_t scene = 0, frame = 0, maps = 0, buckets = 0;
    std::uint64_t total() const { return scene + frame + maps + buckets; }
};

// Where light meets pixels: one render's passes, photons first, then the buckets in their order.
// Made when the render starts, run once by its thread.
class RenderWork {
  public:
    // Plans, checks the memory limit before anything is allocated, then makes frame and renderer.
    // Errors: MEMORY with all figures; those of FrameRenderer.
    RenderWork(std::shared_ptr<const Scene> scene, const SettingValues& values);

    // Before run: tells the host what the plan found.
    void announce(EventQueue& events);
    // All passes that the stop rule wants. Errors: Error(kCancelled) soon after `cancel` is set,
    // those of the renderer.
    void run(const Cancel& cancel, EventQueue& events);

    // What has been done, and what it took.
    struct Progress {
        std::uint32_t passesDone = 0;
        std::int32_t stopReason = PMR_STOP_NONE;
        ErrorCurve curve;
        double photonSeconds = 0;              // beginPass: photons and their maps
        double bucketSeconds = 0;              // the buckets of all passes
        std::vector<double> secondsPerBucket;  // mean of a pass, by bucket; empty before the first
    };
    // All of these: any thread, any time.
    Progress progress() const;
    RenderCounters counters() const { return m_renderer->counters(); }
    const Scene& scene() const { return *m_scene; }
    const Plan& plan() const { return m_plan; }
    const MemoryNeed& memoryNeed() const { return m_need; }
    const FrameStore& frame() const { return *m_frame; }
    const ChannelLayout& layout() const { return m_layout; }
    WarningLog& warnings() { return m_warnings; }
    int threads() const { return m_arena.threads(); }
    std::uint32_t passCount() const { return m_settings.passes; }  // at most
    std::uint32_t bucketCount() const { return static_cast<std::uint32_t>(m_order.size()); }

  private:
    struct Scratch {
        std::vector<float> pixels, weights;
    };

    void checkMemory(const SettingValues& values);
    std::string passName(std::uint32_t pass) const;
    // Whether the pass that just ended was the last.
    bool endPass(std::uint32_t pass, double photonSeconds, double bucketSeconds);
    void warn(const Notice& notice, EventQueue& events);
    double beginPass(std::uint32_t pass, const Cancel& cancel, EventQueue& events);
    double renderBuckets(std::uint32_t pass, const Cancel& cancel, EventQueue& events);
    void renderBucket(const Rect& rect, int worker, std::span<float> buffer, const Cancel& cancel);
    PmrBucketInfo bucketInfo(std::uint32_t cell, const Rect& rect, std::uint32_t pass) const;

    const Stopwatch m_watch;
    const double m_processorStart;
    const std::shared_ptr<const Scene> m_scene;
    const RenderSettings m_settings;
    const StopRule m_stopRule;
    const Plan m_plan;
    WorkerArena m_arena;
    const BucketGrid m_grid;
    std::vector<std::uint32_t> m_order;       // cells in the order of rendering
    std::vector<std::uint32_t> m_orderIndex;  // and where each cell is in it
    ChannelLayout m_layout;
    MemoryNeed m_need;
    std::unique_ptr<FrameRenderer> m_renderer;
    std::unique_ptr<FrameStore> m_frame;
    std::vector<Scratch> m_scratch;  // one a worker
    ProgressClock m_clock;
    WarningLog m_warnings;

    mutable std::mutex m_mutex;
    Progress m_progress;
};

}  // namespace pm::plugin
