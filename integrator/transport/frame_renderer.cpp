// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame_renderer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include "integrator/photons/caustic_map.h"
#include "integrator/photons/irradiance_sites.h"
#include "integrator/photons/photon_map.h"
#include "integrator/photons/photon_tracer.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/path_integrator.h"
#include "integrator/transport/photon_integrator.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

// A render at level l has 4^(l-1) samples a pixel in this many passes.
constexpr std::uint32_t kPassesOfALevel = 4;

std::uint64_t pixelKey(std::int32_t x, std::int32_t y) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 |
           static_cast<std::uint32_t>(x);
}

// Samples of a pixel in a pass. At level 1 a pixel has one sample, in the pass that its hash names.
std::uint32_t samplesInPass(const RenderSettings& settings, std::uint64_t key, std::uint32_t pass) {
    if (settings.aaLevel >= 2) return 1u << (2 * (settings.aaLevel - 2));
    const std::uint32_t period = std::min(kPassesOfALevel, settings.passes);
    return combineBits(settings.seed, key) % period == pass % period ? 1 : 0;
}

double secondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Radius of a pass over the first one's: r^2 shrinks by (i + a)/(i + 1) from pass i to the next, so
// that bias and variance both go to 0 over the passes.
// Source: Knaus & Zwicker 2011, eq. 20, alpha = 2/3.
float radiusFactor(std::uint32_t pass) {
    double squared = 1.0;
    for (std::uint32_t i = 0; i < pass; ++i) squared *= (i + 2.0 / 3.0) / (i + 1.0);
    return static_cast<float>(std::sqrt(squared));
}

// Sums over a pixel's samples, in double and in sample order.
struct PixelSums {
    std::array<double, 3> emission{}, direct{}, caustic{}, indirect{}, albedo{}, normal{};
    double coverage = 0, depth = 0;
};

template <typename Triple>
void add(std::array<double, 3>& sum, const Triple& value) {
    for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += static_cast<double>(value[c]);
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
    return layout;
}

struct FrameRenderer::Impl {
    Impl(std::shared_ptr<const Scene> scene_, const RenderSettings& settings_)
        : scene(std::move(scene_)),
          settings(settings_),
          layout(channelLayout(settings_)),
          plan(makePlan(*scene, settings_)),
          camera(*scene, settings_.width, settings_.height),
          lights(*scene) {
        notices = plan.notices;
    }

    SampleRadiance sample(std::int32_t x, std::int32_t y, std::uint32_t index,
                          NearestPhotons& scratch) const;
    void renderPixel(std::int32_t x, std::int32_t y, std::uint32_t samples, float* pixel,
                     NearestPhotons& scratch, RenderCounters& local) const;
    // What a pass's tracing reports to.
    struct PassControl {
        const std::atomic<bool>& cancelled;
        const std::function<void(double)>& progress;
        mutable std::uint64_t photonsBefore = 0;
    };
    void count(PhotonKind kind, const PhotonBalance& balance);
    std::vector<Photon> trace(PhotonKind kind, std::uint64_t photons, const PassControl& control);
    void buildMaps(const PassControl& control);
    void findRadii(const PassControl& control);
    void dropMaps();
    void writePixel(const PixelSums& sums, std::uint32_t samples, float* pixel) const;

    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    ChannelLayout layout;
    Plan plan;
    Camera camera;
    LightSampler lights;
    std::uint32_t pass = 0;
    // Found once a render, by pilots.
    bool haveRadii = false;
    float globalRadius = 0.0f;
    std::unique_ptr<CausticRadius> causticRadius;
    // Of this pass.
    std::unique_ptr<PhotonMap> globalMap;
    std::unique_ptr<IrradianceSites> sites;  // refers to globalMap
    std::unique_ptr<CausticMap> causticMap;  // refers to causticRadius
    bool badValuesReported = false;
    mutable std::mutex mutex;  // of what follows
    mutable RenderCounters counters;
    std::vector<Notice> notices;
};

SampleRadiance FrameRenderer::Impl::sample(std::int32_t x, std::int32_t y, std::uint32_t index,
                                           NearestPhotons& scratch) const {
    // Odd streams are photons'; see PhotonTracer.
    Sampler sampler(settings.seed, 2 * std::uint64_t{pass}, pixelKey(x, y), index);
    const Vec2f jitter = sampler.next2D();
    const Ray ray =
        camera.ray(x + static_cast<double>(jitter.x), y + static_cast<double>(jitter.y));
    if (settings.integrator == IntegratorKind::kPath)
        return PathIntegrator(*scene, lights).sample(ray, sampler);
    return PhotonIntegrator(*scene, lights, {sites.get(), causticMap.get()}, settings.gatherRays)
        .sample(ray, sampler, scratch);
}

void FrameRenderer::Impl::renderPixel(std::int32_t x, std::int32_t y, std::uint32_t samples,
                                      float* pixel, NearestPhotons& scratch,
                                      RenderCounters& local) const {
    PixelSums sums;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const SampleRadiance s = sample(x, y, i, scratch);
        local.rays += s.rays;
        if (!isFinite(s.emission) || !isFinite(s.direct) || !isFinite(s.caustic) ||
            !isFinite(s.indirect)) {
            ++local.badSamples;
            continue;
        }
        add(sums.emission, s.emission);
        add(sums.direct, s.direct);
        add(sums.caustic, s.caustic);
        add(sums.indirect, s.indirect);
        sums.coverage += static_cast<double>(s.coverage);
        if (s.coverage == 0.0f) continue;
        add(sums.albedo, s.albedo);
        add(sums.normal, s.normal);
        sums.depth += static_cast<double>(camera.depth(s.firstPosition));
    }
    local.cameraSamples += samples;
    writePixel(sums, samples, pixel);
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
    put(layout.albedo, sums.albedo);
    put(layout.normal, sums.normal);
    pixel[layout.alpha] = static_cast<float>(sums.coverage * scale);
    if (layout.depth >= 0) pixel[layout.depth] = static_cast<float>(sums.depth * scale);
    for (int c = 0; c < 3; ++c)
        pixel[layout.beauty + c] = pixel[layout.direct + c] + pixel[layout.indirect + c] +
                                   pixel[layout.caustic + c] + pixel[layout.emission + c];
}

void FrameRenderer::Impl::count(PhotonKind kind, const PhotonBalance& balance) {
    const std::lock_guard lock(mutex);
    counters.rays += balance.rays;
    counters.photonsEmitted += balance.emitted;
    counters.photonsLost += balance.lost;
    if (kind == PhotonKind::kGlobal) {
        counters.fluxEmitted += balance.fluxEmitted;
        counters.fluxAbsorbed += balance.fluxAbsorbed;
        counters.fluxEscaped += balance.fluxEscaped;
        counters.fluxLost += balance.fluxLost;
        counters.photonsStoredGlobal += balance.stored;
    }
    if (kind == PhotonKind::kCaustic) counters.photonsStoredCaustic += balance.stored;
    // Notices come once a render, from its pilots, not once a pass.
    if (balance.stored == 0 && kind == PhotonKind::kGlobalPilot)
        notices.push_back({NoticeCode::kNoPhotons,
                           "0 photons reached a diffuse surface, so there is no indirect light"});
    if (balance.stored == 0 && kind == PhotonKind::kCausticPilot)
        notices.push_back({NoticeCode::kNoCausticPhotons,
                           "0 photons reached a diffuse surface by way of another, so there is no "
                           "caustic light"});
    if (balance.lost > 0 && (kind == PhotonKind::kGlobalPilot || kind == PhotonKind::kCausticPilot))
        notices.push_back({NoticeCode::kLostPhotons,
                           std::to_string(balance.lost) + " of " + std::to_string(balance.emitted) +
                               " pilot photons were lost: caught between lossless surfaces or "
                               "spoiled by rounding"});
}

std::vector<Photon> FrameRenderer::Impl::trace(PhotonKind kind, std::uint64_t photons,
                                               const PassControl& control) {
    const auto start = std::chrono::steady_clock::now();
    const auto part = [&](double fraction) {
        if (control.progress)
            control.progress(std::min(1.0, (static_cast<double>(control.photonsBefore) +
                                            fraction * static_cast<double>(photons)) /
                                               static_cast<double>(plan.photonsPerPass())));
    };
    PhotonTraceResult result =
        tracePhotons(*scene, lights, {kind, photons, settings.seed, pass}, control.cancelled, part);
    count(kind, result.balance);
    control.photonsBefore += photons;
    const std::lock_guard lock(mutex);
    counters.photonSeconds += secondsSince(start);
    return std::move(result.photons);
}

void FrameRenderer::Impl::findRadii(const PassControl& control) {
    const std::uint32_t wanted = std::exchange(pass, 0);
    if (plan.globalMap) {
        const PhotonMap pilot(trace(PhotonKind::kGlobalPilot, plan.globalPilotPhotons(), control));
        globalRadius = pilot.typicalRadius(
            std::max(4u, settings.estimatePhotons / CausticRadius::kPilotShare));
    }
    if (plan.causticMap)
        causticRadius = std::make_unique<CausticRadius>(
            trace(PhotonKind::kCausticPilot, plan.causticPilotPhotons(), control),
            settings.estimatePhotons);
    pass = wanted;
    haveRadii = true;
    control.photonsBefore = 0;
}

void FrameRenderer::Impl::buildMaps(const PassControl& control) {
    const float factor = radiusFactor(pass);
    double seconds = 0;
    const auto timed = [&](const auto& build) {
        const auto start = std::chrono::steady_clock::now();
        build();
        seconds += secondsSince(start);
    };
    if (plan.globalMap) {
        std::vector<Photon> photons = trace(PhotonKind::kGlobal, plan.globalPhotons, control);
        std::vector<Photon> places = trace(PhotonKind::kSites, plan.sitePhotons, control);
        timed([&] {
            globalMap = std::make_unique<PhotonMap>(std::move(photons));
            sites = std::make_unique<IrradianceSites>(*scene, *globalMap, std::move(places),
                                                      globalRadius * factor);
        });
    }
    if (plan.causticMap) {
        std::vector<Photon> photons = trace(PhotonKind::kCaustic, plan.causticPhotons, control);
        timed([&] {
            causticMap = std::make_unique<CausticMap>(std::move(photons), *causticRadius, factor);
        });
    }
    const std::uint64_t bytes = (globalMap ? globalMap->memoryBytes() + sites->memoryBytes() : 0) +
                                (causticMap ? causticMap->memoryBytes() : 0) +
                                (causticRadius ? causticRadius->memoryBytes() : 0);
    const std::lock_guard lock(mutex);
    counters.mapSeconds += seconds;
    counters.peakMapBytes = std::max(counters.peakMapBytes, bytes);
}

void FrameRenderer::Impl::dropMaps() {
    sites.reset();
    globalMap.reset();
    causticMap.reset();
}

FrameRenderer::FrameRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings)
    : m_impl(std::make_unique<Impl>(std::move(scene), settings)) {}

FrameRenderer::~FrameRenderer() = default;

const Plan& FrameRenderer::plan() const {
    return m_impl->plan;
}

ChannelLayout FrameRenderer::layout() const {
    return m_impl->layout;
}

void FrameRenderer::beginPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                              const std::function<void(double)>& progress) {
    m_impl->pass = pass;
    m_impl->dropMaps();
    if (!m_impl->plan.tracePhotons) return;
    const Impl::PassControl control{cancelled, progress};
    if (!m_impl->haveRadii) m_impl->findRadii(control);
    m_impl->buildMaps(control);
}

void FrameRenderer::renderRegion(const Rect& region, std::span<float> pixels,
                                 std::span<float> weights,
                                 const std::atomic<bool>& cancelled) const {
    std::fill(pixels.begin(), pixels.end(), 0.0f);
    std::fill(weights.begin(), weights.end(), 0.0f);
    NearestPhotons scratch;
    RenderCounters local;
    std::size_t i = 0;
    const auto channels = static_cast<std::size_t>(m_impl->layout.count);
    for (std::int32_t y = region.y0; y < region.y1; ++y) {
        if (cancelled.load(std::memory_order_relaxed)) break;
        for (std::int32_t x = region.x0; x < region.x1; ++x, ++i) {
            const std::uint32_t samples =
                samplesInPass(m_impl->settings, pixelKey(x, y), m_impl->pass);
            if (samples == 0) continue;
            m_impl->renderPixel(x, y, samples, pixels.data() + i * channels, scratch, local);
            weights[i] = static_cast<float>(samples);
        }
    }
    const std::lock_guard lock(m_impl->mutex);
    m_impl->counters.cameraSamples += local.cameraSamples;
    m_impl->counters.rays += local.rays;
    m_impl->counters.badSamples += local.badSamples;
}

RenderCounters FrameRenderer::counters() const {
    const std::lock_guard lock(m_impl->mutex);
    return m_impl->counters;
}

std::vector<Notice> FrameRenderer::takeNotices() {
    const std::lock_guard lock(m_impl->mutex);
    if (m_impl->counters.badSamples > 0 && !m_impl->badValuesReported) {
        m_impl->badValuesReported = true;
        m_impl->notices.push_back({NoticeCode::kBadValues,
                                   "some samples were NaN or infinite and count as black; their "
                                   "number is in the statistics"});
    }
    return std::exchange(m_impl->notices, {});
}

}  // namespace pm
