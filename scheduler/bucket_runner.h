// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "integrator/values/rect.h"
#include "scheduler/bucket_grid.h"
#include "scheduler/cancel_token.h"
#include "scheduler/worker_arena.h"

namespace pm {

// What is done with each bucket. All functions are called from several workers at once, each call
// for another bucket (disjoint rectangles), under FpEnvironment's modes. What they throw stops the
// run.
struct BucketWork {
    // Floats a pixel that render writes, at least 1. Their layout within a bucket is up to render
    // and deliver; channels side by side and the pixels row by row is what FrameStore takes.
    std::int32_t floatsPerPixel{};

    // Optional: a worker has drawn this bucket and begins it.
    std::function<void(std::uint32_t cell, const Rect& rect)> started;

    // Fills pixels: rect.area() * floatsPerPixel floats of the worker's own buffer, all 0 at first.
    // worker: from 0 to arena.threads() - 1, never the same in two calls at once. It may look at
    // the cancel token and return early; its bucket is then dropped.
    std::function<void(std::uint32_t cell, const Rect& rect, int worker, std::span<float> pixels)>
        render;

    // Takes a finished bucket, on the worker that rendered it; the pixels are valid during the
    // call.
    std::function<void(std::uint32_t cell, const Rect& rect, std::span<const float> pixels)>
        deliver;
};

struct BucketRun {
    std::size_t bucketsDone{};    // delivered
    bool cancelled{};             // the token was set before all buckets were delivered
    std::vector<double> seconds;  // of each bucket, from drawn to delivered, by its place in the
                                  // order; 0 where it was not delivered
};

// Renders the buckets of order (cells of grid; all of them or a part), drawn one by one from a
// single ticket, so that they start in that order; returns when all workers have stopped.
//
// Cancelling: the token is looked at before each bucket and after its render; buckets delivered
// until then stand.
// Errors: what a function of work throws, once every worker has stopped. Where several buckets fail
// it is always the exception of the first of them in the order, for any number of threads.
// kInvalidArgument where a cell is not in the grid, render or deliver is missing, or
// floatsPerPixel is below 1.
// Threads: any number of runs at once, also in one arena.
BucketRun runBuckets(WorkerArena& arena, const BucketGrid& grid,
                     std::span<const std::uint32_t> order, const CancelToken& cancel,
                     const BucketWork& work);

}  // namespace pm
