// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/stability/sweep_look.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "tests/bench/stability/sweep.h"

namespace pm::bench {

namespace {

// Adds one pass's frame to the means, as the share that it is of all.
void addPass(const FrameRenderer& renderer, const Look& how, Seen& seen) {
    const ChannelLayout layout = renderer.layout();
    const auto channels = static_cast<std::size_t>(layout.count);
    const std::size_t pixels = seen.pixels.size();
    std::vector<float> values(pixels * channels), weights(pixels);
    renderer.renderRegion({0, 0, how.size, how.size}, values, weights, std::atomic<bool>{false});
    const double share = 1.0 / how.passes;
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto green = [&](std::int32_t offset) {
            return share *
                   static_cast<double>(values[i * channels + static_cast<std::size_t>(offset) + 1]);
        };
        const auto count = static_cast<double>(pixels);
        seen.pixels[i] += green(layout.beauty);
        seen.beauty += green(layout.beauty) / count;
        seen.direct += green(layout.direct) / count;
        seen.indirect += green(layout.indirect) / count;
        seen.caustic += green(layout.caustic) / count;
        seen.emission += green(layout.emission) / count;
    }
}

}  // namespace

double Seen::countOff(double expected) const {
    const double allowed = kSweepRounding * std::max(expected, 1e-30);
    const auto off = std::ranges::count_if(
        pixels, [&](double pixel) { return !(std::abs(pixel - expected) <= allowed); });
    return static_cast<double>(off) + static_cast<double>(counters.badSamples.total());
}

Seen look(const test::SceneMaker& maker, const Look& how) {
    RenderSettings settings = test::smallFrame(how.size, how.size, how.integrator, how.passes, 3);
    settings.seed = how.seed;
    settings.photons = how.photons;
    settings.estimatePhotons = how.estimatePhotons;
    FrameRenderer renderer(maker.build(), settings);
    Seen seen;
    seen.pixels.resize(static_cast<std::size_t>(how.size) * static_cast<std::size_t>(how.size));
    for (std::uint32_t pass = 0; pass < how.passes; ++pass) {
        renderer.beginPass(pass, std::atomic<bool>{false}, {});
        addPass(renderer, how, seen);
    }
    seen.counters = renderer.counters();
    return seen;
}

std::string nameOf(IntegratorKind integrator) {
    return integrator == IntegratorKind::kPhoton ? "photon" : "path";
}

test::SceneMaker placed(test::SceneMaker maker, double scale, const Vec3d& offset) {
    const auto place = [&](const Vec3d& p) { return p * scale + offset; };
    SceneDescription& scene = maker.description;
    for (InstanceDescription& instance : scene.instances) {
        Transform& t = instance.transform;
        for (double& element : t) element *= scale;
        t[3] += offset.x;
        t[7] += offset.y;
        t[11] += offset.z;
    }
    for (LightDescription& any : scene.lights) {
        auto* const light = std::get_if<PointLightDescription>(&any);
        if (!light) continue;
        light->position = place(light->position);
        light->intensity = light->intensity * static_cast<float>(scale * scale);
    }
    if (!scene.camera) return maker;
    Transform& camera = scene.camera->cameraToWorld;
    const Vec3d eye = place({camera[3], camera[7], camera[11]});
    camera[3] = eye.x;
    camera[7] = eye.y;
    camera[11] = eye.z;
    return maker;
}

double polygonIrradiance(const std::vector<Vec3d>& corners, const Vec3d& normal) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& a = corners[i];
        const Vec3d& b = corners[(i + 1) % corners.size()];
        const Vec3d across = cross(a, b);
        const double sine = length(across);
        if (sine > 0) sum += std::atan2(sine, dot(a, b)) * dot(across, normal) / sine;
    }
    return std::abs(sum) / 2;
}

double fresnel(double index, double cosine) {
    const double inside = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (index * index)));
    const double p = (index * cosine - inside) / (index * cosine + inside);
    const double s = (cosine - index * inside) / (cosine + index * inside);
    return (p * p + s * s) / 2;
}

}  // namespace pm::bench
