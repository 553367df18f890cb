// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/support/replicates.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>

#include "integrator/transport/frame_renderer.h"
#include "integrator/transport/photon/photon_integrator.h"

namespace pm::test {

namespace {

const std::atomic<bool> kNotCancelled{false};

void add(LayerMeans& means, Layer layer, const Rgb& value, double scale) {
    for (int c = 0; c < 3; ++c)
        means[layer][static_cast<std::size_t>(c)] += static_cast<double>(value[c]) * scale;
}

LayerMeans renderRegion(const FrameRenderer& renderer, const Rect& region) {
    const ChannelLayout layout = renderer.layout();
    const auto pixels = static_cast<std::size_t>(region.area());
    const auto channels = static_cast<std::size_t>(layout.count);
    std::vector<float> values(pixels * channels), weights(pixels);
    renderer.renderRegion(region, values, weights, kNotCancelled);
    LayerMeans means{};
    double weight = 0;
    for (const float w : weights) weight += static_cast<double>(w);
    for (std::size_t i = 0; i < pixels; ++i) {
        const double share = static_cast<double>(weights[i]) / weight;
        const auto at = [&](std::int32_t offset) {
            const float* const v = values.data() + i * channels + offset;
            return Rgb(v[0], v[1], v[2]);
        };
        add(means, kBeauty, at(layout.beauty), share);
        add(means, kEmission, at(layout.emission), share);
        add(means, kDirect, at(layout.direct), share);
        add(means, kCaustic, at(layout.caustic), share);
        add(means, kIndirect, at(layout.indirect), share);
        add(means, kCorrected, at(layout.beauty), share);
        if (layout.biasProbe >= 0) add(means, kCorrected, at(layout.biasProbe), 2 * share);
    }
    return means;
}

}  // namespace

std::vector<Rect> squares(std::int32_t width, std::int32_t height, std::int32_t size) {
    std::vector<Rect> regions;
    for (std::int32_t y = 0; y < height; y += size)
        for (std::int32_t x = 0; x < width; x += size)
            regions.push_back({x, y, x + size, y + size});
    return regions;
}

RegionMeans render(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings,
                   const std::vector<Rect>& regions, std::uint32_t firstPass) {
    FrameRenderer renderer(scene, settings);
    RegionMeans mean(regions.size());
    for (std::uint32_t pass = 0; pass < settings.passes; ++pass) {
        renderer.beginPass(firstPass + pass, kNotCancelled, {});
        RegionMeans one(regions.size());
        tbb::parallel_for(std::size_t{0}, regions.size(),
                          [&](std::size_t r) { one[r] = renderRegion(renderer, regions[r]); });
        addTo(mean, one, 1.0 / settings.passes);
    }
    EXPECT_EQ(renderer.counters().badSamples.total(), 0u);
    return mean;
}

std::uint64_t firstSeed() {
    const char* const given = std::getenv("PM_FIRST_SEED");
    return given ? std::strtoull(given, nullptr, 10) : 1;
}

std::vector<RegionMeans> replicate(int count,
                                   const std::function<RegionMeans(std::uint64_t seed)>& render) {
    std::vector<RegionMeans> renders;
    for (int i = 0; i < count; ++i)
        renders.push_back(render(firstSeed() + static_cast<std::uint64_t>(i)));
    return renders;
}

void addTo(RegionMeans& a, const RegionMeans& b, double scale) {
    a.resize(b.size());
    for (std::size_t r = 0; r < b.size(); ++r)
        for (std::size_t l = 0; l < kLayerCount; ++l)
            for (std::size_t c = 0; c < 3; ++c) a[r][l][c] += b[r][l][c] * scale;
}

std::vector<RegionMeans> wholeFrames(const std::vector<RegionMeans>& renders) {
    std::vector<RegionMeans> wholes;
    for (const RegionMeans& render : renders) {
        RegionMeans whole(1);
        for (const LayerMeans& region : render)
            addTo(whole, {region}, 1.0 / static_cast<double>(render.size()));
        wholes.push_back(whole);
    }
    return wholes;
}

Replicated spread(const std::vector<RegionMeans>& renders, std::size_t region, Layer layer,
                  std::size_t channel) {
    Replicated r;
    r.count = static_cast<int>(renders.size());
    for (const RegionMeans& one : renders) r.mean += one[region][layer][channel] / r.count;
    double squares = 0;
    for (const RegionMeans& one : renders) {
        const double off = one[region][layer][channel] - r.mean;
        squares += off * off;
    }
    r.standardError = std::sqrt(squares / (r.count * (r.count - 1.0)));
    return r;
}

double zScore(const Replicated& a, const Replicated& b, double allowed) {
    const double off = std::abs(a.mean - b.mean) - allowed;
    if (off <= 0) return 0;
    const double va = a.standardError * a.standardError, vb = b.standardError * b.standardError;
    const double variance = va + vb;
    if (!(variance > 0)) return std::numeric_limits<double>::infinity();  // bits that differ
    const double t = off / std::sqrt(variance);
    const double freedom =
        variance * variance /
        (va * va / std::max(1, a.count - 1) + vb * vb / std::max(1, b.count - 1));
    return std::sqrt(freedom * std::log1p(t * t / freedom)) * (8 * freedom + 1) / (8 * freedom + 3);
}

double expectAgreement(const std::vector<RegionMeans>& a, const std::vector<RegionMeans>& b,
                       Layer layer, double allowed, double limit, const std::string& what) {
    const std::size_t regions = a.front().size();
    double worst = -1, strict = 0;
    std::string where;
    for (std::size_t c = 0; c < 3; ++c) {
        double level = 0;
        for (std::size_t r = 0; r < regions; ++r)
            level += spread(b, r, layer, c).mean / static_cast<double>(regions);
        for (std::size_t r = 0; r < regions; ++r) {
            const Replicated x = spread(a, r, layer, c), y = spread(b, r, layer, c);
            const double scale = std::max(y.mean, level);
            const double z = zScore(x, y, (allowed + 2e-6) * scale);
            strict = std::max(strict, zScore(x, y, 2e-6 * scale));
            if (z <= worst) continue;
            worst = z;
            where =
                fmt::format("region {} of {}, channel {}: {:.6f} +- {:.6f}, not {:.6f} +- {:.6f}",
                            r, regions, c, x.mean, x.standardError, y.mean, y.standardError);
        }
    }
    EXPECT_LT(worst, limit) << what << ", " << kLayerNames[layer] << ", " << where;
    fmt::print("    {}, {}: largest |z| of {} regions {:.2f}; beyond {:g} %: {:.2f}\n", what,
               kLayerNames[layer], regions, strict, 100 * allowed, worst);
    return worst;
}

PlannedRender::PlannedRender(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                             const Plan& plan)
    : m_scene(std::move(scene)),
      m_settings(settings),
      m_plan(plan),
      m_camera(*m_scene, settings.width, settings.height),
      m_lights(*m_scene),
      m_photons(*m_scene, m_camera, m_lights, m_plan, m_settings) {}

void PlannedRender::begin(std::uint32_t pass) {
    m_pass = pass;
    m_photons.begin(pass, kNotCancelled, {});
}

SampleRadiance PlannedRender::sample(std::int32_t x, std::int32_t y, std::uint32_t index,
                                     const PhotonMaps& maps, NearestPhotons& scratch) const {
    const std::uint64_t pixel = static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 |
                                static_cast<std::uint32_t>(x);
    const Sampler sampler(m_settings.seed, 2 * std::uint64_t{m_pass % 2}, pixel, index);
    const Vec2f jitter = sampler.get2D(Purpose::kPlace);
    const double onX = x + static_cast<double>(jitter.x), onY = y + static_cast<double>(jitter.y);
    return PhotonIntegrator(*m_scene, m_lights, maps)
        .sample({{static_cast<float>(onX), static_cast<float>(onY)}, m_camera.ray({onX, onY})},
                sampler, scratch);
}

RegionMeans PlannedRender::means(const std::vector<Rect>& regions, std::uint32_t samples,
                                 const PhotonMaps& maps) const {
    RegionMeans means(regions.size());
    tbb::parallel_for(std::size_t{0}, regions.size(), [&](std::size_t r) {
        NearestPhotons scratch;
        const Rect& region = regions[r];
        const double share = 1.0 / (static_cast<double>(region.area()) * samples);
        for (std::int32_t y = region.y0; y < region.y1; ++y)
            for (std::int32_t x = region.x0; x < region.x1; ++x)
                for (std::uint32_t i = 0; i < samples; ++i) {
                    const SampleRadiance s = sample(x, y, m_pass / 2 * samples + i, maps, scratch);
                    const Rgb beauty = s.emission + s.direct + s.caustic + s.indirect;
                    LayerMeans& mean = means[r];
                    add(mean, kBeauty, beauty, share);
                    add(mean, kEmission, s.emission, share);
                    add(mean, kDirect, s.direct, share);
                    add(mean, kCaustic, s.caustic, share);
                    add(mean, kIndirect, s.indirect, share);
                    add(mean, kCorrected, beauty, share);
                    add(mean, kCorrected, s.biasProbe, 2 * share);
                }
    });
    return means;
}

RegionMeans PlannedRender::render(const std::vector<Rect>& regions, std::uint32_t samples) {
    RegionMeans mean(regions.size());
    for (std::uint32_t pass = 0; pass < m_settings.passes; ++pass) {
        begin(pass);
        addTo(mean, means(regions, samples, m_photons.maps()), 1.0 / m_settings.passes);
    }
    return mean;
}

}  // namespace pm::test
