// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/seen_lights/seen_lamps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "integrator/transport/path/camera_step.h"

namespace pm {

namespace {

// Paths of each camera sample where the pilot saw a lamp, or more of it here than there: what is
// this even the camera sample's own path finds. See docs/decisions.md.
constexpr float kEven = 0.5f;
constexpr std::uint32_t kPathsAtLamps = 8;
// Where paths divide often, as many as have so many rays together, but two.
constexpr std::size_t kRaysAtLamps = 16;
// Pilot paths along each side of a square, which reach so many pixels beyond it.
constexpr std::int32_t kPilots = 8;
constexpr float kBeyond = 1.0f;
// How far a filter reaches beyond a pixel, at most.
constexpr double kFilterReach = 1.0;
// Paths of each camera sample towards each small image of a lamp that its pixel may show.
constexpr std::uint32_t kPathsOfImage = 16;
constexpr std::uint64_t kPilotSeed = 0x7365656e6c616d70ull;

std::int32_t squaresAlong(std::int32_t pixels) {
    return (pixels + SeenLamps::kSquare - 1) / SeenLamps::kSquare;
}

bool mayShow(const PixelCell& cell, PixelFilter filter, const LampImage& image) {
    const double reach = filter == PixelFilter::kBox ? 0.0 : kGaussianRadius - 0.5;
    const auto [halfX, halfY] = image.halfSize();
    return std::abs(image.centre[0] - cell.x - 0.5) < halfX + 0.5 + reach &&
           std::abs(image.centre[1] - cell.y - 0.5) < halfY + 0.5 + reach;
}

// The paths that SeenLamps follows: by delta lobes, by all of them while it may divide.
class LampPath {
  public:
    using Step = CameraStep;
    static constexpr Transport kTransport = Transport::kRadiance;

    LampPath(const Scene& scene, const LightSampler& lights, const SeenLamps::Effort& effort,
             std::uint32_t& rays)
        : m_scene(scene), m_lights(lights), m_effort(effort), m_rays(rays) {}

    const Rgb& found() const { return m_found; }

    static CacheUser user(const Step& step) { return step.user(); }
    void setOut(const Step&) { ++m_rays; }
    static void meetNothing(const Step&) {}
    Verdict meet(const Step& step, const Surface& surface) {
        if (surface.light != kNoLight)
            m_found += step.carried * m_lights.emittedRadiance(surface, -step.ray.direction);
        return m_scene.traits(surface.material).hasDelta ? Verdict::kScatter : Verdict::kEnd;
    }
    bool scatter(Step& step, const Surface& surface, const Bsdf& bsdf, Waiting<Step>& waiting) {
        if (bsdf.isBlackBody()) return false;
        BsdfSample sample;
        if (m_divisions >= m_effort.divisions)
            return sampleLobe(bsdf, step.random, sample) && isDelta(sample.lobe) &&
                   goOn(step, surface, bsdf, sample);
        const Step arrived = step;
        std::uint32_t followed = 0;
        for (const Lobe lobe : kDeltaLobes) {
            Step next = arrived;
            next.random = arrived.random.branch(static_cast<std::uint32_t>(lobe));
            if (!bsdf.follow(lobe, sample) || !goOn(next, surface, bsdf, sample)) continue;
            if (followed++ > 0) waiting.add(step);
            step = next;
        }
        m_divisions += followed > 0 ? followed - 1 : 0;
        return followed > 0;
    }

  private:
    // False: the roulette ends it.
    bool goOn(Step& step, const Surface& surface, const Bsdf& bsdf,
              const BsdfSample& sample) const {
        const float before = step.amount();
        step.takeLobe(sample);
        const float amount = step.amount();
        const float kept = amount / before;
        const bool halves = step.events.add(kept) < kept;
        // Of what ends here camera paths tell, which follow the same lobes.
        if (step.events.isOver()) return false;
        float least = m_effort.leastThroughput;
        if (step.events.count() >= m_effort.events) least = std::max(least, before);
        if (halves) least = std::max(least, 2.0f * amount);
        if (amount < least) {
            const float survival = amount / least;
            if (!(step.random.get1D(Purpose::kRoulette) < survival)) return false;
            step.carried *= 1.0f / survival;
        }
        step.leave(surface, bsdf, sample);
        return true;
    }

    const Scene& m_scene;
    const LightSampler& m_lights;
    const SeenLamps::Effort& m_effort;
    std::uint32_t& m_rays;
    std::uint32_t m_divisions = 0;  // so far
    Rgb m_found;
};

}  // namespace

SeenLamps::SeenLamps(const Scene& scene, const LightSampler& lights, const Camera& camera,
                     const RenderSettings& settings)
    : m_scene(scene),
      m_lights(lights),
      m_camera(camera),
      m_settings(settings),
      m_columns(squaresAlong(settings.width)),
      m_hasLamps(std::ranges::any_of(scene.lights(), &Light::isOnSurface)),
      m_balls(lampBalls(scene)) {
    if (m_hasLamps)
        m_shown = std::make_unique<std::atomic<std::uint8_t>[]>(
            static_cast<std::size_t>(m_columns) *
            static_cast<std::size_t>(squaresAlong(settings.height)));
}

SeenLamps::Shown SeenLamps::shown(std::int32_t x, std::int32_t y) const {
    if (!m_hasLamps || x < 0 || y < 0 || x >= m_settings.width || y >= m_settings.height) return {};
    const std::int32_t column = x / kSquare, row = y / kSquare;
    std::atomic<std::uint8_t>& kept =
        m_shown[static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                static_cast<std::size_t>(column)];
    std::uint8_t known = kept.load(std::memory_order_relaxed);
    if (known == 0) {
        // Two threads may both come here: they find the same, and the first one's images stay.
        Square square = look(column, row);
        known = static_cast<std::uint8_t>(kKnown | square.paths);
        if (!square.images.empty()) {
            known |= kHasImages;
            const std::lock_guard lock(m_imagesMutex);
            m_images.try_emplace({column, row}, std::move(square.images));
        }
        kept.store(known, std::memory_order_relaxed);
    }
    Shown shown{static_cast<std::uint32_t>(known & kPaths)};
    if (known & kHasImages) {
        const std::lock_guard lock(m_imagesMutex);
        shown.images = m_images.at({column, row});
    }
    return shown;
}

SeenLamps::Square SeenLamps::look(std::int32_t column, std::int32_t row) const {
    const double x0 = column * kSquare, y0 = row * kSquare;
    const std::uint64_t key =
        static_cast<std::uint64_t>(row) << 32 | static_cast<std::uint32_t>(column);
    constexpr float kStep = (static_cast<float>(kSquare) + 2.0f * kBeyond) / kPilots;
    Square square;
    std::vector<LampRay> rays;
    float least = std::numeric_limits<float>::max(), most = 0.0f;
    for (std::int32_t i = 0; i < kPilots * kPilots; ++i) {
        const Vec2f jitter =
            Sampler(kPilotSeed, 0, key, static_cast<std::uint32_t>(i)).get2D(Purpose::kPlace);
        const float x = (static_cast<float>(i % kPilots) + jitter.x) * kStep - kBeyond;
        const float y = (static_cast<float>(i / kPilots) + jitter.y) * kStep - kBeyond;
        const Rgb seen = followLobes(m_scene, m_lights, m_camera, x0 + static_cast<double>(x),
                                     y0 + static_cast<double>(y), rays);
        least = std::min(least, maxChannel(seen));
        most = std::max(most, maxChannel(seen));
    }
    const std::size_t raysOfPath = std::max<std::size_t>(1, rays.size() / (kPilots * kPilots));
    const FrameArea area{x0 - kFilterReach, y0 - kFilterReach, x0 + kSquare + kFilterReach,
                         y0 + kSquare + kFilterReach};
    square.images = findLampImages(m_scene, m_camera, m_balls, area, std::move(rays));
    if (least < kEven * most || !square.images.empty())
        square.paths =
            std::clamp(static_cast<std::uint32_t>(kRaysAtLamps / raysOfPath), 2u, kPathsAtLamps);
    return square;
}

Rgb SeenLamps::sample(const Shown& shown, std::uint32_t pass, const PixelCell& cell,
                      std::uint32_t index, std::uint32_t& rays) const {
    const PixelFilter filter = m_settings.filter;
    std::vector<LampImage> images;
    // A group is a preview, and twice as wide.
    if (!cell.isGroup)
        std::ranges::copy_if(shown.images, std::back_inserter(images),
                             [&](const LampImage& image) { return mayShow(cell, filter, image); });
    const Effort effort = images.empty() ? Effort{} : kOfImages;
    Rgb sum;
    const auto add = [&](const Place& place, const Sampler& sampler) {
        double weight = 1.0 / shown.paths;
        if (!images.empty()) {
            const double density =
                densityInPixel(filter, place.x - cell.x) * densityInPixel(filter, place.y - cell.y);
            if (!(density > 0)) return;
            double all = shown.paths * density;
            for (const LampImage& image : images)
                if (image.holds(place.x, place.y)) all += kPathsOfImage / image.area();
            weight = density / all;
        }
        const Ray ray = m_camera.ray({place.x, place.y});
        sum += along(ray, m_camera.footprint({place.x, place.y}, ray), sampler, rays, effort) *
               static_cast<float>(weight);
    };
    const std::uint64_t stream = cell.stream(pass) + 8;
    for (std::uint32_t i = 0; i < shown.paths; ++i) {
        const Sampler sampler(m_settings.seed, stream, cell.key(), index * shown.paths + i);
        add(cell.place(filter, sampler.get2D(Purpose::kPlace)), sampler);
    }
    for (std::size_t k = 0; k < images.size(); ++k)
        for (std::uint32_t i = 0; i < kPathsOfImage; ++i) {
            const Sampler sampler(m_settings.seed, stream + 8 * (k + 1), cell.key(),
                                  index * kPathsOfImage + i);
            const auto [x, y] = images[k].at(sampler.get2D(Purpose::kPlace));
            add({x, y}, sampler);
        }
    return sum;
}

Rgb SeenLamps::along(const Ray& ray, const RayFootprint& footprint, const Sampler& sampler,
                     std::uint32_t& rays, const Effort& effort) const {
    LampPath path(m_scene, m_lights, effort, rays);
    walk(m_scene, path, CameraStep(ray, footprint, sampler));
    return path.found();
}

}  // namespace pm
