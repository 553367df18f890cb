// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/photon_tracer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>
#include <span>
#include <utility>

#include "integrator/photons/trace/photon_walk.h"
#include "integrator/photons/trace/trace_order.h"
#include "integrator/values/cancel_check.h"

namespace pm {

namespace {

// Small enough for a pass's photons to be shared evenly among many threads: eight batches of 4096
// left two of these at 1.83 times the speed of one.
constexpr std::uint64_t kBatchSize = 512;
static_assert(TraceOrder::kWindow % kBatchSize == 0);
using Batch = PhotonWalk::Batch;

// Those of all batches, in order; empties them.
template <typename T>
void join(std::vector<Batch>& batches, std::vector<T> Batch::*member, BigVector<T>& joined,
          const CancelCheck& cancel) {
    std::vector<std::size_t> begins{0};
    for (const Batch& batch : batches) begins.push_back(begins.back() + (batch.*member).size());
    joined.resize(begins.back());
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
        cancel.throwIfSet("joining photons");
        const std::vector<T> from = std::exchange(batches[b].*member, {});
        std::ranges::copy(from, joined.begin() + static_cast<std::ptrdiff_t>(begins[b]));
    });
}

// The first round's batches, and the fewest of any.
constexpr std::size_t kFirstRound = 16;
// Of what a round gave there are its batches, which have grown, and what is joined of them.
constexpr std::uint64_t kCopies = 3;

// Those of the request from batch `first` on, in parallel, in their order.
void traceBatches(const PhotonWalk& walk, const TraceOrder& order,
                  const PhotonTraceRequest& request, std::size_t first, std::span<Batch> batches,
                  const std::atomic<bool>& cancelled, const std::function<void(double)>& progress) {
    const auto all = static_cast<double>((request.count + kBatchSize - 1) / kBatchSize);
    std::mutex progressMutex;
    std::size_t done = first;
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
        if (cancelled.load(std::memory_order_relaxed)) return;
        const std::uint64_t end = std::min(request.count, (first + b + 1) * kBatchSize);
        // Where next to nothing is absorbed a single photon takes its time.
        for (std::uint64_t i = (first + b) * kBatchSize;
             i < end && !cancelled.load(std::memory_order_relaxed); ++i)
            walk.trace(order.index(i), batches[b]);
        if (!progress) return;
        const std::lock_guard lock(progressMutex);
        progress(static_cast<double>(++done) / all);
    });
}

PhotonTraceResult joined(std::vector<Batch>& batches, const CancelCheck& check) {
    PhotonTraceResult part;
    join(batches, &Batch::photons, part.photons, check);
    join(batches, &Batch::descended, part.descended, check);
    join(batches, &Batch::received, part.received, check);
    join(batches, &Batch::records, part.records, check);
    return part;
}

std::uint64_t bytesOf(const PhotonTraceResult& part) {
    return (part.photons.size() + part.descended.size()) * sizeof(Photon) +
           part.received.size() * sizeof(ReceivedPhoton) +
           part.records.size() * sizeof(EmissionRecord);
}

}  // namespace

PhotonBalance& PhotonBalance::operator+=(const PhotonBalance& other) {
    emitted += other.emitted;
    stored += other.stored;
    lost += other.lost;
    rays += other.rays;
    fluxEmitted += other.fluxEmitted;
    fluxAbsorbed += other.fluxAbsorbed;
    fluxEscaped += other.fluxEscaped;
    fluxLost += other.fluxLost;
    return *this;
}

PhotonTraceResult traceInRounds(const Scene& scene, const LightSampler& lights,
                                const PhotonTraceRequest& request,
                                const std::atomic<bool>& cancelled,
                                const std::function<void(double)>& progress,
                                const TraceRounds& rounds) {
    PhotonTraceResult sums;
    if (request.aim) sums.focus = request.aim->focus();
    if (request.count == 0 || lights.empty()) return sums;
    const PhotonWalk walk(scene, lights, request);
    TraceOrder order(scene, walk, request.count);
    const CancelCheck check(cancelled);
    const std::size_t batchCount = (request.count + kBatchSize - 1) / kBatchSize;
    std::size_t size = rounds.bytes == TraceRounds::kAll ? batchCount : kFirstRound;
    for (std::size_t first = 0; first < batchCount;) {
        std::vector<Batch> batches(std::min(size, batchCount - first));
        for (std::size_t done = 0; done < batches.size();) {
            const std::uint64_t end = order.enter((first + done) * kBatchSize, check);
            const std::size_t count = std::min<std::size_t>(
                (end + kBatchSize - 1) / kBatchSize - first - done, batches.size() - done);
            traceBatches(walk, order, request, first + done,
                         std::span(batches).subspan(done, count), cancelled, progress);
            done += count;
        }
        check.throwIfSet("tracing photons");
        PhotonTraceResult part = joined(batches, check);
        for (const Batch& batch : batches) {
            sums.balance += batch.balance;
            sums.metCaster += batch.metCaster;
        }
        first += batches.size();
        // Where next to nothing landed that is more than any number can hold.
        const double fitting = static_cast<double>(rounds.bytes / kCopies) *
                               static_cast<double>(batches.size()) /
                               static_cast<double>(bytesOf(part) + 1);
        size =
            std::max(kFirstRound,
                     static_cast<std::size_t>(std::min(fitting, static_cast<double>(batchCount))));
        rounds.take(std::move(part));
    }
    return sums;
}

PhotonTraceResult tracePhotons(const Scene& scene, const LightSampler& lights,
                               const PhotonTraceRequest& request,
                               const std::atomic<bool>& cancelled,
                               const std::function<void(double)>& progress) {
    PhotonTraceResult all;
    const PhotonTraceResult sums =
        traceInRounds(scene, lights, request, cancelled, progress,
                      {TraceRounds::kAll, [&](PhotonTraceResult part) { all = std::move(part); }});
    all.balance = sums.balance;
    all.focus = sums.focus;
    all.metCaster = sums.metCaster;
    return all;
}

}  // namespace pm
