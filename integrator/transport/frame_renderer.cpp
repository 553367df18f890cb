// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame_renderer.h"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <utility>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/pixel_cell.h"
#include "integrator/transport/frame/pixel_sums.h"
#include "integrator/transport/path/path_integrator.h"
#include "integrator/transport/photon/photon_integrator.h"
#include "integrator/transport/photon/photon_pass.h"
#include "integrator/transport/seen_lights/seen_lamps.h"
#include "integrator/transport/survey/lamp_samples.h"
#include "integrator/transport/survey/lit_places.h"
#include "integrator/values/cancel_check.h"

namespace pm {

namespace {

// A render at level l has 4^(l-1) samples a pixel in this many passes.
constexpr std::uint32_t kPassesOfALevel = 4;

// Of throughputs, which are added up in whole ones: in any order the same sum.
constexpr double kThroughputStep = 0x1p-20;

// Of a pixel's group of 2 x 2, the first; also below 0.
std::int32_t firstOfGroup(std::int32_t coordinate) {
    return coordinate & ~1;
}

}  // namespace

SampleRun fixedSamples(const RenderSettings& settings, std::int32_t x, std::int32_t y,
                       std::uint32_t pass) {
    if (settings.aaLevel >= 2) {
        const std::uint32_t count = 1u << (2 * (settings.aaLevel - 2));
        return {pass / 2 * count, count, count};
    }
    const bool isOfGroup = settings.hasGroups();
    if (isOfGroup) {
        x = firstOfGroup(x);
        y = firstOfGroup(y);
    }
    // The turn moves on by one from four passes to the next: so it falls on even and odd passes
    // alternately.
    const std::uint32_t period = std::min(kPassesOfALevel, settings.passes);
    const std::uint64_t turn =
        combineBits(settings.seed, PixelCell{x, y, isOfGroup}.key()) % period + pass / period;
    const std::uint32_t count = turn % period == pass % period ? 1 : 0;
    return {pass / (2 * period), count, count, isOfGroup};
}

struct FrameRenderer::Impl {
    Impl(std::shared_ptr<const Scene> scene_, const RenderSettings& settings_, Plan plan_)
        : scene(std::move(scene_)),
          settings(settings_),
          layout(channelLayout(settings_)),
          plan(std::move(plan_)),
          camera(*scene, settings_.width, settings_.height) {}

    // What it takes time to make.
    struct Prepared {
        LightSampler lights;
        PhotonPass photons;
        SeenLamps seenLamps;

        Prepared(const Impl& impl, const CancelCheck& cancel)
            : lights(*impl.scene, cancel),
              photons(*impl.scene, impl.camera, lights, impl.plan, impl.settings),
              seenLamps(*impl.scene, lights, impl.camera, impl.settings) {}
    };

    void prepare(const std::atomic<bool>& cancelled);
    PhotonPass& photonsOfPass(std::uint32_t pass, const std::atomic<bool>& cancelled);
    SampleRadiance sample(std::uint32_t pass, const PixelCell& cell, const Sampler& sampler,
                          std::uint32_t index, NearestPhotons& scratch) const;
    struct Local;
    void renderCell(std::uint32_t pass, const PixelCell& cell, SampleRun run, float* pixel,
                    Local& local) const;

    const std::shared_ptr<const Scene> scene;
    const RenderSettings settings;
    const ChannelLayout layout;
    Plan plan;
    const Camera camera;
    const PhotonSource* photonSource = nullptr;
    MapPaging paging;
    std::unique_ptr<Prepared> prepared;
    std::uint32_t lastPass = 0;  // begun or added
    bool badValuesReported = false, cutsReported = false;
    mutable std::mutex mutex;  // of what follows, and for others than the passes of `prepared`
    mutable RenderCounters counters;
    mutable std::uint64_t throughputStepsCut = 0;
    std::vector<Notice> notices;
};

// Of one call that renders pixels.
struct FrameRenderer::Impl::Local {
    NearestPhotons scratch;
    const std::atomic<bool>& cancelled;
    RenderCounters counters{};
    std::uint64_t throughputStepsCut = 0;

    bool isCancelled() const { return cancelled.load(std::memory_order_relaxed); }
};

void FrameRenderer::Impl::prepare(const std::atomic<bool>& cancelled) {
    if (prepared) return;
    const CancelCheck cancel(cancelled);
    auto made = std::make_unique<Prepared>(*this, cancel);
    LightSampler& lights = made->lights;
    if (lights.learns())
        lights.learn(findLitPlaces(*scene, camera, settings, cancel), settings.seed, cancel);
    if (plan.lampSamples == 0)
        plan.lampSamples = findLampSamples(*scene, lights, camera, settings, plan, cancel);
    if (photonSource) made->photons.readFrom(*photonSource);
    made->photons.pageMaps(paging);
    const std::lock_guard lock(mutex);
    counters.lampSamples = plan.lampSamples;
    prepared = std::move(made);
}

PhotonPass& FrameRenderer::Impl::photonsOfPass(std::uint32_t pass,
                                               const std::atomic<bool>& cancelled) {
    prepare(cancelled);
    lastPass = pass;
    return prepared->photons;
}

SampleRadiance FrameRenderer::Impl::sample(std::uint32_t pass, const PixelCell& cell,
                                           const Sampler& sampler, std::uint32_t index,
                                           NearestPhotons& scratch) const {
    const Place place = cell.place(settings.filter, sampler.get2D(Purpose::kPlace));
    const Ray ray = camera.ray({place.x, place.y});
    const RayFootprint footprint = camera.footprint({place.x, place.y}, ray);
    if (settings.integrator == IntegratorKind::kPath)
        return PathIntegrator(*scene, prepared->lights).sample(ray, sampler, footprint);
    const SeenLamps::Shown lamps = prepared->seenLamps.shown(cell.x, cell.y);
    SampleRadiance result =
        PhotonIntegrator(*scene, prepared->lights, prepared->photons.maps(pass), plan.lampSamples)
            .sample({{static_cast<float>(place.x), static_cast<float>(place.y)},
                     ray,
                     camera.pixelBeam(ray),
                     lamps.paths == 0,
                     footprint},
                    sampler, scratch);
    if (lamps.paths > 0)
        result.emission += prepared->seenLamps.sample(lamps, pass, cell, index, result.rays);
    return result;
}

void FrameRenderer::Impl::renderCell(std::uint32_t pass, const PixelCell& cell, SampleRun run,
                                     float* pixel, Local& local) const {
    PixelSums sums;
    const Sampler cellSampler(settings.seed, cell.stream(pass), cell.key(), 0);
    for (std::uint32_t i = 0; i < run.count; ++i) {
        // Where next to nothing is absorbed a single one takes its time.
        if (local.isCancelled()) return;
        const std::uint32_t index = run.first + i;
        const SampleRadiance s = sample(pass, cell, cellSampler.at(index), index, local.scratch);
        local.counters.rays += s.rays;
        local.counters.pathsCut += s.pathsCut;
        local.throughputStepsCut += static_cast<std::uint64_t>(
            std::clamp(static_cast<double>(s.throughputCut), 0.0, 1e3) / kThroughputStep);
        if (const auto fault = PixelSums::faultOf(s)) {
            // Whole buckets are rendered; what is beyond the window is in no picture.
            if (settings.window.contains(cell.x, cell.y))
                local.counters.badSamples.add({pass, cell.y, cell.x, index, *fault});
            continue;
        }
        const double depth =
            s.coverage == 0.0f ? 0.0 : static_cast<double>(camera.depth(s.firstPosition));
        sums.add(s, depth, i < run.seen);
    }
    local.counters.cameraSamples += run.count;
    sums.write(layout, run.count, pixel);
}

FrameRenderer::FrameRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                             Plan plan)
    : m_impl(std::make_unique<Impl>(std::move(scene), settings, std::move(plan))) {}

FrameRenderer::FrameRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings)
    : FrameRenderer(scene, settings, makePlan(*scene, settings)) {}

FrameRenderer::~FrameRenderer() = default;

const Plan& FrameRenderer::plan() const {
    return m_impl->plan;
}

ChannelLayout FrameRenderer::layout() const {
    return m_impl->layout;
}

void FrameRenderer::prepare(const std::atomic<bool>& cancelled) {
    m_impl->prepare(cancelled);
}

void FrameRenderer::readPhotons(const PhotonSource& source) {
    m_impl->photonSource = &source;
    if (m_impl->prepared) m_impl->prepared->photons.readFrom(source);
}

void FrameRenderer::pageMaps(const MapPaging& paging) {
    m_impl->paging = paging;
    if (m_impl->prepared) m_impl->prepared->photons.pageMaps(paging);
}

void FrameRenderer::tracePass(std::uint32_t pass, PhotonSink& sink,
                              const std::atomic<bool>& cancelled,
                              const std::function<void(double)>& progress) {
    m_impl->prepare(cancelled);
    m_impl->prepared->photons.traceInto(sink, pass, cancelled, progress);
}

void FrameRenderer::beginPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                              const std::function<void(double)>& progress) {
    m_impl->photonsOfPass(pass, cancelled).begin(pass, cancelled, progress);
}

void FrameRenderer::addPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                            const std::function<void(double)>& progress) {
    m_impl->photonsOfPass(pass, cancelled).add(pass, cancelled, progress);
}

void FrameRenderer::renderRegion(const Rect& region, std::span<const SampleRun> runs,
                                 std::span<float> pixels,
                                 const std::atomic<bool>& cancelled) const {
    renderRegion(m_impl->lastPass, region, runs, pixels, cancelled);
}

void FrameRenderer::renderRegion(std::uint32_t pass, const Rect& region,
                                 std::span<const SampleRun> runs, std::span<float> pixels,
                                 const std::atomic<bool>& cancelled) const {
    std::fill(pixels.begin(), pixels.end(), 0.0f);
    Impl::Local local{.scratch = {}, .cancelled = cancelled};
    std::size_t i = 0;
    const auto channels = static_cast<std::size_t>(m_impl->layout.count);
    for (std::int32_t y = region.y0; y < region.y1; ++y) {
        if (local.isCancelled()) break;
        for (std::int32_t x = region.x0; x < region.x1; ++x, ++i) {
            if (runs[i].count == 0) continue;
            float* const pixel = pixels.data() + i * channels;
            PixelCell cell{x, y, runs[i].isOfGroup};
            if (cell.isGroup) {
                cell.x = firstOfGroup(x);
                cell.y = firstOfGroup(y);
                const auto before = static_cast<std::size_t>(x - std::max(cell.x, region.x0)) +
                                    static_cast<std::size_t>(y - std::max(cell.y, region.y0)) *
                                        static_cast<std::size_t>(region.width());
                if (before > 0) {
                    std::copy_n(pixel - before * channels, channels, pixel);
                    continue;
                }
            }
            m_impl->renderCell(pass, cell, runs[i], pixel, local);
        }
    }
    const std::lock_guard lock(m_impl->mutex);
    m_impl->counters.cameraSamples += local.counters.cameraSamples;
    m_impl->counters.rays += local.counters.rays;
    m_impl->counters.badSamples.add(local.counters.badSamples);
    m_impl->counters.pathsCut += local.counters.pathsCut;
    m_impl->throughputStepsCut += local.throughputStepsCut;
}

void FrameRenderer::renderRegion(const Rect& region, std::span<float> pixels,
                                 std::span<float> weights,
                                 const std::atomic<bool>& cancelled) const {
    std::vector<SampleRun> runs;
    runs.reserve(weights.size());
    for (std::int32_t y = region.y0; y < region.y1; ++y)
        for (std::int32_t x = region.x0; x < region.x1; ++x)
            runs.push_back(fixedSamples(m_impl->settings, x, y, m_impl->lastPass));
    renderRegion(region, runs, pixels, cancelled);
    std::ranges::transform(runs, weights.begin(), [](SampleRun run) { return run.weight(); });
}

void FrameRenderer::forget(const Rect& region, const Rect& all) const {
    if (m_impl->prepared) m_impl->prepared->photons.forget(region, all);
}

RenderCounters FrameRenderer::counters() const {
    const std::lock_guard lock(m_impl->mutex);
    RenderCounters sum = m_impl->counters;
    sum.throughputCut = static_cast<double>(m_impl->throughputStepsCut) * kThroughputStep;
    if (m_impl->prepared) m_impl->prepared->photons.addTo(sum);
    return sum;
}

std::vector<Notice> FrameRenderer::takeNotices() {
    const std::lock_guard lock(m_impl->mutex);
    if (m_impl->counters.badSamples.total() > 0 && !m_impl->badValuesReported) {
        m_impl->badValuesReported = true;
        m_impl->notices.push_back(
            {NoticeCode::kBadValues,
             "some samples were NaN, infinite or negative and count as black; "
             "their number and the first are in the statistics"});
    }
    if (m_impl->counters.pathsCut > 0 && !m_impl->cutsReported) {
        m_impl->cutsReported = true;
        m_impl->notices.push_back(
            {NoticeCode::kNotCovered,
             "some camera paths were cut off, caught between surfaces that absorb nothing; their "
             "number and throughput are in the statistics and count in the estimated error"});
    }
    std::vector<Notice> notices = std::exchange(m_impl->notices, {});
    if (m_impl->prepared)
        std::ranges::move(m_impl->prepared->photons.takeNotices(), std::back_inserter(notices));
    return notices;
}

}  // namespace pm
