// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/integrator/brute/brute_force.h"

#include <cmath>
#include <memory>
#include <random>

#include "integrator/materials/bsdf.h"
#include "integrator/scene/camera.h"

namespace pm::test {

namespace {

// Along no axis and through no corner that scenes of tests have.
const Vec3d kAway = normalize(Vec3d{0.3721, 0.5812, 0.7239});

// How often a line from `from` along kAway meets a triangle: 0 or 1.
int meets(const Vec3d& from, const std::array<Vec3d, 3>& t) {
    const Vec3d e1 = t[1] - t[0], e2 = t[2] - t[0], p = cross(kAway, e2);
    const double determinant = dot(e1, p);
    if (determinant == 0) return 0;
    const Vec3d s = from - t[0], q = cross(s, e1);
    const double u = dot(s, p) / determinant, v = dot(kAway, q) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 && dot(e2, q) / determinant > 0 ? 1 : 0;
}

std::array<double, 3> times(const std::array<double, 3>& a, const Rgb& b) {
    return {a[0] * static_cast<double>(b.r), a[1] * static_cast<double>(b.g),
            a[2] * static_cast<double>(b.b)};
}

}  // namespace

bool BruteForce::Body::holds(const Vec3d& place) const {
    for (const auto& [centre, radius] : balls)
        if (length(place - centre) < radius) return true;
    int crossed = 0;
    for (const auto& face : faces) crossed += meets(place, face);
    return crossed % 2 == 1;
}

BruteForce::BruteForce(const Scene& scene, std::int32_t width, std::int32_t height)
    : m_scene(scene), m_width(width), m_height(height) {
    for (std::uint32_t m = 0; m < scene.description().materials.size(); ++m) {
        const MaterialDescription& material = scene.material(m);
        if (material.kind != MaterialKind::kDielectric || material.thinWalled) continue;
        Body body{m, {}, {}};
        Vec3d lo(1e300), hi(-1e300);
        const auto grow = [&](const Vec3d& p) {
            for (int axis = 0; axis < 3; ++axis) {
                lo[axis] = std::min(lo[axis], p[axis]);
                hi[axis] = std::max(hi[axis], p[axis]);
            }
        };
        for (const InstanceDescription& instance : scene.description().instances) {
            const auto toScene = [&](const Vec3d& p) {
                return transformPoint(instance.transform, p) - scene.centre();
            };
            if (const auto* ball = std::get_if<SphereShape>(&instance.shape)) {
                if (instance.materials[0] != m) continue;
                const Vec3d centre = toScene(Vec3d(ball->centre));
                body.balls.emplace_back(centre, ball->radius);
                grow(centre - Vec3d(ball->radius));
                grow(centre + Vec3d(ball->radius));
            }
            const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape);
            if (!mesh) continue;
            for (std::size_t i = 0; i < (*mesh)->triangles.size(); ++i) {
                const auto slot = (*mesh)->materials.empty() ? 0u : (*mesh)->materials[i];
                if (instance.materials[slot] != m) continue;
                std::array<Vec3d, 3>& face = body.faces.emplace_back();
                for (std::size_t k = 0; k < 3; ++k) {
                    face[k] = toScene(Vec3d((*mesh)->positions[(*mesh)->triangles[i][k]]));
                    grow(face[k]);
                }
            }
        }
        const Vec3d size = hi - lo;
        body.volume = size.x * size.y * size.z;
        m_bodies.push_back(std::move(body));
    }
}

std::int32_t BruteForce::mediumAt(const Vec3d& place) const {
    const Body* best = nullptr;
    for (const Body& body : m_bodies) {
        if (!body.holds(place)) continue;
        const auto priority = [&](const Body& b) { return m_scene.material(b.material).priority; };
        if (!best || priority(body) > priority(*best) ||
            (priority(body) == priority(*best) && body.volume < best->volume))
            best = &body;
    }
    return best ? static_cast<std::int32_t>(best->material) : -1;
}

// One path from the camera, to its end.
class BruteForce::Path {
  public:
    Path(const BruteForce& owner, std::mt19937_64& random)
        : m_owner(owner), m_scene(owner.m_scene), m_random(random) {}

    std::array<double, 3> follow(Ray ray) {
        constexpr int kMost = 4000, kBeforeRoulette = 6;
        // Where things are hidden from shadow rays, lamps are looked for on a way of their own.
        bool findsLamps = true;
        for (int i = 0; i < kMost; ++i) {
            Surface surface;
            if (!m_scene.intersect(ray, surface)) {
                if (findsLamps) addFar(ray, m_left);
                return m_found;
            }
            absorb(ray, surface, m_left);
            if (findsLamps) addLamp(ray, surface, m_left);
            const Rgb carried{static_cast<float>(m_left[0]), static_cast<float>(m_left[1]),
                              static_cast<float>(m_left[2])};
            const Bsdf bsdf(m_scene.materials(), surface, -ray.direction, Transport::kRadiance,
                            carried);
            BsdfSample sample;
            const float uLobe = next();
            if (bsdf.isBlackBody() || !bsdf.sample(uLobe, {next(), next()}, sample)) return m_found;
            m_left = times(m_left, sample.weight);
            m_scale *= static_cast<double>(sample.etaSquared);
            const double amount = std::max({m_left[0], m_left[1], m_left[2]}) * m_scale;
            if (!(amount > 0)) return m_found;
            if (i >= kBeforeRoulette && amount < 1) {
                if (static_cast<double>(next()) >= amount) return m_found;
                for (double& left : m_left) left /= amount;
            }
            const Viewers viewer = ray.viewer;
            ray = rayFrom(surface, sample.direction);
            if (sample.lobe == Lobe::kStraight) {
                ray.viewer = viewer;
                continue;
            }
            findsLamps = !m_scene.viewersDiffer() || isDelta(sample.lobe);
            if (!findsLamps) lookForLamps(ray);
        }
        return m_found;
    }

  private:
    float next() { return static_cast<float>(m_random() >> 40) * 0x1p-24f; }

    void add(const Rgb& radiance, const std::array<double, 3>& left) {
        const std::array<double, 3> more = times(left, radiance);
        for (std::size_t c = 0; c < 3; ++c) m_found[c] += more[c];
    }
    void addFar(const Ray& ray, const std::array<double, 3>& left) {
        for (const Light& light : m_scene.farLights()) add(light.farRadiance(ray.direction), left);
    }
    void addLamp(const Ray& ray, const Surface& surface, const std::array<double, 3>& left) {
        if (surface.light != kNoLight && dot(ray.direction, surface.geometricNormal) < 0.0f)
            add(m_scene.emission(surface.material, surface.uv), left);
    }
    void absorb(const Ray& ray, const Surface& surface, std::array<double, 3>& left) const {
        const Vec3d from(ray.origin), to(surface.position);
        const std::int32_t medium = m_owner.mediumAt((from + to) * 0.5);
        if (medium < 0) return;
        const MaterialDescription& m = m_scene.material(static_cast<std::uint32_t>(medium));
        if (!(m.attenuationDistance > 0.0f)) return;
        const double way = length(to - from) / static_cast<double>(m.attenuationDistance);
        const Rgb& c = m.attenuationColour;
        const std::array<float, 3> colour{c.r, c.g, c.b};
        for (std::size_t i = 0; i < 3; ++i)
            left[i] *= std::exp(std::log(static_cast<double>(colour[i])) * way);
    }
    // Straight on, past what shadow rays pass.
    void lookForLamps(Ray ray) {
        std::array<double, 3> left = m_left;
        for (int i = 0; i < 64; ++i) {
            ray.viewer = kLightRays;
            Surface surface;
            if (!m_scene.intersect(ray, surface)) return addFar(ray, left);
            absorb(ray, surface, left);
            addLamp(ray, surface, left);
            if (!m_scene.isHiddenFrom(surface.shape, kShadowRays)) {
                const Bsdf bsdf(m_scene.materials(), surface, -ray.direction, Transport::kRadiance,
                                Rgb(1.0f));
                if (!bsdf.has(Lobe::kStraight)) return;
                left = times(left, bsdf.reflectance(Lobe::kStraight));
            }
            ray = rayFrom(surface, ray.direction);
        }
    }

    const BruteForce& m_owner;
    const Scene& m_scene;
    std::mt19937_64& m_random;
    std::array<double, 3> m_left{1, 1, 1}, m_found{};
    double m_scale = 1;
};

std::array<double, 3> BruteForce::mean(const Rect& area, std::uint32_t samples,
                                       std::uint64_t seed) const {
    const Camera camera(m_scene, m_width, m_height);
    std::mt19937_64 random(seed);
    std::array<double, 3> sum{};
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (std::uint32_t i = 0; i < samples; ++i) {
        const double x = area.x0 + uniform() * area.width(),
                     y = area.y0 + uniform() * area.height();
        const std::array<double, 3> found = Path(*this, random).follow(camera.ray({x, y}));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += found[c];
    }
    for (double& s : sum) s /= samples;
    return sum;
}

}  // namespace pm::test
