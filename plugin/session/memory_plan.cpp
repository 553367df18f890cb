// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/memory_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "integrator/photons/map/photon.h"
#include "integrator/transport/frame_renderer.h"
#include "integrator/transport/gather/gather_points.h"
#include "plugin/session/bucket_info.h"
#include "plugin/session/frame_samples.h"
#include "plugin/session/layer_table.h"
#include "plugin/session/memory_limit.h"
#include "plugin/session/page_plan.h"
#include "plugin/session/pixel_reader.h"
#include "plugin/session/render_photons.h"
#include "plugin/textures/texture_system.h"
#include "plugin/values/call_error.h"
#include "scheduler/buckets/available_threads.h"
#include "scheduler/buckets/bucket_order.h"
#include "scheduler/film/bucket_errors.h"

namespace pm::plugin {

namespace {

// Buckets held for each thread: one in work, others done, which wait for one before them in the
// order or for the host.
constexpr std::uint32_t kBucketsHeldPerThread = 4;
// Of a photon that is traced and not put into a map: in its batch, and where batches are joined.
constexpr std::uint64_t kTracedBytesPerPhoton = 2 * sizeof(Photon);
// Of a cell: its place in two orders, and how long it took, in three copies.
constexpr std::uint64_t kCellBytes = 2 * sizeof(std::uint32_t) + 3 * sizeof(double);
// And pass by pass, its time so far.
constexpr std::uint64_t kTimeBytes = 16;

// Code and libraries of pm_host as measured with next to no scene; a host that is larger knows so.
constexpr std::uint64_t kProgramBytes = std::uint64_t{150} << 20;
// Of a thread that cuts triangles on demand, beside those: patches, points, the tree as it is
// built.
constexpr std::uint64_t kCuttingBytes = std::uint64_t{6} << 20;
constexpr double kGib = 1024.0 * 1024.0 * 1024.0;

// groups: bytes of triangles that are cut on demand.
std::uint64_t programBytes(std::uint64_t groups, std::uint64_t threads) {
    return kProgramBytes + (groups > 0 ? threads * kCuttingBytes : 0);
}

// Caches of textures and of triangles that are cut on demand: what doesn't fit is read or cut
// again.
struct CacheSizes {
    std::uint64_t textures, groups;
};

CacheSizes leastOf(const CacheSizes& whole) {
    return {std::min(whole.textures, TextureSystem::kLeastBytes),
            std::min(whole.groups, kLeastGroups)};
}

// What they have before photon maps go into pages or pixels from bucket to bucket.
CacheSizes wantedOf(const CacheSizes& whole, std::uint64_t limit) {
    const CacheSizes least = leastOf(whole);
    return {std::clamp(limit / 8, least.textures, whole.textures),
            std::clamp(limit / 4, least.groups, whole.groups)};
}

// What is left of the limit goes to those that lack some, in proportion.
void growCaches(const CacheSizes& whole, MemoryPlan& memory) {
    MemoryNeed& need = memory.need;
    if (need.total() >= memory.limit) return;
    const std::uint64_t left = memory.limit - need.total();
    const std::uint64_t lack = whole.textures - need.textures + whole.groups - need.groups;
    const double share = lack <= left ? 1.0 : static_cast<double>(left) / static_cast<double>(lack);
    const auto grow = [share](std::uint64_t& size, std::uint64_t most) {
        size += static_cast<std::uint64_t>(share * static_cast<double>(most - size));
    };
    grow(need.textures, whole.textures);
    grow(need.groups, whole.groups);
}

// The layers as floats, which every host has to put somewhere.
std::uint64_t hostBytes(const SettingValues& values) {
    std::uint64_t channels = 0;
    for (const Layer layer : layersOf(values))
        channels += layerSpecs()[static_cast<std::size_t>(layer)].channelCount;
    return static_cast<std::uint64_t>(values.window().area()) * channels * sizeof(float);
}

// Gather points of a pass, made and forgotten as the buckets come.
std::uint64_t pointBytes(const Plan& plan, const RenderSettings& settings, const BucketGrid& grid,
                         const std::string& orderName, std::size_t bucketsHeld) {
    const BucketOrder* const order = findBucketOrder(orderName);
    if (!plan.globalMap || order == nullptr) return 0;
    std::vector<Rect> rects;
    rects.reserve(grid.cellCount());
    for (const std::uint32_t cell : order->cells(grid.columns(), grid.rows(), settings.seed))
        rects.push_back(grid.cellRect(cell));
    return GatherPoints::memoryBytes(settings.width, settings.height, plan.gatherSpacing, rects,
                                     grid.window(), bucketsHeld);
}

// The same of a whole frame.
std::uint64_t framePointBytes(const Plan& plan, const RenderSettings& settings) {
    if (!plan.globalMap) return 0;
    return GatherPoints::memoryBytes(settings.width, settings.height, plan.gatherSpacing,
                                     settings.window);
}

// Why the passes of a bucket can't all be made before the next one; empty where they can.
std::string obstacle(const SettingValues& values) {
    if (values.number(Setting::kTimeLimit) > 0) return "timeLimitSeconds";
    if (values.number(Setting::kErrorTarget) > 0) return "errorTarget";
    if (values.passLimit() > kMostPassesByBuckets)
        return fmt::format("more than {} passes", kMostPassesByBuckets);
    for (const Setting files : {Setting::kBuckets, Setting::kPart, Setting::kCheckpoint})
        if (!values.word(files).empty())
            return settingSpecs()[static_cast<std::size_t>(files)].name;
    const BucketOrder* order = findBucketOrder(values.word(Setting::kBucketOrder));
    if (order != nullptr && order->isCorrelated) return "the bucket order correlated";
    return {};
}

std::string figures(const MemoryNeed& need) {
    const std::string textures =
        need.textures == 0 ? "" : fmt::format(", textures {:.2f}", toGib(need.textures));
    const std::string groups =
        need.groups == 0 ? "" : fmt::format(", triangles on demand {:.2f}", toGib(need.groups));
    return fmt::format(
        "{:.2f} GiB (scene {:.2f}, frame {:.2f}, photon maps {:.2f}, buckets {:.2f}, process "
        "{:.2f}{}{})",
        toGib(need.total()), toGib(need.scene), toGib(need.frame), toGib(need.maps),
        toGib(need.buckets), toGib(need.process), textures, groups);
}

std::uint64_t threadsOf(const SettingValues& values) {
    const auto asked = static_cast<int>(values.integer(Setting::kThreads));
    return static_cast<std::uint64_t>(asked == 0 ? availableThreads() : asked);
}

std::uint64_t frameBytes(RenderSettings settings, const Rect& window) {
    settings.window = window;
    return frameMemoryBytes(settings);
}

// Turns a plan for the whole frame into one by buckets.
void planByBuckets(const Plan& plan, const RenderSettings& settings, std::uint64_t threads,
                   const BucketGrid& grid, const std::string& order, MemoryPlan& memory) {
    memory.byBuckets = true;
    memory.bucketsHeld = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(kBucketsHeldPerThread * threads, grid.cellCount()));
    const std::int32_t side = grid.bucketSize();
    memory.need.frame = memory.bucketsHeld * frameBytes(settings, {0, 0, side, side});
    if (plan.tracePhotons)
        memory.need.maps = plan.memoryBytes(
            settings.passes, pointBytes(plan, settings, grid, order, memory.bucketsHeld));
    memory.need.process = programBytes(memory.need.groups, threads);
    memory.need.buckets = threads * kAtomPixels *
                              static_cast<std::uint64_t>(channelLayout(settings).count + 4) *
                              sizeof(float) +
                          grid.cellCount() * kCellBytes + BucketErrors::memoryBytes(grid);
}

}  // namespace

BucketGrid bucketsOf(const SettingValues& values) {
    const Rect window = values.window();
    const auto size = static_cast<std::int32_t>(values.integer(Setting::kBucketSize));
    return {wholeAtoms(window), size == 0 ? autoBucketSize(window) : size};
}

namespace {

// With all maps in memory.
MemoryPlan planInMemory(const Scene& scene, const Plan& plan, const SettingValues& values,
                        const BucketGrid& grid, const CacheSizes& caches) {
    const RenderSettings settings = values.toRenderSettings();
    const ChannelLayout layout = channelLayout(settings);
    const std::uint64_t threads = threadsOf(values);
    const auto bucketSize = static_cast<std::uint64_t>(grid.bucketSize());
    MemoryPlan memory;
    memory.limit = memoryLimitBytes(values.number(Setting::kMemoryLimit));
    memory.whole = {scene.memoryBytes(),
                    frameBytes(settings, settings.window),
                    plan.mapBytes,
                    threads * bucketSize * bucketSize *
                            static_cast<std::uint64_t>(layout.count + 1) * sizeof(float) +
                        grid.cellCount() * (sizeof(BucketInfo) * 2 + kTimeBytes),
                    programBytes(caches.groups, threads) + hostBytes(values),
                    caches.textures,
                    caches.groups};
    // Without pixels there is no frame, whatever the delivery.
    const bool photonsOnly = values.integer(Setting::kPhotonsOnly) != 0;
    if (photonsOnly)
        memory.whole = {scene.memoryBytes(),
                        0,
                        plan.landingsPerPass() * kTracedBytesPerPhoton,
                        0,
                        programBytes(caches.groups, threads),
                        memory.whole.textures,
                        memory.whole.groups};
    memory.need = memory.whole;
    if (photonsOnly) return memory;
    const std::string& delivery = values.word(Setting::kDelivery);
    if (delivery == "frame") return memory;
    memory.whyWhole = obstacle(values);
    const bool demanded = delivery == "buckets";
    if (demanded && !memory.whyWhole.empty())
        throw argumentError(
            fmt::format("setting delivery is buckets; it does not go together with "
                        "{}",
                        memory.whyWhole));
    if (!demanded && (memory.whole.total() <= memory.limit || !memory.whyWhole.empty()))
        return memory;
    planByBuckets(plan, settings, threads, grid, values.word(Setting::kBucketOrder), memory);
    return memory;
}

MemoryPlan planWith(const Scene& scene, const Plan& plan, const SettingValues& values,
                    const BucketGrid& grid, const CacheSizes& caches) {
    MemoryPlan memory = planInMemory(scene, plan, values, grid, caches);
    const RenderSettings settings = values.toRenderSettings();
    if (!memory.byBuckets) {
        planPages(plan, values, framePointBytes(plan, settings), memory);
        return memory;
    }
    MemoryPlan ofFrame = memory;
    planPages(
        plan, values,
        pointBytes(plan, settings, grid, values.word(Setting::kBucketOrder), memory.bucketsHeld),
        memory);
    const bool isInMemory = memory.need.total() <= memory.limit && memory.pages == 0;
    if (isInMemory) return memory;
    if (values.word(Setting::kDelivery) == "buckets") return memory;
    // The frame with the maps of one pass, where that leaves more room for their pages.
    ofFrame.byBuckets = false;
    ofFrame.bucketsHeld = 0;
    ofFrame.need = ofFrame.whole;
    planPages(plan, values, framePointBytes(plan, settings), ofFrame);
    memory.smallest = ofFrame.smallest = std::min(memory.smallest, ofFrame.smallest);
    return ofFrame.need.total() <= ofFrame.limit && ofFrame.pagedShare() >= memory.pagedShare()
               ? ofFrame
               : memory;
}

}  // namespace

MemoryPlan planMemory(const Scene& scene, const Plan& plan, const SettingValues& values,
                      const BucketGrid& grid, std::uint64_t texelBytes) {
    const CacheSizes whole{texelBytes, scene.groupBytes()};
    const std::uint64_t limit = memoryLimitBytes(values.number(Setting::kMemoryLimit));
    MemoryPlan memory = planWith(scene, plan, values, grid, wantedOf(whole, limit));
    if (memory.need.total() > limit) memory = planWith(scene, plan, values, grid, leastOf(whole));
    growCaches(whole, memory);
    memory.hostPeak = static_cast<std::uint64_t>(values.number(Setting::kHostPeak) * kGib);
    memory.smallest = std::max(memory.smallest, memory.hostPeak);
    return memory;
}

std::string MemoryPlan::explain() const {
    std::string text = fmt::format("memory: {}", figures(need));
    if (byBuckets)
        text += fmt::format(
            ", bucket by bucket with the maps of all passes; the whole frame would need {:.2f} GiB",
            toGib(whole.total()));
    text += fmt::format(", the limit is {:.2f} GiB", toGib(limit));
    if (need.total() > limit || hostPeak > limit) text += ": the render would be refused";
    text += "\n";
    if (pages > 0)
        text += fmt::format(
            "photon pages: of {:.2f} GiB of photons {:.2f} GiB are held at once, the rest is read "
            "again from scratch files\n",
            toGib(pagedBytes), toGib(std::min(pages, pagedBytes)));
    return text;
}

void MemoryPlan::check() const {
    if (need.total() <= limit && hostPeak <= limit) return;
    std::string text = fmt::format("the render needs {}", figures(need));
    if (byBuckets && need.total() > limit)
        text += fmt::format(
            " even bucket by bucket, with the maps of all passes; with the whole "
            "frame {:.2f} GiB",
            toGib(whole.total()));
    if (hostPeak > limit)
        text += fmt::format("; the host needs {:.2f} GiB before it", toGib(hostPeak));
    text += fmt::format("; the memory limit is {:.2f} GiB, the smallest that works {:.3f} GiB",
                        toGib(limit), std::ceil(1000 * toGib(smallest)) / 1000);
    if (!whyWhole.empty())
        text += fmt::format("; bucket by bucket does not go together with {}", whyWhole);
    throw CallError(CallStatus::kMemory, text);
}

}  // namespace pm::plugin
