// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame_renderer.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <mutex>
#include <utility>

#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/lamp_samples.h"
#include "integrator/transport/lit_places.h"
#include "integrator/transport/path_integrator.h"
#include "integrator/transport/photon_integrator.h"
#include "integrator/transport/photon_pass.h"
#include "integrator/transport/seen_lamps.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

// A render at level l has 4^(l-1) samples a pixel in this many passes.
constexpr std::uint32_t kPassesOfALevel = 4;
// Far above that of any picture, and a float.
constexpr double kLargestSquare = 1e36;

std::uint64_t pixelKey(std::int32_t x, std::int32_t y) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 |
           static_cast<std::uint32_t>(x);
}

// What is sampled as one pixel: a pixel, or a group of twice its side.
struct Cell {
    std::int32_t x, y;  // its left and upper edge, pixels
    bool isGroup;
};

// The even passes' samples are one low-discrepancy sequence, the odd passes' another: samples added
// later fall between those before, and the two halves' errors share nothing. Groups have sequences
// that no pixel has. Odd streams are photons'; see PhotonTracer.
std::uint64_t streamOf(std::uint32_t pass, const Cell& cell) {
    return 2 * std::uint64_t{pass % 2} + (cell.isGroup ? 4 : 0);
}

// Where a ray leaves the camera, pixels of the frame.
struct Place {
    double x, y;
};

// Sums over a pixel's samples, in double and in sample order.
struct PixelSums {
    std::array<double, 3> emission{}, direct{}, caustic{}, indirect{}, biasProbe{}, albedo{},
        normal{};
    double coverage = 0, depth = 0;
    std::array<double, 5> seen{};  // as ChannelLayout::seen
};

template <typename Triple>
void add(std::array<double, 3>& sum, const Triple& value) {
    for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += static_cast<double>(value[c]);
}

// ChannelLayout::contribution of a sample; 0 where it met nothing.
float contributionOf(const SampleRadiance& s) {
    if (s.coverage == 0.0f) return 0.0f;
    return static_cast<float>(1 + (combineBits(s.firstShape, s.firstMaterial) >> 40));
}

// Of a pixel's group of 2 x 2, the first; also below 0.
std::int32_t firstOfGroup(std::int32_t coordinate) {
    return coordinate & ~1;
}

void addSeen(const Rgb& beauty, PixelSums& sums) {
    ++sums.seen[0];
    for (int c = 0; c < 3; ++c) {
        const auto value = static_cast<double>(beauty[c]);
        sums.seen[static_cast<std::size_t>(c) + 1] += value;
        sums.seen[4] += value * value;
    }
}

}  // namespace

ChannelLayout channelLayout(const RenderSettings& settings) {
    ChannelLayout layout;
    const auto place = [&](bool wanted, std::int32_t size) {
        if (!wanted) return -1;
        layout.count += size;
        return layout.count - size;
    };
    layout.albedo = place(settings.wantAlbedo, 3);
    layout.normal = place(settings.wantNormal, 3);
    layout.depth = place(settings.wantDepth, 1);
    layout.biasProbe = place(settings.integrator == IntegratorKind::kPhoton, 3);
    layout.seen = place(settings.isAdaptive(), 5);
    layout.contribution = place(settings.isAdaptive() && settings.hasGroups(), 1);
    return layout;
}

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
    const std::uint64_t turn = combineBits(settings.seed, pixelKey(x, y)) % period + pass / period;
    const std::uint32_t count = turn % period == pass % period ? 1 : 0;
    return {pass / (2 * period), count, count, isOfGroup};
}

struct FrameRenderer::Impl {
    Impl(std::shared_ptr<const Scene> scene_, const RenderSettings& settings_, Plan plan_)
        : scene(std::move(scene_)),
          settings(settings_),
          layout(channelLayout(settings_)),
          plan(std::move(plan_)),
          camera(*scene, settings_.width, settings_.height),
          lights(*scene),
          photons(*scene, camera, lights, plan, settings),
          seenLamps(*scene, lights, camera, settings_.width, settings_.height) {
        if (lights.isGuided()) lights.learn(findLitPlaces(*scene, camera, settings), settings.seed);
        if (plan.lampSamples == 0)
            plan.lampSamples = findLampSamples(*scene, lights, camera, settings, plan);
    }

    Place placeInCell(const Cell& cell, Vec2f u) const;
    SampleRadiance sample(std::uint32_t pass, const Cell& cell, Sampler sampler,
                          std::uint32_t index, NearestPhotons& scratch) const;
    void renderCell(std::uint32_t pass, const Cell& cell, SampleRun run, float* pixel,
                    NearestPhotons& scratch, RenderCounters& local) const;
    void writePixel(const PixelSums& sums, std::uint32_t samples, float* pixel) const;

    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    ChannelLayout layout;
    Plan plan;
    Camera camera;
    LightSampler lights;
    PhotonPass photons;
    SeenLamps seenLamps;
    std::uint32_t lastPass = 0;  // begun or added
    bool badValuesReported = false;
    mutable std::mutex mutex;  // of what follows
    mutable RenderCounters counters;
    std::vector<Notice> notices;
};

Place FrameRenderer::Impl::placeInCell(const Cell& cell, Vec2f u) const {
    const double side = cell.isGroup ? 2.0 : 1.0;
    return {cell.x + side * placeInPixel(settings.filter, u.x),
            cell.y + side * placeInPixel(settings.filter, u.y)};
}

SampleRadiance FrameRenderer::Impl::sample(std::uint32_t pass, const Cell& cell, Sampler sampler,
                                           std::uint32_t index, NearestPhotons& scratch) const {
    const Place place = placeInCell(cell, sampler.next2D());
    const Ray ray = camera.ray(place.x, place.y);
    if (settings.integrator == IntegratorKind::kPath)
        return PathIntegrator(*scene, lights).sample(ray, sampler);
    const std::uint32_t lampPaths = seenLamps.paths(cell.x, cell.y);
    SampleRadiance result = PhotonIntegrator(*scene, lights, photons.maps(pass), plan.lampSamples)
                                .sample({static_cast<float>(place.x), static_cast<float>(place.y)},
                                        ray, sampler, scratch, lampPaths == 0);
    // By a sequence of their own in the pixel.
    for (std::uint32_t i = 0; i < lampPaths; ++i) {
        Sampler lampSampler(settings.seed, streamOf(pass, cell) + 8, pixelKey(cell.x, cell.y),
                            index * lampPaths + i);
        const Place seen = placeInCell(cell, lampSampler.next2D());
        result.emission += seenLamps.along(camera.ray(seen.x, seen.y), lampSampler, result.rays) /
                           static_cast<float>(lampPaths);
    }
    return result;
}

void FrameRenderer::Impl::renderCell(std::uint32_t pass, const Cell& cell, SampleRun run,
                                     float* pixel, NearestPhotons& scratch,
                                     RenderCounters& local) const {
    PixelSums sums;
    const Sampler cellSampler(settings.seed, streamOf(pass, cell), pixelKey(cell.x, cell.y), 0);
    for (std::uint32_t i = 0; i < run.count; ++i) {
        const std::uint32_t index = run.first + i;
        const SampleRadiance s = sample(pass, cell, cellSampler.at(index), index, scratch);
        local.rays += s.rays;
        if (!isFinite(s.emission) || !isFinite(s.direct) || !isFinite(s.caustic) ||
            !isFinite(s.indirect) || !isFinite(s.biasProbe)) {
            ++local.badSamples;
            continue;
        }
        add(sums.emission, s.emission);
        add(sums.direct, s.direct);
        add(sums.caustic, s.caustic);
        add(sums.indirect, s.indirect);
        add(sums.biasProbe, s.biasProbe);
        if (i < run.seen) addSeen(s.emission + s.direct + s.caustic + s.indirect, sums);
        if (layout.contribution >= 0) pixel[layout.contribution] = contributionOf(s);
        sums.coverage += static_cast<double>(s.coverage);
        if (s.coverage == 0.0f) continue;
        add(sums.albedo, s.albedo);
        add(sums.normal, s.normal);
        sums.depth += static_cast<double>(camera.depth(s.firstPosition));
    }
    local.cameraSamples += run.count;
    writePixel(sums, run.count, pixel);
}

void FrameRenderer::Impl::writePixel(const PixelSums& sums, std::uint32_t samples,
                                     float* pixel) const {
    const double scale = 1.0 / samples;
    const auto put = [&](std::int32_t offset, const std::array<double, 3>& sum) {
        if (offset < 0) return;
        for (std::size_t c = 0; c < 3; ++c)
            pixel[static_cast<std::size_t>(offset) + c] = static_cast<float>(sum[c] * scale);
    };
    put(layout.direct, sums.direct);
    put(layout.indirect, sums.indirect);
    put(layout.caustic, sums.caustic);
    put(layout.emission, sums.emission);
    put(layout.biasProbe, sums.biasProbe);
    for (std::size_t i = 0; i < sums.seen.size() && layout.seen >= 0; ++i)
        pixel[static_cast<std::size_t>(layout.seen) + i] =
            static_cast<float>(std::min(sums.seen[i], kLargestSquare));
    put(layout.albedo, sums.albedo);
    put(layout.normal, sums.normal);
    pixel[layout.alpha] = static_cast<float>(sums.coverage * scale);
    if (layout.depth >= 0) pixel[layout.depth] = static_cast<float>(sums.depth * scale);
    for (int c = 0; c < 3; ++c)
        pixel[layout.beauty + c] = pixel[layout.direct + c] + pixel[layout.indirect + c] +
                                   pixel[layout.caustic + c] + pixel[layout.emission + c];
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

void FrameRenderer::readPhotons(const PhotonSource& source) {
    m_impl->photons.readFrom(source);
}

void FrameRenderer::tracePass(std::uint32_t pass, PhotonSink& sink,
                              const std::atomic<bool>& cancelled,
                              const std::function<void(double)>& progress) {
    m_impl->photons.traceInto(sink, pass, cancelled, progress);
}

void FrameRenderer::beginPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                              const std::function<void(double)>& progress) {
    m_impl->lastPass = pass;
    m_impl->photons.begin(pass, cancelled, progress);
}

void FrameRenderer::addPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                            const std::function<void(double)>& progress) {
    m_impl->lastPass = pass;
    m_impl->photons.add(pass, cancelled, progress);
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
    NearestPhotons scratch;
    RenderCounters local;
    std::size_t i = 0;
    const auto channels = static_cast<std::size_t>(m_impl->layout.count);
    for (std::int32_t y = region.y0; y < region.y1; ++y) {
        if (cancelled.load(std::memory_order_relaxed)) break;
        for (std::int32_t x = region.x0; x < region.x1; ++x, ++i) {
            if (runs[i].count == 0) continue;
            float* const pixel = pixels.data() + i * channels;
            Cell cell{x, y, runs[i].isOfGroup};
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
            m_impl->renderCell(pass, cell, runs[i], pixel, scratch, local);
        }
    }
    const std::lock_guard lock(m_impl->mutex);
    m_impl->counters.cameraSamples += local.cameraSamples;
    m_impl->counters.rays += local.rays;
    m_impl->counters.badSamples += local.badSamples;
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

RenderCounters FrameRenderer::counters() const {
    const std::lock_guard lock(m_impl->mutex);
    RenderCounters sum = m_impl->counters;
    m_impl->photons.addTo(sum);
    return sum;
}

std::vector<Notice> FrameRenderer::takeNotices() {
    const std::lock_guard lock(m_impl->mutex);
    if (m_impl->counters.badSamples > 0 && !m_impl->badValuesReported) {
        m_impl->badValuesReported = true;
        m_impl->notices.push_back({NoticeCode::kBadValues,
                                   "some samples were NaN or infinite and count as black; their "
                                   "number is in the statistics"});
    }
    std::vector<Notice> notices = std::exchange(m_impl->notices, {});
    std::ranges::move(m_impl->photons.takeNotices(), std::back_inserter(notices));
    return notices;
}

}  // namespace pm
