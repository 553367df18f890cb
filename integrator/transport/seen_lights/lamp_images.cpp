// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/seen_lights/lamp_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "integrator/transport/path/camera_step.h"
#include "integrator/transport/seen_lights/ray_cone.h"

namespace pm {

namespace {

constexpr std::size_t kMostLamps = 2048;
// So few are all looked for in each area of the frame. Of more those that lie where rays by way of
// the same lobes lead, at most so many that seem the largest.
constexpr std::size_t kFewLamps = 32, kMostAhead = 128;
// A path ends after so many lobes, or where it carries less.
constexpr int kMostLobes = 10;
constexpr float kLeastThroughput = 1e-4f;
// Rays by way of the same lobes that a fit needs, and how far beyond the area it may point, pixels.
constexpr std::size_t kFewestRays = 5;
constexpr double kBeyond = 4.0;
// Newton's method: steps, and the width of its differences, pixels. It is not begun where its first
// step is longer than so many pixels.
constexpr int kSteps = 10, kHalvings = 4;
constexpr double kWidth = 0.02, kTooFar = 16.0;
// Two starts have led to the same image: their places agree so far, pixels.
constexpr double kSamePlace = 0.1;
// Starts by way of the same lobes, and how far they are apart, pixels.
constexpr int kStarts = 4;
constexpr double kApart = 1.5;
// Converged: so near to the lamp's centre, over its radius.
constexpr double kNear = 0.05;
// Larger images, pixels squared, are met by chance.
constexpr double kLargest = 9.0;
// Of the rectangle over the image itself.
constexpr double kWider = 1.3;

double lengthOf(const std::array<double, 2>& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1]);
}

// From a line to the centre of a lamp; the line's direction is from the eye on.
std::optional<Vec3d> offsetFrom(const Ray& ray, const LightBall& lamp) {
    const Vec3d d(ray.direction), to = Vec3d(lamp.centre) - Vec3d(ray.origin);
    const double along = dot(to, d);
    if (along <= 0) return std::nullopt;
    return to - d * along;
}

// The offset as a linear function of the place on the frame: q = offset + dx (x - x0) + ...
struct Linear {
    Vec3d offset, dx, dy;

    double xx() const { return dot(dx, dx); }
    double xy() const { return dot(dx, dy); }
    double yy() const { return dot(dy, dy); }
    double determinant() const { return xx() * yy() - xy() * xy(); }
    bool isDegenerate() const { return !(determinant() > 1e-8 * xx() * yy()); }
    // Around where the offset is at most the radius: the axes of |J step| <= radius, by the
    // eigenvectors of J^T J.
    LampImage around(double x, double y, double radius) const {
        const double apart = lengthOf({(xx() - yy()) / 2, xy()});
        const double largest = (xx() + yy()) / 2 + apart;
        std::array<double, 2> steep = {largest - yy(), xy()}, other = {xy(), largest - xx()};
        if (lengthOf(other) > lengthOf(steep)) steep = other;
        const double length = lengthOf(steep);
        const double c = length > 0 ? steep[0] / length : 1, s = length > 0 ? steep[1] / length : 0;
        const double across = radius / std::sqrt(largest);
        // The eigenvalues' product is the determinant.
        const double along = radius * std::sqrt(largest / determinant());
        return {{x, y}, {-s * along, c * along}, {c * across, s * across}};
    }
    // The step to where the offset is least.
    std::array<double, 2> toLeast() const {
        const double x = dot(dx, offset), y = dot(dy, offset);
        return {-(yy() * x - xy() * y) / determinant(), -(xx() * y - xy() * x) / determinant()};
    }
};

// Of the paths by way of the same lobes, about their mean place.
std::optional<Linear> fit(std::span<const LampRay> rays, const LightBall& lamp, double& x,
                          double& y) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    Vec3d sq(0), sqx(0), sqy(0);
    for (const LampRay& r : rays) {
        const auto q = offsetFrom(r.ray, lamp);
        if (!q) continue;
        n += 1, sx += r.x, sy += r.y;
        sxx += r.x * r.x, sxy += r.x * r.y, syy += r.y * r.y;
        sq = sq + *q, sqx = sqx + *q * r.x, sqy = sqy + *q * r.y;
    }
    if (n < kFewestRays) return std::nullopt;
    x = sx / n, y = sy / n;
    const double xx = sxx - n * x * x, xy = sxy - n * x * y, yy = syy - n * y * y;
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-6 * xx * yy)) return std::nullopt;
    const Vec3d qx = sqx - sq * x, qy = sqy - sq * y;
    return Linear{sq * (1 / n), (qx * yy - qy * xy) * (1 / determinant),
                  (qy * xx - qx * xy) * (1 / determinant)};
}

// The ray that these lobes lead to, from a place of the frame.
std::optional<Ray> rayBy(const Scene& scene, const Camera& camera, std::uint64_t lobes, double x,
                         double y) {
    const Ray first = camera.ray({x, y});
    CameraStep step(first, camera.footprint({x, y}, first), Sampler(0, 0, 0, 0));
    int shift = 0;
    while (lobes >> (shift + 2)) shift += 2;
    for (shift -= 2; shift >= 0; shift -= 2) {
        Surface surface;
        if (!meet(scene, step.ray, surface, &step.footprint, step.carried) ||
            !scene.traits(surface.material).hasDelta)
            return std::nullopt;
        const Bsdf bsdf(scene.materials(), surface, -step.ray.direction, Transport::kRadiance,
                        step.carried);
        BsdfSample sample;
        if (!bsdf.follow(kDeltaLobes[(lobes >> shift) & 3], sample)) return std::nullopt;
        step.takeLobe(sample);
        step.leave(surface, bsdf, sample);
    }
    return step.ray;
}

// By all delta lobes; nothing is left to chance.
struct EveryLobe {
    struct Step : CameraStep {
        using CameraStep::CameraStep;
        std::uint64_t lobes = 1;
    };
    static constexpr Transport kTransport = Transport::kRadiance;

    const Scene& scene;
    const LightSampler& lights;
    const double x, y;
    std::vector<LampRay>& rays;
    Rgb& found;

    static CacheUser user(const Step& step) { return step.user(); }
    void setOut(const Step& step) const { rays.push_back({step.lobes, x, y, step.ray}); }
    static void meetNothing(const Step&) {}
    Verdict meet(const Step& step, const Surface& surface) const {
        if (surface.light != kNoLight)
            found += step.carried * lights.emittedRadiance(surface, -step.ray.direction);
        return scene.traits(surface.material).hasDelta && step.events.count() < kMostLobes
                   ? Verdict::kScatter
                   : Verdict::kEnd;
    }
    static bool scatter(const Step& step, const Surface& surface, const Bsdf& bsdf,
                        Waiting<Step>& waiting) {
        for (std::size_t i = 0; i < kDeltaLobes.size(); ++i) {
            BsdfSample sample;
            if (!bsdf.follow(kDeltaLobes[i], sample)) continue;
            Step next = step;
            next.lobes = step.lobes << 2 | i;
            next.events.add(0.0f);
            next.takeLobe(sample);
            if (next.amount() < kLeastThroughput) continue;
            next.leave(surface, bsdf, sample);
            waiting.add(next);
        }
        return false;
    }
};

// Newton's method from (x, y) on, with shorter steps where one leads no nearer; the image's
// rectangle where it converges.
std::optional<LampImage> converge(const Scene& scene, const Camera& camera, const LightBall& lamp,
                                  std::uint64_t lobes, double x, double y) {
    const auto offsetAt = [&](double atX, double atY) -> std::optional<Vec3d> {
        const auto ray = rayBy(scene, camera, lobes, atX, atY);
        return ray ? offsetFrom(*ray, lamp) : std::nullopt;
    };
    auto q = offsetAt(x, y);
    for (int i = 0; i < kSteps && q; ++i) {
        const auto qx = offsetAt(x + kWidth, y), qy = offsetAt(x, y + kWidth);
        if (!qx || !qy) break;
        const Linear linear{*q, (*qx - *q) * (1 / kWidth), (*qy - *q) * (1 / kWidth)};
        if (linear.isDegenerate()) break;
        if (length(*q) < kNear * static_cast<double>(lamp.radius))
            return linear.around(x, y, kWider * static_cast<double>(lamp.radius));
        auto [stepX, stepY] = linear.toLeast();
        const double step = lengthOf({stepX, stepY}), far = step / kBeyond;
        if (i == 0 && step > kTooFar) break;
        if (far > 1) stepX /= far, stepY /= far;
        std::optional<Vec3d> next;
        for (int halved = 0; halved < kHalvings; ++halved, stepX /= 2, stepY /= 2) {
            next = offsetAt(x + stepX, y + stepY);
            if (next && length(*next) < length(*q)) break;
            next.reset();
        }
        x += stepX, y += stepY;
        q = next;
    }
    return std::nullopt;
}

double apart(const std::array<double, 2>& a, double x, double y) {
    return lengthOf({a[0] - x, a[1] - y});
}

// The ray, of some by way of the same lobes, from where to go to an image of the lamp. First the
// one nearest to where a fit of all meets the lamp, then those that pass it most closely, at some
// distance of what was tried or found: there may be too few rays for a fit, or several images on a
// surface that is bent. nullptr: none is left.
class Starts {
  public:
    Starts(const LightBall& lamp, std::span<const LampRay> same) : m_lamp(lamp), m_same(same) {
        for (const LampRay& ray : same) {
            const auto q = offsetFrom(ray.ray, lamp);
            m_distances.push_back(q ? length(*q) : std::numeric_limits<double>::max());
        }
    }
    const LampRay* byFit(const FrameArea& area) {
        double x = 0, y = 0;
        const auto linear = fit(m_same, m_lamp, x, y);
        if (!linear || linear->isDegenerate()) return nullptr;
        const auto [stepX, stepY] = linear->toLeast();
        x += stepX, y += stepY;
        if (!area.isNear(x, y, kBeyond)) return nullptr;
        const LampRay& ray = *std::ranges::min_element(m_same, {}, [&](const LampRay& r) {
            return apart({r.x, r.y}, x, y);
        });
        leaveOut(ray.x, ray.y);
        return &ray;
    }
    const LampRay* next() {
        const auto least = std::ranges::min_element(m_distances);
        if (*least == std::numeric_limits<double>::max()) return nullptr;
        const LampRay& ray = m_same[static_cast<std::size_t>(least - m_distances.begin())];
        leaveOut(ray.x, ray.y);
        return &ray;
    }
    void leaveOut(double x, double y) {
        for (std::size_t i = 0; i < m_same.size(); ++i)
            if (apart({m_same[i].x, m_same[i].y}, x, y) < kApart)
                m_distances[i] = std::numeric_limits<double>::max();
    }

  private:
    const LightBall& m_lamp;
    const std::span<const LampRay> m_same;
    std::vector<double> m_distances;  // of a line to the lamp's centre; largest: left out
};

// Those of the lamps that rays by way of the same lobes may lead to.
std::vector<LightBall> lampsAhead(const std::vector<LightBall>& lamps,
                                  std::span<const LampRay> same) {
    if (lamps.size() <= kFewLamps) return lamps;
    std::vector<Ray> rays;
    for (const LampRay& ray : same) rays.push_back(ray.ray);
    const RayCone cone(rays);
    std::vector<std::pair<double, std::size_t>> ahead;
    for (std::size_t i = 0; i < lamps.size(); ++i)
        if (const double seen = cone.seen(lamps[i]); seen > 0) ahead.emplace_back(-seen, i);
    std::ranges::sort(ahead);
    ahead.resize(std::min(ahead.size(), kMostAhead));
    std::vector<LightBall> chosen;
    for (const auto& [seen, i] : ahead) chosen.push_back(lamps[i]);
    return chosen;
}

// The smallest ball around both.
LightBall joined(const LightBall& a, const LightBall& b) {
    const Vec3f apart = b.centre - a.centre;
    const float distance = length(apart);
    if (distance + b.radius <= a.radius) return a;
    if (distance + a.radius <= b.radius) return b;
    const float radius = (distance + a.radius + b.radius) / 2;
    return {a.centre + apart * ((radius - a.radius) / distance), radius};
}

}  // namespace

std::array<double, 2> LampImage::at(Vec2f u) const {
    const double s = 2 * static_cast<double>(u.x) - 1, t = 2 * static_cast<double>(u.y) - 1;
    return {centre[0] + s * along[0] + t * across[0], centre[1] + s * along[1] + t * across[1]};
}

bool LampImage::holds(double x, double y) const {
    // What at() gives is held whatever rounds.
    constexpr double kRounding = 1 + 1e-9;
    const auto isWithin = [&](const std::array<double, 2>& axis) {
        const double square = axis[0] * axis[0] + axis[1] * axis[1];
        const double share = (x - centre[0]) * axis[0] + (y - centre[1]) * axis[1];
        return std::abs(share) <= kRounding * square;
    };
    return isWithin(along) && isWithin(across);
}

double LampImage::area() const {
    return 4 * lengthOf(along) * lengthOf(across);
}

std::array<double, 2> LampImage::halfSize() const {
    return {std::abs(along[0]) + std::abs(across[0]), std::abs(along[1]) + std::abs(across[1])};
}

std::vector<LightBall> lampBalls(const Scene& scene) {
    std::vector<LightBall> balls;
    for (const Light& light : scene.lights()) {
        if (!light.isOnSurface()) continue;
        const LightBall ball = light.ball(scene);
        const auto touching = std::ranges::find_if(balls, [&](const LightBall& other) {
            return length(ball.centre - other.centre) < ball.radius + other.radius;
        });
        if (touching != balls.end()) {
            *touching = joined(*touching, ball);
        } else {
            if (balls.size() == kMostLamps) return {};
            balls.push_back(ball);
        }
    }
    return balls;
}

bool LampImage::isAround(const FrameArea& frame) const {
    const auto [halfX, halfY] = halfSize();
    return std::abs(2 * centre[0] - frame.x0 - frame.x1) < frame.x1 - frame.x0 + 2 * halfX &&
           std::abs(2 * centre[1] - frame.y0 - frame.y1) < frame.y1 - frame.y0 + 2 * halfY;
}

Rgb followLobes(const Scene& scene, const LightSampler& lights, const Camera& camera, double x,
                double y, std::vector<LampRay>& rays) {
    Rgb found;
    const Ray first = camera.ray({x, y});
    walk(scene, EveryLobe{scene, lights, x, y, rays, found},
         EveryLobe::Step(first, camera.footprint({x, y}, first), Sampler(0, 0, 0, 0)));
    return found;
}

std::vector<LampImage> findLampImages(const Scene& scene, const Camera& camera,
                                      const std::vector<LightBall>& lamps, const FrameArea& area,
                                      std::vector<LampRay> rays) {
    std::vector<LampImage> images;
    std::ranges::stable_sort(rays, {}, &LampRay::lobes);
    for (std::size_t first = 0, last = 0; first < rays.size(); first = last) {
        while (last < rays.size() && rays[last].lobes == rays[first].lobes) ++last;
        const auto same = std::span(rays).subspan(first, last - first);
        for (const LightBall& lamp : lampsAhead(lamps, same)) {
            const auto before = images.size();
            Starts starts(lamp, same);
            for (int i = 0; i < kStarts; ++i) {
                const LampRay* const start = i == 0 ? starts.byFit(area) : starts.next();
                if (!start) continue;
                const auto image = converge(scene, camera, lamp, start->lobes, start->x, start->y);
                if (!image) continue;
                const double x = image->centre[0], y = image->centre[1];
                starts.leaveOut(x, y);
                const bool isKnown = std::any_of(
                    images.begin() + static_cast<std::ptrdiff_t>(before), images.end(),
                    [&](const LampImage& other) { return apart(other.centre, x, y) < kSamePlace; });
                if (!isKnown && image->area() > 0 && image->area() < kLargest &&
                    image->isAround(area))
                    images.push_back(*image);
            }
        }
    }
    return images;
}

}  // namespace pm
