// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "integrator/values/rect.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/buckets/cancel_token.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm {

// A bucket whose atoms are all rendered.
struct RenderedBucket {
    std::uint32_t cell{};
    Rect rect;
    std::span<const float> pixels;  // as BucketWork::render left them
    double seconds{};               // wall time since it was drawn
};

// What is done with each bucket. All functions are called from several workers at once, under
// FpEnvironment's modes: started and deliver once for each bucket, render for each of its atoms.
// What they throw stops the run.
struct BucketWork {
    // Floats a pixel that render writes, at least 1. Their layout within a bucket is up to render
    // and deliver; channels side by side and the pixels row by row is what FrameStore takes.
    std::int32_t floatsPerPixel{};

    // Optional: the bucket that a worker begins next, as a place in the order, each place once;
    // the order's size when none is left, and from then on. Without it: in the order.
    // worker: from 0 to arena.threads() - 1, never the same in two calls at once.
    std::function<std::size_t(int worker)> choose;

    // Optional: a worker has drawn this bucket and begins it.
    std::function<void(std::uint32_t cell, const Rect& rect)> started;

    // Fills the pixels of one of the bucket's atoms (see atomOf). bucket: rect.area() *
    // floatsPerPixel floats, all 0 at first; atoms of one bucket may be rendered by several workers
    // at once, so each call writes its own pixels' floats only. worker: as in choose. It may look
    // at the cancel token and return early; its bucket is then dropped.
    std::function<void(std::uint32_t cell, const Rect& rect, const Rect& atom, int worker,
                       std::span<float> bucket)>
        render;

    // Takes a finished bucket, on the worker that rendered its last atom; the pixels are valid
    // during the call.
    std::function<void(const RenderedBucket& bucket)> deliver;
};

struct BucketRun {
    std::size_t bucketsDone{};    // delivered
    bool cancelled{};             // the token was set before all buckets were delivered
    std::vector<double> seconds;  // of each bucket, from drawn to delivered, by its place in the
                                  // order; 0 where it was not delivered
    double idleSeconds{};  // that workers had nothing to do before the last one ended; summed
};

// Renders the buckets of order (cells of grid; all of them or a part), drawn one by one, so that
// they start in that order; returns when all workers have stopped. A worker that finds no bucket
// left helps the others with the atoms that they have not begun, so that the end of a run waits for
// an atom and not for a bucket.
//
// Cancelling: the token is looked at before each bucket and after each atom; buckets delivered
// until then stand.
// Errors: what a function of work throws, once every worker has stopped. Where several buckets fail
// it is always the exception of the first of them in the order, and there of the first atom, for
// any number of threads (with work.choose, of those that were begun).
// kInvalidArgument where a cell is not in the grid, render or deliver is missing, or
// floatsPerPixel is below 1.
// Threads: any number of runs at once, also in one arena.
BucketRun runBuckets(WorkerArena& arena, const BucketGrid& grid,
                     std::span<const std::uint32_t> order, const CancelToken& cancel,
                     const BucketWork& work);

}  // namespace pm
