// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/lamp_texture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Share of the points that are chosen evenly over the lamp.
constexpr float kEvenShare = 0.02f;
// A lamp is even where choosing its points evenly makes the variance of what they show no more than
// this times their mean squared.
constexpr double kEven = 0.1;
// A cell is divided where its variance, in units of all the lamp's mean squared, is more than this.
constexpr double kLeastVariance = 1e-5;
// A place counts for at least this share of its brightest neighbour, whose light interpolation
// carries over to the cells between places that show nothing.
constexpr float kNeighbourShare = 0.1f;
// Where texels are finer than places are dense, a cell has so many places along its side at least:
// one says nothing of its surroundings.
constexpr std::uint32_t kPlacesOfTexels = 8;

// Places along a lamp's side: eight to a texel, less of large pictures.
std::uint32_t placesFor(const LampTexture::Lamp& lamp) {
    const double side = std::sqrt(static_cast<double>(lamp.mostLooks) *
                                  (lamp.domain == LampTexture::Domain::kTriangle ? 2 : 1));
    const auto most = std::bit_floor(static_cast<std::uint32_t>(std::clamp(side, 1.0, 4096.0)));
    const double wanted = lamp.texels * (lamp.texels <= 64    ? 8
                                         : lamp.texels <= 128 ? 4
                                         : lamp.texels <= 512 ? 2
                                                              : 1);
    if (!(wanted < most)) return most;
    return std::bit_ceil(static_cast<std::uint32_t>(std::ceil(std::max(1.0, wanted))));
}

// What was seen at the places of a lattice: of a triangle half of a square's.
class Lattice {
  public:
    Lattice(LampTexture::Domain domain, std::uint32_t side)
        : m_isTriangle(domain == LampTexture::Domain::kTriangle),
          m_side(side),
          m_values(begin(side + 1)) {}

    std::uint32_t side() const { return m_side; }
    std::uint32_t rowSize(std::uint32_t j) const { return m_side + 1 - (m_isTriangle ? j : 0); }
    float& at(std::uint32_t i, std::uint32_t j) { return m_values[begin(j) + i]; }
    float at(std::uint32_t i, std::uint32_t j) const { return m_values[begin(j) + i]; }

    // How many of the smallest cells meet at a place.
    double cellsAt(std::uint32_t i, std::uint32_t j) const {
        if (!m_isTriangle) return (i == 0 || i == m_side ? 1 : 2) * (j == 0 || j == m_side ? 1 : 2);
        const int edges = (i == 0 ? 1 : 0) + (j == 0 ? 1 : 0) + (i + j == m_side ? 1 : 0);
        return edges == 0 ? 6 : edges == 1 ? 3 : 1;
    }

    // Or a share of the brightest neighbour's, if that is more.
    float spread(std::uint32_t i, std::uint32_t j) const {
        float brightest = 0;
        for (std::uint32_t y = j > 0 ? j - 1 : 0; y <= std::min(j + 1, m_side); ++y)
            for (std::uint32_t x = i > 0 ? i - 1 : 0; x <= i + 1 && x < rowSize(y); ++x)
                brightest = std::max(brightest, at(x, y));
        return std::max(at(i, j), kNeighbourShare * brightest);
    }

  private:
    std::size_t begin(std::size_t j) const {
        const std::size_t all = j * (m_side + std::size_t{1});
        return m_isTriangle ? all - j * (j - (j > 0 ? 1 : 0)) / 2 : all;
    }

    bool m_isTriangle;
    std::uint32_t m_side;
    std::vector<float> m_values;
};

}  // namespace

class LampTexture::Builder {
  public:
    Builder(const Lamp& lamp, const CancelCheck& cancel)
        : m_cancel(cancel),
          m_isTriangle(lamp.domain == Domain::kTriangle),
          m_light(lamp.domain, placesFor(lamp)),
          m_weights(m_light) {
        const std::uint32_t side = m_light.side();
        const bool isCoarse = lamp.texels > side;
        const float step = isCoarse ? 1.0f / static_cast<float>(side) : 0.0f;
        if (isCoarse) m_leaf = static_cast<std::int32_t>(std::min(kPlacesOfTexels, side));
        forEachRow([&](std::uint32_t j) {
            for (std::uint32_t i = 0; i < m_light.rowSize(j); ++i) {
                const Look look = lamp.look(place(i, j, isCoarse), step);
                m_light.at(i, j) = static_cast<float>(look.radiance);
                m_weights.at(i, j) = static_cast<float>(look.area);
            }
        });
    }

    // Returns the variance of the lamp's radiance over its mean squared.
    double measure(double& mean) const {
        double area = 0, sum = 0, squares = 0;
        for (std::uint32_t j = 0; j <= m_light.side(); ++j)
            for (std::uint32_t i = 0; i < m_light.rowSize(j); ++i) {
                const auto radiance = static_cast<double>(m_light.at(i, j));
                const double weight =
                    m_light.cellsAt(i, j) * static_cast<double>(m_weights.at(i, j));
                area += weight;
                sum += weight * radiance;
                squares += weight * radiance * radiance;
            }
        mean = area > 0 ? sum / area : 0.0;
        return sum > 0 ? squares * area / (sum * sum) - 1 : 0.0;
    }

    // The root comes last.
    std::vector<Node> divide() {
        forEachRow([&](std::uint32_t j) {
            for (std::uint32_t i = 0; i < m_light.rowSize(j); ++i)
                m_weights.at(i, j) *= m_light.spread(i, j);
        });
        const Cell whole{0, 0, static_cast<std::int32_t>(m_light.side())};
        m_least = std::numeric_limits<double>::infinity();
        const double sum = make(whole).sum;
        m_least = kLeastVariance * sum;
        for (make(whole); m_nodes.size() > kMostNodes; make(whole)) {
            m_nodes.clear();
            m_least *= 4;
        }
        return std::move(m_nodes);
    }

  private:
    // Of the lattice; with a size below 0 turned by half.
    struct Cell {
        std::int32_t x, y, size;
    };
    // What a cell shows, and its node's number plus 1; 0: not divided.
    struct Made {
        double sum = 0, squares = 0, places = 0;
        std::uint32_t node = 0;
    };

    template <typename Visit>
    void forEachRow(const Visit& visit) {
        const auto row = [&](std::uint32_t j) {
            m_cancel.throwIfSet("looking at a lamp's texture");
            visit(j);
        };
        // Of many small lamps none is worth threads of its own.
        constexpr std::uint32_t kSmall = 32;
        if (m_light.side() > kSmall)
            tbb::parallel_for(0u, m_light.side() + 1, row);
        else
            for (std::uint32_t j = 0; j <= m_light.side(); ++j) row(j);
    }

    // Moved within their surroundings where texels are finer: places in step with what repeats
    // would see the same of it everywhere.
    Vec2f place(std::uint32_t i, std::uint32_t j, bool isCoarse) const {
        auto x = static_cast<double>(i), y = static_cast<double>(j);
        const auto side = static_cast<double>(m_light.side());
        if (isCoarse) {
            const std::uint64_t bits = mixBits(std::uint64_t{i} << 32 | j);
            x = std::clamp(x + static_cast<double>(bits >> 40) * 0x1p-24 - 0.5, 0.0, side);
            y = std::clamp(y + static_cast<double>(bits & 0xffffff) * 0x1p-24 - 0.5, 0.0, side);
            const double beyond = m_isTriangle ? std::max(0.0, x + y - side) : 0.0;
            x = std::max(0.0, x - 0.5 * beyond);
            y = std::max(0.0, y - 0.5 * beyond);
        }
        return {static_cast<float>(x / side), static_cast<float>(y / side)};
    }

    double smallest(const Cell& cell) const {
        const auto at = [&](std::int32_t x, std::int32_t y) {
            return static_cast<double>(
                m_weights.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
        };
        const double three =
            at(cell.x, cell.y) + at(cell.x + cell.size, cell.y) + at(cell.x, cell.y + cell.size);
        return m_isTriangle ? three / 3 : (three + at(cell.x + cell.size, cell.y + cell.size)) / 4;
    }

    Made make(const Cell& cell) {
        if (std::abs(cell.size) == 1) {
            const double one = smallest(cell);
            return {one, one * one, 1};
        }
        const std::size_t begin = m_nodes.size();
        const std::int32_t h = cell.size / 2;
        const std::array<Cell, 4> parts = {Cell{cell.x, cell.y, h}, Cell{cell.x + h, cell.y, h},
                                           Cell{cell.x, cell.y + h, h},
                                           Cell{cell.x + h, cell.y + h, m_isTriangle ? -h : h}};
        Made all;
        Node node{};
        std::array<double, 4> upTo{};
        for (std::size_t i = 0; i < 4; ++i) {
            const Made part = make(parts[i]);
            all.sum += part.sum;
            all.squares += part.squares;
            all.places += part.places;
            node.parts[i] = part.node;
            upTo[i] = all.sum;
        }
        const bool differs = all.sum > 0 && all.squares * all.places / all.sum - all.sum > m_least;
        if (!differs || std::abs(cell.size) <= m_leaf) {
            m_nodes.resize(begin);
            return all;
        }
        for (std::size_t i = 0; i < 3; ++i) node.upTo[i] = static_cast<float>(upTo[i] / all.sum);
        m_nodes.push_back(node);
        all.node = static_cast<std::uint32_t>(m_nodes.size());
        return all;
    }

    const CancelCheck& m_cancel;
    bool m_isTriangle;
    Lattice m_light, m_weights;
    std::vector<Node> m_nodes;
    std::int32_t m_leaf = 1;  // no cell of this size is divided
    double m_least = 0;
};

LampTexture::LampTexture(const Lamp& lamp, const CancelCheck& cancel) : m_domain(lamp.domain) {
    Builder builder(lamp, cancel);
    if (builder.measure(m_mean) > kEven) m_nodes = builder.divide();
}

Vec2f LampTexture::sample(Vec2f u, float& density) const {
    density = 1.0f;
    const bool isTriangle = m_domain == Domain::kTriangle;
    if (isEven()) return isTriangle ? sampleTriangle(u) : u;
    const auto even = static_cast<double>(kEvenShare);
    double x = refined(u), y = 0, z = 0, size = 1;
    if (x < even) {
        const Vec2f left{toBelowOne(x / even), u.y};
        const Vec2f point = isTriangle ? sampleTriangle(left) : left;
        density = this->density(point);
        return point;
    }
    x = (x - even) / (1 - even);
    double found = 1;
    for (std::size_t at = m_nodes.size(); at != 0;) {
        const Node& node = m_nodes[at - 1];
        const std::size_t i = node.partAt(x);
        const double share = node.share(i);
        x = std::min((x - node.begin(i)) / share, 1 - 0x1p-50);
        found *= 4 * share;
        size *= 0.5;
        if (i == 1 || i == 3) y += size;
        if (i == 2 || i == 3) z += size;
        if (i == 3 && isTriangle) size = -size;
        at = node.parts[i];
    }
    density = static_cast<float>(even + (1 - even) * found);
    const Vec2f left{toBelowOne(x), u.y};
    const Vec2f local = isTriangle ? sampleTriangle(left) : left;
    return {static_cast<float>(y + size * static_cast<double>(local.x)),
            static_cast<float>(z + size * static_cast<double>(local.y))};
}

float LampTexture::density(Vec2f point) const {
    if (isEven()) return 1.0f;
    auto x = static_cast<double>(point.x), y = static_cast<double>(point.y);
    double found = 1;
    for (std::size_t at = m_nodes.size(); at != 0;) {
        const Node& node = m_nodes[at - 1];
        std::size_t i = (x >= 0.5 ? 1 : 0) + (y >= 0.5 ? 2 : 0);
        x = 2 * x - (x >= 0.5 ? 1 : 0);
        y = 2 * y - (y >= 0.5 ? 1 : 0);
        if (m_domain == Domain::kTriangle && i == 0 && x + y >= 1) {
            i = 3;
            x = 1 - x;
            y = 1 - y;
        }
        found *= 4 * node.share(i);
        at = node.parts[i];
    }
    return kEvenShare + (1 - kEvenShare) * static_cast<float>(found);
}

}  // namespace pm
