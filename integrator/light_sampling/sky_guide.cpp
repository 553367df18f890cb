// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/light_sampling/sky_guide.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "integrator/sampling/sampler.h"

namespace pm {

namespace {

constexpr std::size_t kPlacesOfALeaf = 8;
// Rays to a cell of directions from the places of a leaf; and where those, or the rays of leaves
// beside it, let expect more than this share of the mean over cells.
constexpr std::uint32_t kFirstLooks = 8, kLooks = 24;
constexpr double kLittle = 0.1;
// What is known of a cell of directions from the places above counts for so many of them.
constexpr float kPriorLooks = 2.0f;
// Rays of many places tell no more of one of them than so many of its own.
constexpr float kMostLooks = 8.0f;
// Share of the directions that the environment chooses by itself: where it is the same all around
// that is for what the rays have missed, else also for what is bright within a cell.
constexpr float kOwnShareOfEven = 0.1f, kOwnShareOfPicture = 0.5f;

constexpr std::uint32_t kDirections = SkyGuide::Directions::kCount;

}  // namespace

class SkyGuide::Learner {
  public:
    Learner(SkyGuide& guide, std::uint64_t seed, const Look& look)
        : m_guide(guide),
          m_cells(guide.m_places.cells()),
          m_seed(seed),
          m_look(look),
          m_seen(m_cells.size() * kDirections) {
        guide.m_tables.assign(guide.m_places.leaves() * kDirections, 1.0f / kDirections);
        lookFromLeaves(0, kFirstLooks);
        lookFromLeaves(kFirstLooks, kLooks);
        tbb::parallel_for(std::size_t{0}, guide.m_places.leaves(),
                          [&](std::size_t leaf) { accumulate(tableOf(leaf)); });
    }

  private:
    struct Seen {
        float looks = 0.0f, squares = 0.0f;  // of the light that they found

        void add(const Seen& other) {
            looks += other.looks;
            squares += other.squares;
        }
    };

    std::span<float> tableOf(std::size_t leaf) {
        return std::span(m_guide.m_tables).subspan(leaf * kDirections, kDirections);
    }

    // The rays from the first to before the last, to the cells that are worth them by the tables so
    // far; makes the tables anew.
    void lookFromLeaves(std::uint32_t first, std::uint32_t last) {
        tbb::parallel_for(std::size_t{0}, m_cells.size(), [&](std::size_t i) {
            if (m_cells[i].right == 0) lookFrom(i, first, last);
        });
        gather();
        m_guide.m_places.spread(
            std::vector<float>(kDirections, 0.0f),
            [this](std::size_t cell, const auto& above) { return learnCell(cell, above); });
    }

    void lookFrom(std::size_t index, std::uint32_t first, std::uint32_t last) {
        const std::span<const std::uint32_t> places =
            m_guide.m_places.placesOf(m_cells[index].axis);
        const std::span<const float> table = tableOf(m_cells[index].axis);
        for (std::uint32_t c = 0; c < kDirections; ++c) {
            if (static_cast<double>(table[c]) * kDirections < kLittle) continue;
            for (std::uint32_t i = first; i < last; ++i) {
                const std::size_t place = places[(c + i) % places.size()];
                const Sampler sampler(m_seed, c, index, i);
                const float light =
                    m_look(place, Directions::directionIn(c, sampler.get2D(Purpose::kDirection)));
                m_seen[index * kDirections + c].add({1.0f, light * light});
            }
        }
    }

    // Sums up what was seen.
    void gather() {
        m_guide.m_places.gather([this](std::size_t cell, std::size_t left, std::size_t right) {
            for (std::size_t c = 0; c < kDirections; ++c) {
                Seen& seen = m_seen[cell * kDirections + c];
                seen = m_seen[left * kDirections + c];
                seen.add(m_seen[right * kDirections + c]);
            }
        });
    }

    // The mean square of each cell of directions, as far as is known; of a leaf, the table of it,
    // too.
    std::vector<float> learnCell(std::size_t index, const std::vector<float>& above) {
        const PlaceCells::Cell& cell = m_cells[index];
        std::vector<float> squares(kDirections);
        for (std::size_t c = 0; c < kDirections; ++c) {
            const Seen& seen = m_seen[index * kDirections + c];
            const float looks = cell.right == 0 ? seen.looks : std::min(seen.looks, kMostLooks);
            squares[c] =
                (seen.squares / std::max(1.0f, seen.looks) * looks + kPriorLooks * above[c]) /
                (looks + kPriorLooks);
        }
        if (cell.right == 0) makeTable(tableOf(cell.axis), squares);
        return squares;
    }

    // The variance of the sum is least when each cell is chosen by the root of its second moment.
    // Blurred: from other places of the leaf the window lies a little beside.
    static void makeTable(std::span<float> table, std::vector<float>& squares) {
        for (float& s : squares) s = std::isfinite(s) ? std::sqrt(s) : 0.0f;
        double total = 0;
        for (std::uint32_t c = 0; c < kDirections; ++c) total += table[c] = blurred(squares, c);
        for (float& t : table)
            t = total > 0 ? static_cast<float>(static_cast<double>(t) / total) : 1.0f / kDirections;
    }

    static float blurred(const std::vector<float>& values, std::uint32_t cell) {
        const auto column = static_cast<std::int32_t>(cell % Directions::kSide);
        const auto row = static_cast<std::int32_t>(cell / Directions::kSide);
        float sum = 0.0f;
        for (const std::int32_t j : {-1, 0, 1})
            for (const std::int32_t i : {-1, 0, 1})
                sum += values[Directions::cellAt(column + i, row + j)] * (i == 0 ? 0.75f : 0.125f) *
                       (j == 0 ? 0.75f : 0.125f);
        return sum;
    }

    // Of the probabilities.
    static void accumulate(std::span<float> table) {
        double sum = 0;
        for (float& t : table) {
            sum += static_cast<double>(t);
            t = static_cast<float>(std::min(1.0, sum));
        }
        table.back() = 1.0f;
    }

    SkyGuide& m_guide;
    std::span<const PlaceCells::Cell> m_cells;
    std::uint64_t m_seed;
    const Look& m_look;
    std::vector<Seen> m_seen;  // of the cells of places, one direction after another
};

SkyGuide::SkyGuide(const Environment& environment, std::span<const Receiver> places,
                   std::uint64_t seed, const Look& look)
    : m_environment(environment),
      m_ownShare(environment.isEven() ? kOwnShareOfEven : kOwnShareOfPicture),
      m_places(places, kPlacesOfALeaf, 0.0f) {
    Learner(*this, seed, look);
}

const float* SkyGuide::table(const Vec3f& position) const {
    const std::uint32_t leaf = m_places.leafAt({position, {}});
    return leaf == PlaceCells::kNoLeaf ? nullptr
                                       : m_tables.data() + std::size_t{leaf} * kDirections;
}

float SkyGuide::pdfBy(const float* cumulative, const Vec3f& direction) const {
    const std::uint32_t cell = Directions::cellOf(direction);
    const float share = cumulative[cell] - (cell == 0 ? 0.0f : cumulative[cell - 1]);
    return m_ownShare * m_environment.pdfSolidAngle(direction) +
           (1.0f - m_ownShare) * share / Directions::kSolidAngle;
}

Vec3f SkyGuide::sample(const Vec3f& position, Vec2f u, float& pdfSolidAngle) const {
    const float* const cumulative = table(position);
    if (!cumulative) return m_environment.sample(u, pdfSolidAngle);
    constexpr float kMost = 1.0f - 0x1p-24f;
    Vec3f direction;
    if (u.x < m_ownShare) {
        u.x = std::min(u.x / m_ownShare, kMost);
        direction = m_environment.sample(u, pdfSolidAngle);
    } else {
        const float x = std::min((u.x - m_ownShare) / (1.0f - m_ownShare), kMost);
        const float* const chosen = std::upper_bound(cumulative, cumulative + kDirections - 1, x);
        const float below = chosen == cumulative ? 0.0f : chosen[-1];
        u.x = std::min((x - below) / (*chosen - below), kMost);
        direction = Directions::directionIn(static_cast<std::uint32_t>(chosen - cumulative), u);
    }
    pdfSolidAngle = pdfBy(cumulative, direction);
    return direction;
}

float SkyGuide::pdfSolidAngle(const Vec3f& position, const Vec3f& direction) const {
    const float* const cumulative = table(position);
    return cumulative ? pdfBy(cumulative, direction) : m_environment.pdfSolidAngle(direction);
}

}  // namespace pm
