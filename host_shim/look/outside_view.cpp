// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/look/outside_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host_shim/look/framing.h"

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

// The front stays where it shows this share of what the best view does: half, as its floor and
// ceiling, seen along them, are hidden by their own cells.
constexpr double kGoodEnough = 0.5;
// Another side that is looked at straight stays where it shows this share: as no steep view shares
// it, what the slanting ones beside it show counts for more than beside the front.
constexpr double kGoodEnoughStraight = 0.4;
// Of the cells that hold surface, so many are looked at.
constexpr std::size_t kLookedAt = 4096;
// What is seen from behind says less.
constexpr double kBackWeight = 0.25;

constexpr std::array<Point, 8> kDirections{{{0.7, 0.5, 1},
                                            {-0.7, 0.5, 1},
                                            {0.4, 1.2, 1},
                                            {1, 0, 0},
                                            {-1, 0, 0},
                                            {0.7, 0.5, -1},
                                            {-0.7, 0.5, -1},
                                            {0, 0, -1}}};

// Cells that hold surface, evenly out of all.
std::vector<Cell> someCells(const OccupancyGrid& grid) {
    std::vector<Cell> all;
    const Cell& size = grid.size();
    for (int z = 0; z < size[2]; ++z)
        for (int y = 0; y < size[1]; ++y)
            for (int x = 0; x < size[0]; ++x)
                if (grid.holds({x, y, z})) all.push_back({x, y, z});
    if (all.size() <= kLookedAt) return all;
    std::vector<Cell> some;
    for (std::size_t i = 0; i < kLookedAt; ++i) some.push_back(all[i * all.size() / kLookedAt]);
    return some;
}

// Corners of the cells that anything is in, within the bounds.
std::vector<Point> cornersOf(const OccupancyGrid& grid, const Bounds& bounds) {
    std::vector<Point> corners;
    const Cell& size = grid.size();
    Cell cell{};
    for (cell[2] = 0; cell[2] < size[2]; ++cell[2])
        for (cell[1] = 0; cell[1] < size[1]; ++cell[1])
            for (cell[0] = 0; cell[0] < size[0]; ++cell[0]) {
                if (!grid.reaches(cell)) continue;
                for (unsigned corner = 0; corner < 8; ++corner) {
                    Point at = grid.middleOf(cell);
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const double half = grid.cellSize() / 2;
                        at[axis] = std::clamp(at[axis] + ((corner >> axis & 1) != 0 ? half : -half),
                                              bounds.low[axis], bounds.high[axis]);
                    }
                    corners.push_back(at);
                }
            }
    return corners;
}

// Whether nothing stands between a cell and what lies in this direction (of unit length).
bool isFree(const OccupancyGrid& grid, const Cell& from, const Point& along) {
    const Point middle = grid.middleOf(from);
    // The cells beside it are of the same surface.
    constexpr double kFirst = 1.75, kStep = 0.75;
    for (double gone = kFirst;; gone += kStep) {
        Point at = middle;
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] += gone * grid.cellSize() * along[axis];
        const Cell cell = grid.cellOf(at);
        if (!grid.contains(cell)) return true;
        if (grid.holds(cell)) return false;
    }
}

// Of a cell's surface what can be seen from a direction: all of it, but less of what is seen at
// more than 60 degrees.
double seenArea(const OccupancyGrid& grid, const Cell& cell, const Point& along) {
    double seen = 0;
    for (const bool back : {false, true}) {
        double projected = 0, squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t towards = 2 * axis + ((along[axis] > 0) != back ? 1 : 0);
            const double area = static_cast<double>(grid.areaSeenFrom(towards, cell));
            projected += area * std::abs(along[axis]);
            squared += area * area;
        }
        seen += std::min(std::sqrt(squared), 2 * projected) * (back ? kBackWeight : 1);
    }
    return seen;
}

// How much of what is around a place is hidden from outside, in [0,1]: of the 26 directions to its
// neighbours those that end at a surface, beyond the third that any wall beside it hides.
double shelter(const OccupancyGrid& grid, const Cell& place) {
    constexpr int kOfOneWall = 9, kAll = 26;
    int blocked = 0;
    for (int code = 0; code < 27; ++code) {
        const Cell by{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
        if (by == Cell{}) continue;
        Cell cell = place;
        do {
            for (std::size_t axis = 0; axis < 3; ++axis) cell[axis] += by[axis];
        } while (grid.contains(cell) && !grid.holds(cell));
        if (grid.contains(cell)) ++blocked;
    }
    return std::max(0.0, static_cast<double>(blocked - kOfOneWall) / (kAll - kOfOneWall));
}

// The cell before a surface's, towards the eye.
Cell placeBefore(const OccupancyGrid& grid, const Cell& cell, const Point& along) {
    constexpr double kBeside = 1.75;
    Point at = grid.middleOf(cell);
    for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] += kBeside * grid.cellSize() * along[axis];
    return grid.cellOf(at);
}

// Of each cell what an eye sees of it, more of what is inside of something; 0 where something
// stands before it.
std::vector<double> seenFrom(const OccupancyGrid& grid, const std::vector<Cell>& cells,
                             const Point& eye) {
    constexpr double kInside = 4;
    std::vector<double> areas(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Point at = grid.middleOf(cells[i]);
        Point along{eye[0] - at[0], eye[1] - at[1], eye[2] - at[2]};
        const double length =
            std::sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
        if (!(length > 0)) continue;
        for (double& part : along) part /= length;
        if (isFree(grid, cells[i], along))
            areas[i] = seenArea(grid, cells[i], along) *
                       (1 + kInside * shelter(grid, placeBefore(grid, cells[i], along)));
    }
    return areas;
}

// How much each of the views shows. What few of them show counts for more, as all of them share a
// cell: so a box that is open to one side is looked into, and not at its lid.
std::vector<double> shownBy(const std::vector<std::vector<double>>& views, std::size_t cells) {
    std::vector<double> sums(views.size());
    for (std::size_t cell = 0; cell < cells; ++cell) {
        double all = 0;
        for (const std::vector<double>& view : views) all += view[cell];
        for (std::size_t i = 0; all > 0 && i < views.size(); ++i)
            sums[i] += views[i][cell] * views[i][cell] / all;
    }
    return sums;
}

// Of the views along some of kDirections the one that shows most; 0 where there is none. Of two
// that show the same the first: rounding doesn't decide.
template <typename IsCandidate>
std::size_t mostShown(const std::vector<double>& shown, const IsCandidate& isCandidate) {
    constexpr double kClearly = 1.05;
    std::size_t best = 0;
    for (std::size_t i = 1; i < shown.size(); ++i)
        if (isCandidate(kDirections[i - 1]) && (best == 0 || shown[i] > kClearly * shown[best]))
            best = i;
    return best;
}

// Whether two directions are within 60 degrees.
bool isBeside(const Point& a, const Point& b) {
    const auto dot = [](const Point& u, const Point& v) {
        return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    };
    return dot(a, b) > 0.5 * std::sqrt(dot(a, a) * dot(b, b));
}

}  // namespace

std::optional<ViewPoint> betterView(const OccupancyGrid& grid, const OutsideView& view) {
    if (!(grid.cellSize() > 0)) return std::nullopt;
    const std::vector<Cell> cells = someCells(grid);
    if (cells.empty()) return std::nullopt;
    // Judged from as far as all of the bounds would be in the picture.
    std::vector<Point> eyes{view.frontEye};
    for (const Point& direction : kDirections)
        eyes.push_back(eyeFrom(direction, view.bounds, view.verticalFov, view.aspect));
    std::vector<std::vector<double>> areas;
    for (const Point& eye : eyes) areas.push_back(seenFrom(grid, cells, eye));
    const std::vector<double> shown = shownBy(areas, cells.size());
    const std::size_t best = mostShown(shown, [](const Point&) { return true; });
    if (shown.front() >= kGoodEnough * shown[best]) return std::nullopt;
    const Point& towards = kDirections[best - 1];
    const std::size_t straight = mostShown(
        shown, [&](const Point& other) { return other[1] == 0 && isBeside(towards, other); });
    const bool isStraight = straight != 0 && shown[straight] >= kGoodEnoughStraight * shown[best];
    return viewOf(cornersOf(grid, view.bounds), kDirections[(isStraight ? straight : best) - 1],
                  view.verticalFov, view.aspect);
}

namespace {

// Of the lowest layer of cells along an axis the surface that lies across it.
double levelArea(const OccupancyGrid& grid, std::size_t axis) {
    double sum = 0;
    const Cell& size = grid.size();
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    Cell cell{};
    cell[axis] = OccupancyGrid::kMargin;
    for (cell[u] = 0; cell[u] < size[u]; ++cell[u])
        for (cell[v] = 0; cell[v] < size[v]; ++cell[v])
            sum += static_cast<double>(grid.areaSeenFrom(2 * axis, cell)) +
                   static_cast<double>(grid.areaSeenFrom(2 * axis + 1, cell));
    return sum;
}

}  // namespace

bool standsOnZ(const OccupancyGrid& grid, const Bounds& bounds) {
    constexpr double kTimes = 4, kRises = 0.15, kOnPlane = 1e-3;
    const double longest = grid.cellSize() * OccupancyGrid::kCells;
    if (!(longest > 0) || std::abs(bounds.low[2]) > kOnPlane * longest) return false;
    if (bounds.high[2] - bounds.low[2] < kRises * longest) return false;
    return levelArea(grid, 2) > kTimes * levelArea(grid, 1);
}

}  // namespace pm::host
