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
#include "integrator/transport/lit_places.h"
#include "integrator/transport/path_integrator.h"
#include "integrator/transport/photon_integrator.h"
#include "integrator/transport/photon_pass.h"
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

// Sums over a pixel's samples, in double and in sample order.
struct PixelSums {
    std::array<double, 3> emission{}, direct{}, caustic{}, indirect{}, biasProbe{}, albedo{},
        normal{};
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
    layout.biasProbe = place(settings.integrator == IntegratorKind::kPhoton, 3);
    return layout;
}

struct FrameRenderer::Impl {
    Impl(std::shared_ptr<const Scene> scene_, const RenderSettings& settings_)
        : scene(std::move(scene_)),
          settings(settings_),
          layout(channelLayout(settings_)),
          plan(makePlan(*scene, settings_)),
          camera(*scene, settings_.width, settings_.height),
          lights(*scene),
          photons(*scene, camera, lights, plan, settings) {
        if (lights.isGuided()) lights.learn(findLitPlaces(*scene, camera, settings), settings.seed);
    }

    SampleRadiance sample(std::int32_t x, std::int32_t y, std::uint32_t index,
                          NearestPhotons& scratch) const;
    void renderPixel(std::int32_t x, std::int32_t y, std::uint32_t samples, float* pixel,
                     NearestPhotons& scratch, RenderCounters& local) const;
    void writePixel(const PixelSums& sums, std::uint32_t samples, float* pixel) const;

    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    ChannelLayout layout;
    Plan plan;
    Camera camera;
    LightSampler lights;
    PhotonPass photons;
    std::uint32_t pass = 0;
    bool badValuesReported = false;
    mutable std::mutex mutex;  // of what follows
    mutable RenderCounters counters;
    std::vector<Notice> notices;
};

SampleRadiance FrameRenderer::Impl::sample(std::int32_t x, std::int32_t y, std::uint32_t index,
                                           NearestPhotons& scratch) const {
    // The even passes' samples are one low-discrepancy sequence, the odd passes' another: samples
    // added later fall between those before, and the two halves' errors share nothing. Odd streams
    // are photons'; see PhotonTracer.
    Sampler sampler(settings.seed, 2 * std::uint64_t{pass % 2}, pixelKey(x, y), index);
    const Vec2f jitter = sampler.next2D();
    const double onX = x + static_cast<double>(jitter.x), onY = y + static_cast<double>(jitter.y);
    const Ray ray = camera.ray(onX, onY);
    if (settings.integrator == IntegratorKind::kPath)
        return PathIntegrator(*scene, lights).sample(ray, sampler);
    return PhotonIntegrator(*scene, lights, photons.maps())
        .sample({static_cast<float>(onX), static_cast<float>(onY)}, ray, sampler, scratch);
}

void FrameRenderer::Impl::renderPixel(std::int32_t x, std::int32_t y, std::uint32_t samples,
                                      float* pixel, NearestPhotons& scratch,
                                      RenderCounters& local) const {
    PixelSums sums;
    const std::uint32_t first = pass / 2 * samples;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const SampleRadiance s = sample(x, y, first + i, scratch);
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
    put(layout.biasProbe, sums.biasProbe);
    put(layout.albedo, sums.albedo);
    put(layout.normal, sums.normal);
    pixel[layout.alpha] = static_cast<float>(sums.coverage * scale);
    if (layout.depth >= 0) pixel[layout.depth] = static_cast<float>(sums.depth * scale);
    for (int c = 0; c < 3; ++c)
        pixel[layout.beauty + c] = pixel[layout.direct + c] + pixel[layout.indirect + c] +
                                   pixel[layout.caustic + c] + pixel[layout.emission + c];
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
    m_impl->photons.begin(pass, cancelled, progress);
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
