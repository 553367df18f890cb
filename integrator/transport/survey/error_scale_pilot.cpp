// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/error_scale_pilot.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/pinned_math.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/transport/path/path_integrator.h"
#include "integrator/transport/survey/pilot_paths.h"

namespace pm {

namespace {

// Cells of the frame, and paths of each at most. Rounds of one path a cell are begun while fewer
// rays than this were traced: where little is absorbed a single path takes thousands.
constexpr std::int32_t kSide = 16;
constexpr std::uint32_t kRounds = 16;
constexpr std::uint64_t kEnoughRays = 1 << 14;
constexpr std::uint64_t kSeed = 0x6572726f72736361ull;

constexpr double kMiddleGrey = 0.18, kMostHighlight = 2, kHighlightShare = 0.02;
// Of the highlights: darker than this counts as this.
constexpr double kDarkest = 1e-4;
// What reflects less is metered only where nothing reflects more.
constexpr double kBlackAlbedo = 1e-4;
// Where less of what is covered is metered, lights that are seen are, too.
constexpr double kLeastMetered = 0.1;
// Light that few paths find is taken for that of as many cells around as know it so well: the
// logarithm of a mean with a larger relative error than this is too low.
constexpr double kKnown = 0.5;

// Paths that have shown something of one kind.
struct Metered {
    double count = 0, sum = 0, squares = 0;  // of luminance

    void add(double luminance) {
        ++count;
        sum += luminance;
        squares += luminance * luminance;
    }
    void add(const Metered& other) {
        count += other.count;
        sum += other.sum;
        squares += other.squares;
    }
    double mean() const { return sum / count; }
    bool isKnown() const {
        const double variance = std::max(0.0, squares / count - mean() * mean()) / count;
        return sum > 0 && variance <= kKnown * kKnown * mean() * mean();
    }
};

struct Cell {
    Metered surfaces, dim, shining;
};
using Cells = std::vector<Cell>;

class Luminance {
  public:
    explicit Luminance(const Scene& scene) : m_toXyz(scene.description().rgbToXyz) {}
    double operator()(const Rgb& c) const {
        return m_toXyz[3] * static_cast<double>(c.r) + m_toXyz[4] * static_cast<double>(c.g) +
               m_toXyz[5] * static_cast<double>(c.b);
    }

  private:
    const std::array<double, 9>& m_toXyz;
};

void note(const SampleRadiance& s, const Luminance& luminance, Cell& cell) {
    if (!(s.coverage > 0.0f)) return;
    const double all = luminance(s.emission + s.direct + s.caustic + s.indirect);
    if (!std::isfinite(all)) return;
    const double value = std::max(all, 0.0), albedo = luminance(s.albedo);
    if (luminance(s.emission) > 0)
        cell.shining.add(value);
    else if (albedo > 0)
        (albedo < kBlackAlbedo ? cell.dim : cell.surfaces).add(value);
}

// The footprint of a path that stands for a cell.
RayFootprint widened(RayFootprint footprint, const FrameLattice& lattice) {
    const auto widen = [](RayFootprint::Side& side, double by) {
        side.origin = side.origin * static_cast<float>(by);
        side.direction = side.direction * static_cast<float>(by);
    };
    widen(footprint.x, lattice.cellWidth);
    widen(footprint.y, lattice.cellHeight);
    return footprint;
}

// isEnough: of the cells so far, after each round.
template <typename IsEnough>
Cells look(const Scene& scene, const RenderSettings& settings, const CancelCheck& cancel,
           IsEnough isEnough) {
    // By power: a choice of many lights takes a tree, and time that a start hasn't got.
    const LightSampler lights = LightSampler::forPhotons(scene);
    const Camera camera(scene, settings.width, settings.height);
    const PathIntegrator paths(scene, lights);
    const Luminance luminance(scene);
    const FrameLattice lattice = FrameLattice::fixed(settings, kSide, kSide);
    Cells cells(lattice.size());
    std::vector<std::uint64_t> rays(lattice.size());
    std::uint64_t traced = 0;
    for (std::uint32_t round = 0; round < kRounds && traced < kEnoughRays; ++round) {
        tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
            cancel.throwIfSet("looking how bright the picture is");
            const Sampler sampler(kSeed, 0, i, round);
            const Vec2f in = sampler.get2D(Purpose::kPlace);
            const CameraSample at{
                (static_cast<double>(i % kSide) + static_cast<double>(in.x)) * lattice.cellWidth,
                (static_cast<double>(i / kSide) + static_cast<double>(in.y)) * lattice.cellHeight};
            const Ray ray = camera.ray(at);
            const SampleRadiance seen =
                paths.sample(ray, sampler, widened(camera.footprint(at, ray), lattice));
            rays[i] = seen.rays;
            note(seen, luminance, cells[i]);
        });
        for (const std::uint64_t some : rays) traced += some;
        if (isEnough(cells, round + 1)) break;
    }
    return cells;
}

// What is metered of each cell.
std::vector<Metered> meteredOf(const Cells& cells) {
    Metered surfaces, shining;
    for (const Cell& cell : cells) {
        surfaces.add(cell.surfaces);
        shining.add(cell.shining);
    }
    const bool isDim = surfaces.count == 0;
    if (isDim)
        for (const Cell& cell : cells) surfaces.add(cell.dim);
    const bool withLights = surfaces.count < kLeastMetered * (surfaces.count + shining.count);
    std::vector<Metered> metered;
    for (const Cell& cell : cells) {
        metered.push_back(isDim ? cell.dim : cell.surfaces);
        if (withLights) metered.back().add(cell.shining);
    }
    return metered;
}

// Of the smallest square of cells around this one that knows its light, else of all.
Metered around(const std::vector<Metered>& cells, std::int32_t x, std::int32_t y) {
    Metered sum;
    for (std::int32_t radius = 0; radius < kSide; radius = 2 * radius + 1) {
        sum = {};
        for (std::int32_t j = std::max(0, y - radius); j <= std::min(kSide - 1, y + radius); ++j)
            for (std::int32_t i = std::max(0, x - radius); i <= std::min(kSide - 1, x + radius);
                 ++i)
                sum.add(cells[static_cast<std::size_t>(j * kSide + i)]);
        if (sum.isKnown()) break;
    }
    return sum;
}

// A luminance, and how many paths have met it.
struct Lit {
    double luminance = 0, count = 0;
};

std::vector<Lit> litOf(const std::vector<Metered>& metered) {
    std::vector<Lit> lit;
    for (std::int32_t y = 0; y < kSide; ++y)
        for (std::int32_t x = 0; x < kSide; ++x)
            if (const double count = metered[static_cast<std::size_t>(y * kSide + x)].count;
                count > 0)
                lit.push_back({around(metered, x, y).mean(), count});
    std::ranges::sort(lit, {}, &Lit::luminance);
    return lit;
}

double stopsOf(const Cells& cells) {
    const std::vector<Lit> lit = litOf(meteredOf(cells));
    double all = 0;
    for (const Lit& one : lit) all += one.count;
    double brighter = kHighlightShare * all, highlight = 0;
    for (auto one = lit.rbegin(); one != lit.rend() && brighter >= 0; ++one) {
        highlight = one->luminance;
        brighter -= one->count;
    }
    if (!(highlight > 0)) highlight = lit.empty() ? 0 : lit.back().luminance;
    if (!(highlight > 0)) return 0;
    double sum = 0;
    for (const Lit& one : lit)
        sum += one.count * pinnedLog2(std::max(one.luminance, kDarkest * highlight));
    const double stops = std::min(pinnedLog2(kMiddleGrey) - sum / all,
                                  pinnedLog2(kMostHighlight) - pinnedLog2(highlight));
    constexpr double kMost = ErrorScale::kMostStops;
    return std::clamp(stops, -kMost, kMost);
}

bool isAnyLit(const Cells& cells) {
    return std::ranges::any_of(
        cells, [](const Cell& cell) { return cell.surfaces.sum > 0 || cell.dim.sum > 0; });
}

// So few paths know well enough that a picture is far from where a scale begins.
bool isClearlyNeutral(const Cells& cells, std::uint32_t rounds) {
    constexpr std::uint32_t kLeastRounds = 2;
    return rounds >= kLeastRounds && isAnyLit(cells) &&
           std::abs(stopsOf(cells)) < 0.5 * kNeutralStops;
}

}  // namespace

std::int32_t stopsToMiddleGrey(const Scene& scene, const RenderSettings& settings,
                               const CancelCheck& cancel) {
    const auto never = [](const Cells&, std::uint32_t) { return false; };
    return static_cast<std::int32_t>(std::round(stopsOf(look(scene, settings, cancel, never))));
}

ErrorScale findErrorScale(const Scene& scene, const RenderSettings& settings,
                          const CancelCheck& cancel) {
    if (scene.lights().empty()) return {};
    const double stops = stopsOf(look(scene, settings, cancel, isClearlyNeutral));
    const auto whole = static_cast<std::int32_t>(std::round(stops));
    return std::abs(whole) <= kNeutralStops ? ErrorScale() : ErrorScale(whole);
}

}  // namespace pm
