// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "integrator/transport/frame_renderer.h"
#include "plugin/session/bucket_misses.h"
#include "plugin/session/bucket_shelf.h"
#include "plugin/session/event_queue.h"
#include "plugin/session/progress_clock.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/buckets/bucket_runner.h"
#include "scheduler/buckets/worker_arena.h"
#include "scheduler/film/bucket_errors.h"

namespace pm::plugin {

struct Cancel;
class RenderCaches;

// The buckets of a render by buckets: each with all its passes, in pass order, in a small frame
// store of its own that is forgotten when the host has had it. Pixels have the bits that they have
// pass by pass, as nothing but their own passes enters them; samples are allotted atom by atom.
class BucketPasses {
  public:
    // Of the render; all of it must outlive this.
    struct Frame {
        const RenderSettings& settings;
        const BucketGrid& grid;
        std::span<const std::uint32_t> order;    // cells
        std::span<const std::uint32_t> placeOf;  // of each cell in it
        BucketMisses& misses;
        int workers = 1;
        bool sharesNoise = true;  // SampleRule::sharesNoise
        ErrorScale errorScale{};
    };
    // bucketsHeld: in work or waiting for the host, at most.
    BucketPasses(const Frame& frame, std::uint32_t bucketsHeld);

    // Who is told of each bucket that is done; null: nobody.
    void tell(RenderCaches* caches) { m_caches = caches; }
    // All buckets; the maps of all passes must have been added to the renderer. firstShare: of the
    // progress that was made before. Errors: those of the renderer. When `cancel` is set it ends
    // soon, with what is done.
    BucketRun run(const FrameRenderer& renderer, WorkerArena& arena, double firstShare,
                  const Cancel& cancel, EventQueue& events);

    // What the host is being called back for, and that being told. Threads: any.
    BucketShelf& shelf() { return m_shelf; }
    const BucketShelf& shelf() const { return m_shelf; }
    // Of the buckets so far. Threads: any.
    std::optional<FrameError> estimateError() const { return m_errors.result(); }

  private:
    struct Scratch {
        std::vector<float> pixels, weights;  // of one atom and pass
        std::vector<SampleRun> runs;
    };

    void begin(std::uint32_t cell, const Rect& rect, EventQueue& events);
    void renderAtom(const FrameRenderer& renderer, FrameStore& pixels, const Rect& atom,
                    Scratch& scratch, const Cancel& cancel) const;
    void finish(const RenderedBucket& bucket, EventQueue& events);
    BucketInfo info(std::uint32_t cell, const Rect& rect) const;

    const Frame m_frame;
    BucketShelf m_shelf;
    BucketErrors m_errors;
    RenderCaches* m_caches = nullptr;
    std::vector<Scratch> m_scratch;  // one a worker
};

}  // namespace pm::plugin
