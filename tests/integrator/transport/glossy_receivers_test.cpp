// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Caustics on glossy surfaces of every roughness, by photons as by paths.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "integrator/transport/plan/plan.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

MaterialDescription metal(float roughness, Rgb colour = Rgb(0.8f)) {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = colour;
    m.roughness = roughness;
    return m;
}

MaterialDescription glass(float roughness = 0.0f) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.roughness = roughness;
    return m;
}

// A ball over a floor, lamp above.
std::shared_ptr<const Scene> ballOver(const MaterialDescription& floor,
                                      const MaterialDescription& ball) {
    SceneMaker maker;
    maker.quad({-1.2, 0, 1.2}, {2.4, 0, 0}, {0, 0, -2.4}, maker.material(floor));
    maker.sphere({-0.2, 0.55, 0}, 0.4, maker.material(ball));
    if (std::getenv("PM_POINT"))
        maker.pointLight({-0.5, 2.2, 0}, Rgb(4.0f));
    else if (std::getenv("PM_SPH"))
        maker.sphere({-0.5, 2.2, 0}, 0.1, maker.diffuse({}, Rgb(4.0f / (3.14159265f * 0.01f))));
    else maker.quad({-0.8, 2.2, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, maker.diffuse({}, Rgb(12.0f)));
    maker.camera({0.6, 2.0, 3.0}, {0, 0.2, 0}, {0, 1, 0}, 40);
    return maker.build();
}

struct Against {
    double photon = 0, path = 0, z = 0, relMse = 0, noise = 0;
};

Against compare(const std::shared_ptr<const Scene>& scene, std::uint32_t pathPasses,
                std::uint32_t photonPasses) {
    constexpr int kWidth = 24, kHeight = 16;
    std::vector<Rect> regions;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) regions.push_back({x, y, x + 1, y + 1});
    regions.push_back({0, 0, kWidth, kHeight});
    RenderSettings settings =
        smallFrame(kWidth, kHeight, IntegratorKind::kPhoton, photonPasses, 3);
    settings.photons = std::getenv("PM_PH") ? std::atoi(std::getenv("PM_PH")) : 40'000;
    const auto photon = measureRegions(scene, settings, {0, 0, kWidth, kHeight}, regions);
    const auto path =
        measureRegions(scene, smallFrame(kWidth, kHeight, IntegratorKind::kPath, pathPasses, 5),
                       {0, 0, kWidth, kHeight}, regions);
    if (std::getenv("PM_LAYERS")) for (const auto* m : {&photon.back(), &path.back()}) fmt::print("direct {:.5f}+-{:.5f} caustic {:.5f}+-{:.5f} indirect {:.5f}+-{:.5f} emission {:.5f}\n", m->direct.mean[1], m->direct.standardError[1], m->caustic.mean[1], m->caustic.standardError[1], m->indirect.mean[1], m->indirect.standardError[1], m->emission.mean[1]);
    Against found;
    const Measured &a = photon.back().beauty, &b = path.back().beauty;
    found.photon = a.mean[1];
    found.path = b.mean[1];
    found.z = (a.mean[1] - b.mean[1]) / std::hypot(a.standardError[1], b.standardError[1]);
    for (std::size_t i = 0; i + 1 < regions.size(); ++i) {
        const Measured &x = photon[i].beauty, &r = path[i].beauty;
        if (std::getenv("PM_MAP")) fmt::print("{:.4f}/{:.4f}{}", x.mean[1], r.mean[1], i % 24 == 23 ? "\n" : " ");
        const double off = x.mean[1] - r.mean[1], own = r.standardError[1];
        found.relMse += (off * off - own * own) / (r.mean[1] * r.mean[1] + 0.01);
        found.noise += own * own / (r.mean[1] * r.mean[1] + 0.01);
    }
    found.relMse /= static_cast<double>(regions.size() - 1);
    found.noise /= static_cast<double>(regions.size() - 1);
    return found;
}

TEST(GlossyReceivers, Sweep) {
    const int step = std::getenv("PM_STEP") ? std::atoi(std::getenv("PM_STEP")) : 1;
    const int path = std::getenv("PM_PATHS") ? std::atoi(std::getenv("PM_PATHS")) : 16;
    const bool plain = std::getenv("PM_BALL") != nullptr;
    for (int i = std::getenv("PM_FROM") ? std::atoi(std::getenv("PM_FROM")) : 20; i >= 0; i -= step) {
        const float r = static_cast<float>(i) / 20;
        MaterialDescription lam; lam.diffuse = Rgb(0.8f);
        const auto scene = std::getenv("PM_LAM") ? ballOver(lam, glass()) : plain ? ballOver(metal(0.5f), metal(r)) : ballOver(metal(r), glass());
        const Against a = compare(scene, static_cast<std::uint32_t>(path), std::getenv("PM_PASSES") ? std::atoi(std::getenv("PM_PASSES")) : 8);
        fmt::print("{:.2f}: photon {:.4f} path {:.4f} ratio {:.3f} z {:.2f} relMSE {:.5f} ref {:.5f}\n",
                   static_cast<double>(r), a.photon, a.path, a.photon / a.path, a.z, a.relMse,
                   a.noise);
    }
}

}  // namespace
}  // namespace pm::test
