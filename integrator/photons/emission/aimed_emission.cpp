// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/aimed_emission.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "integrator/photons/emission/aim_caps.h"
#include "integrator/photons/emission/aim_shadows.h"
#include "integrator/photons/emission/caustic_casters.h"
#include "integrator/photons/emission/focus_balls.h"
#include "integrator/photons/emission/place_groups.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

constexpr std::size_t kGroups = 64;
// Points of emission from which casters are judged, over all lights by power.
constexpr std::uint32_t kViewpoints = 32;
// Distance over the scene's radius from which lights that are infinitely far judge them.
constexpr double kFarView = 8.0;
// A caster's worth is the root of the share of flux that lands, within these bounds: at least a
// twentieth, for what the pilot has missed by chance.
constexpr double kLeastWorth = 0.05, kMostWorth = 2.0;
// Photons that an expectation counts for beside what a pilot has measured.
constexpr double kPriorPhotons = 8.0;

// Of photons that are aimed at a focus, the share for the innermost ball, and what is unaimed:
// light may come by way of anything.
constexpr double kInnermostShare = 0.5;
constexpr float kUnaimedShareOfFocus = 0.25f;

constexpr const char* kAiming = "aiming photons";

// Flux, and in how many photons, of a pilot.
struct Landing {
    double emitted = 0, landed = 0, photons = 0;

    void add(const EmissionRecord& record) {
        emitted += static_cast<double>(record.emitted);
        landed += static_cast<double>(record.landed);
        photons += 1;
    }
    // Share that lands, where `prior` is expected and counts as so many photons.
    double share(double prior) const {
        if (!(emitted > 0)) return prior;
        const double expected = kPriorPhotons * emitted / photons;
        return (landed + prior * expected) / (emitted + expected);
    }
};

// To make photons that land alike in flux, a strategy needs them as its flux F; to make the sum of
// the variances F^2/(n share) least for n photons, as F over the root of the share that lands. F
// being the flux sent out times that share, what is left is its root.
double worthOfShare(double share) {
    return std::clamp(std::sqrt(share), kLeastWorth, kMostWorth);
}

}  // namespace

AimedEmission::AimedEmission(const Scene& scene, const LightSampler& lights, const Focus& seen,
                             const CancelCheck& cancel)
    : m_scene(scene), m_lights(lights) {
    const auto& all = scene.lights();
    if (lights.empty()) return;
    std::vector<double> powers;
    powers.reserve(all.size());
    for (const Light& light : all) powers.push_back(light.powerMean);
    const LightChoice byPower(powers);
    std::vector<EmissionPoint> viewpoints;
    for (std::uint32_t i = 0; i < kViewpoints; ++i) {
        float probability;
        const float u = (static_cast<float>(i) + 0.5f) / kViewpoints;
        viewpoints.push_back(viewpoint(byPower.choose(u, probability), spreadPoint(i)));
    }
    m_casters = findCasters(scene, viewpoints, cancel);
    if (m_casters.empty()) return;
    addBalls(seen, viewpoints);
    groupLights(cancel);
    m_guess.resize(all.size());
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
        cancel.throwIfSet(kAiming);
        m_guess[i] = fluxTowards(m_casters, static_cast<std::uint32_t>(i));
    });
    m_choice = LightChoice(m_guess);
}

AimedEmission AimedEmission::atFocus(const Scene& scene, const LightSampler& lights,
                                     const Focus& focus, const CancelCheck& cancel) {
    AimedEmission aimed(scene, lights, Unaimed{});
    aimed.m_focus = focus;
    aimed.m_unaimedShare = aimed.m_unaimedShareOfNear = kUnaimedShareOfFocus;
    if (!lights.empty() && !focus.isEverywhere()) aimed.aimAtFocus(cancel);
    return aimed;
}

AimedEmission AimedEmission::atOpenings(const Scene& scene, const LightSampler& lights,
                                        std::vector<Caster> balls, std::span<const float> seenShare,
                                        const CancelCheck& cancel) {
    AimedEmission aimed(scene, lights, Unaimed{});
    aimed.m_unaimedShare = kUnaimedShareOfFocus;
    aimed.m_unaimedShareOfNear = 1.0f;
    aimed.m_casters = std::move(balls);
    aimed.m_prior.assign(aimed.m_casters.size(), 1.0);
    aimed.groupLights(cancel);
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
        const Light& light = scene.lights()[i];
        aimed.m_guess.push_back(light.isFar() ? aimed.fluxTowards(aimed.m_casters, i)
                                              : light.powerMean);
    }
    aimed.m_choice = LightChoice(aimed.m_guess);
    const float most = *std::ranges::max_element(seenShare);
    std::vector<float> worth;
    worth.reserve(seenShare.size());
    for (const float share : seenShare)
        worth.push_back(static_cast<float>(
            worthOfShare(static_cast<double>(share) / static_cast<double>(most))));
    aimed.m_sky.setWorth(std::move(worth));
    return aimed;
}

void AimedEmission::aimAtFocus(const CancelCheck& cancel) {
    m_casters = ballsAround(m_focus, m_scene.radius());
    const std::size_t count = m_scene.lights().size(), balls = m_casters.size();
    m_group.assign(count, 0);
    m_guess.assign(count, 0.0);
    std::vector<double> flux(count);
    for (std::size_t ball = 0; ball < balls; ++ball) {
        const double share = balls == 1  ? 1.0
                             : ball == 0 ? kInnermostShare
                                         : (1 - kInnermostShare) / static_cast<double>(balls - 1);
        // A photon is aimed at a ball as often as its solid angle or shadow says times its worth:
        // so at each as often as its share says, from wherever all look small.
        const double ratio = m_casters[0].radius / m_casters[ball].radius;
        m_worth.push_back(static_cast<float>(share * ratio * ratio));
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            cancel.throwIfSet(kAiming);
            flux[i] = fluxTowards({&m_casters[ball], 1}, static_cast<std::uint32_t>(i));
        });
        double all = 0;
        for (const double one : flux) all += one;
        for (std::size_t i = 0; all > 0 && i < count; ++i) m_guess[i] += share * flux[i] / all;
    }
    m_choice = LightChoice(m_guess);
}

// From where most light comes the balls together fill as much as what casts.
void AimedEmission::addBalls(const Focus& seen, std::span<const EmissionPoint> viewpoints) {
    m_prior.assign(m_casters.size(), 1.0);
    const std::vector<Caster> balls = ballsInside(m_casters, seen);
    if (balls.empty()) return;
    double whole = 0;
    for (const Caster& caster : m_casters) whole += solidAngleFrom(viewpoints, caster);
    for (const Caster& ball : balls) {
        const double solidAngle = solidAngleFrom(viewpoints, ball);
        if (!(solidAngle > 0)) continue;
        m_casters.push_back(ball);
        m_prior.push_back(whole / (solidAngle * static_cast<double>(balls.size())));
    }
}

EmissionPoint AimedEmission::pointLightView(const Light& light) const {
    EmissionPoint point;
    point.position = light.position();
    const DirectionCone cone = m_lights.emissionCone(light);
    point.axis = cone.axis;
    point.oneMinusCos = cone.oneMinusCos;
    if (!light.isEven()) point.uneven = &light;
    return point;
}

EmissionPoint AimedEmission::farView(const Light& light, Vec2f uDirection) const {
    EmissionPoint point;
    ParallelLight parallel;
    if (light.emitParallel(uDirection, parallel))
        point.position = Vec3d(parallel.direction) * (-kFarView * m_scene.radius());
    return point;
}

EmissionPoint AimedEmission::viewpoint(std::uint32_t index, Vec2f uPoint) const {
    const Light& light = m_scene.lights()[index];
    if (light.isAtPoint()) return pointLightView(light);
    if (light.isFar()) return farView(light, uPoint);
    float density;
    const Surface surface = m_scene.pointOnLight(*light.surface(), uPoint, density);
    EmissionPoint point;
    point.position = Vec3d(surface.position);
    point.axis = surface.geometricNormal;
    point.onSurface = true;
    return point;
}

double AimedEmission::shareTowards(std::span<const Caster> casters,
                                   const EmissionPoint& point) const {
    double sum = 0;
    AimCone cone;
    for (const Caster& caster : casters)
        if (cone.aim(caster, point)) sum += static_cast<double>(cone.solidAngle);
    const double whole = point.onSurface ? static_cast<double>(kPi)
                         : point.uneven  ? static_cast<double>(point.uneven->falloffIntegral())
                                         : 4.0 * kPi;
    return std::min(1.0, sum / whole);
}

double AimedEmission::shareInShadows(std::span<const Caster> casters, const Light& light,
                                     Vec2f uDirection) const {
    ParallelLight parallel;
    if (!light.emitParallel(uDirection, parallel)) return 0;
    const Vec3d direction = normalize(Vec3d(parallel.direction));
    double sum = 0;
    for (const Caster& caster : casters) sum += AimShadows::areaOf(caster, direction);
    return std::min(1.0, sum / crossSection(m_scene.halfSize(), direction));
}

double AimedEmission::fluxTowards(std::span<const Caster> casters, std::uint32_t index) const {
    const Light& light = m_scene.lights()[index];
    const std::uint32_t points = light.isAtPoint() ? 1 : m_scene.lights().size() <= 1024 ? 16 : 4;
    double share = 0;
    for (std::uint32_t i = 0; i < points; ++i)
        share += light.isFar() ? shareInShadows(casters, light, spreadPoint(i))
                               : shareTowards(casters, viewpoint(index, spreadPoint(i)));
    return share / points * light.powerMean;
}

void AimedEmission::groupLights(const CancelCheck& cancel) {
    std::vector<Vec3d> places(m_scene.lights().size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
        cancel.throwIfSet(kAiming);
        places[i] = viewpoint(static_cast<std::uint32_t>(i), {0.5f, 0.5f}).position;
    });
    m_group = groupByPlace(places, kGroups, cancel);
    for (std::size_t group = 0; group < kGroups; ++group)
        for (const double prior : m_prior) m_worth.push_back(static_cast<float>(prior));
}

void AimedEmission::refine(std::span<const EmissionRecord> pilot) {
    if (empty()) return;
    std::vector<Landing> casters(m_worth.size()), lights(m_group.size()), groups(kGroups);
    Landing total;
    for (const EmissionRecord& record : pilot) {
        if (record.caster == kNoCaster) continue;
        casters[m_group[record.light] * m_casters.size() + record.caster].add(record);
        lights[record.light].add(record);
        groups[m_group[record.light]].add(record);
        total.add(record);
    }
    // Where nothing landed at all there is nothing to learn from.
    if (!(total.landed > 0)) return;
    refineSky(pilot);
    const double overall = total.landed / total.emitted;
    for (std::size_t i = 0; i < m_worth.size(); ++i)
        m_worth[i] = static_cast<float>(m_prior[i % m_casters.size()] *
                                        worthOfShare(casters[i].share(overall)));
    std::vector<double> weights(m_guess);
    for (std::size_t i = 0; i < weights.size(); ++i)
        weights[i] *= worthOfShare(lights[i].share(groups[m_group[i]].share(overall)));
    m_choice = LightChoice(weights);
}

void AimedEmission::refineSky(std::span<const EmissionRecord> pilot) {
    std::vector<Landing> parts(SkyParts::kCount);
    Landing sky;
    for (const EmissionRecord& record : pilot) {
        if (record.caster == kNoCaster || !m_scene.lights()[record.light].environment()) continue;
        parts[record.part].add(record);
        sky.add(record);
    }
    if (!(sky.landed > 0)) return;
    std::vector<float> worth;
    worth.reserve(parts.size());
    for (const Landing& part : parts)
        worth.push_back(static_cast<float>(worthOfShare(part.share(sky.share(0)))));
    m_sky.setWorth(std::move(worth));
}

// Half of the points by where its texture shines, half by where the casters are.
Surface AimedEmission::placeOnTexturedSphere(std::uint32_t index, const SphereShape& sphere,
                                             float& uCaster, Vec2f uPoint, float& pdfArea) const {
    const SurfaceLight& light = *m_scene.lights()[index].surface();
    const AimCaps caps(sphere, m_casters, worthOf(index));
    const bool byTexture = uCaster < 0.5f;
    uCaster = byTexture ? 2.0f * uCaster : 2.0f * uCaster - 1.0f;
    float ofTexture, ofCaps;
    Surface surface;
    if (byTexture) {
        surface = m_scene.pointOnLight(light, uPoint, ofTexture);
        ofCaps = caps.pdfSolidAngle(surface.geometricNormal);
    } else {
        const Vec3f normal = caps.sample(uCaster, uPoint, ofCaps);
        surface = m_scene.pointOnSphere(light.shape, Vec3d(normal));
        ofTexture = m_scene.lampDensity(light, surface);
    }
    pdfArea = 0.5f *
              (ofTexture / light.area + ofCaps / static_cast<float>(sphere.radius * sphere.radius));
    return surface;
}

void AimedEmission::place(std::uint32_t index, float& uCaster, Vec2f uPoint, Origin& origin) const {
    const Light& light = m_scene.lights()[index];
    if (light.isAtPoint()) {
        origin.point = pointLightView(light);
        origin.strength = light.intensity();
        origin.rayStart = Vec3f(light.position());
        return;
    }
    Surface surface;
    const SurfaceLight& shining = *light.surface();
    const std::optional<SphereShape> sphere = light.wholeSphere(m_scene);
    float density, pdfArea = 1.0f / shining.area;
    if (sphere && !shining.shinesEvenly()) {
        surface = placeOnTexturedSphere(index, *sphere, uCaster, uPoint, pdfArea);
    } else if (sphere) {
        const AimCaps caps(*sphere, m_casters, worthOf(index));
        const Vec3f normal = caps.sample(uCaster, uPoint, pdfArea);
        pdfArea /= static_cast<float>(sphere->radius * sphere->radius);
        surface = m_scene.pointOnSphere(shining.shape, Vec3d(normal));
    } else {
        surface = m_scene.pointOnLight(shining, uPoint, density);
        pdfArea *= density;
    }
    origin.point.position = Vec3d(surface.position);
    origin.point.axis = surface.geometricNormal;
    origin.point.onSurface = true;
    origin.strength = m_lights.frontRadiance(surface) * (1.0f / pdfArea);
    origin.rayStart = rayOrigin(surface, surface.geometricNormal);
}

bool AimedEmission::emit(Vec2f uChoice, Vec2f uPoint, Vec2f uDirection, AimedPhoton& photon) const {
    if (empty()) return false;
    float probability;
    photon.light = m_choice.choose(uChoice.x, probability);
    const Light& light = m_scene.lights()[photon.light];
    photon.isMet = light.isMet();
    if (light.isFar())
        return emitParallel(light, probability, uChoice.y, uPoint, uDirection, photon);
    Origin origin;
    place(photon.light, uChoice.y, uPoint, origin);
    const AimMixture mixture(m_casters, worthOf(photon.light), origin.point, m_unaimedShareOfNear);
    AimMixture::Sample sample;
    if (!mixture.sample(uChoice.y, uDirection, sample)) return false;
    const float cosine = origin.point.onSurface ? dot(sample.direction, origin.point.axis) : 1.0f;
    if (!(cosine > 0.0f)) return false;
    photon.caster = sample.caster;
    photon.ray = {origin.rayStart, sample.direction};
    photon.flux = origin.strength * (cosine / (probability * sample.pdfSolidAngle));
    if (origin.point.uneven) photon.flux *= origin.point.uneven->falloff(sample.direction);
    return !isBlack(photon.flux);
}

bool AimedEmission::scatter(const Vec3f& position, const Vec3f& normal, float uChoice, Vec2f u,
                            Vec3f& direction, float& pdfSolidAngle) const {
    EmissionPoint point;
    point.position = Vec3d(position);
    point.axis = normal;
    point.onSurface = true;
    AimMixture::Sample sample;
    if (!AimMixture(m_casters, m_worth, point, m_unaimedShare).sample(uChoice, u, sample))
        return false;
    direction = sample.direction;
    pdfSolidAngle = sample.pdfSolidAngle;
    return true;
}

bool AimedEmission::emitParallel(const Light& light, float probability, float uCaster, Vec2f uPoint,
                                 Vec2f uDirection, AimedPhoton& photon) const {
    ParallelLight parallel;
    float factor = 1.0f;
    const bool isSky = light.environment() != nullptr;
    if (isSky && !m_sky.empty()) factor = m_sky.choose(m_scene.environment(), uCaster, uDirection);
    if (!light.emitParallel(uDirection, parallel)) return false;
    if (isSky) photon.part = SkyParts::partOf(-parallel.direction);
    const AimShadows shadows(m_casters, worthOf(photon.light), parallel.direction,
                             m_scene.halfSize(), m_unaimedShare);
    AimShadows::Sample sample;
    if (!shadows.sample(uCaster, uPoint, sample)) return false;
    photon.caster = sample.caster;
    photon.ray = m_lights.parallelRay(sample.point, parallel.direction);
    photon.flux = parallel.irradiance *
                  static_cast<float>(static_cast<double>(factor) /
                                     (static_cast<double>(probability) * sample.pdfArea));
    return !isBlack(photon.flux);
}

std::uint64_t AimedEmission::memoryBytes() const {
    return m_casters.size() * sizeof(Caster) + m_prior.size() * sizeof(double) +
           m_worth.size() * sizeof(float) +
           m_group.size() * (sizeof(std::uint8_t) + sizeof(double) + 2 * sizeof(float)) +
           (m_sky.empty() ? 0 : SkyParts::kCount * sizeof(float));
}

}  // namespace pm
