// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/look/room_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pm::host {
namespace {

using Point = std::array<double, 3>;

// The 26 directions to a cell's neighbours.
constexpr int kDirections = 26;
// A cell is within something where half of these end at a surface, and the space of such cells is
// closed where nearly all of all cells' do: it may have windows, or a door, but no side that is
// open (of a cube without one side a sixth is open). One doesn't stand where a fifth is open.
constexpr int kWithin = 13;
constexpr double kClosedShare = 0.94;
constexpr int kStanding = 21;
// Of the bounds' cells.
constexpr double kLeastShare = 0.15;
constexpr double kMostly = 0.6;
// Of the columns of cells through the bounds; a box's meet surface.
constexpr double kBoxShare = 0.9;
// Directions that are looked along.
constexpr int kViews = 64;

// Work over the cells of a grid, in the order of their indices.
template <typename Visit>
void forEachCell(const OccupancyGrid& grid, const Visit& visit) {
    const Cell& size = grid.size();
    Cell cell{};
    std::size_t index = 0;
    for (cell[2] = 0; cell[2] < size[2]; ++cell[2])
        for (cell[1] = 0; cell[1] < size[1]; ++cell[1])
            for (cell[0] = 0; cell[0] < size[0]; ++cell[0]) visit(cell, index++);
}

Cell moved(const Cell& cell, const Cell& by) {
    return {cell[0] + by[0], cell[1] + by[1], cell[2] + by[2]};
}

// Where along a direction, from each cell, a surface is met before the bounds end: counted over
// all directions.
std::vector<std::uint8_t> countBlocked(const OccupancyGrid& grid) {
    const Cell& size = grid.size();
    std::vector<std::uint8_t> count(grid.count());
    std::vector<std::uint8_t> blocked(grid.count());
    for (int code = 0; code < 27; ++code) {
        const Cell by{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
        if (by == Cell{}) continue;
        // From the side that the direction goes to, so that the next cell is known.
        const auto at = [&](int i, std::size_t axis) {
            return by[axis] > 0 ? size[axis] - 1 - i : i;
        };
        for (int k = 0; k < size[2]; ++k) {
            for (int j = 0; j < size[1]; ++j) {
                for (int i = 0; i < size[0]; ++i) {
                    const Cell cell{at(i, 0), at(j, 1), at(k, 2)};
                    const Cell next = moved(cell, by);
                    const std::size_t index = grid.indexOf(cell);
                    blocked[index] = grid.contains(next) &&
                                             (grid.holds(next) || blocked[grid.indexOf(next)] != 0)
                                         ? 1
                                         : 0;
                    count[index] = static_cast<std::uint8_t>(count[index] + blocked[index]);
                }
            }
        }
    }
    return count;
}

constexpr std::array<Cell, 6> kNeighbours{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// The largest space that is within something.
struct Space {
    std::vector<std::uint8_t> isIn;        // 1: of it
    std::vector<std::uint8_t> isStanding;  // 1: of it, and well within
    std::size_t cells{};
    double closedShare{};  // of the directions from its cells
};

Space largestSpaceWithin(const OccupancyGrid& grid) {
    const std::vector<std::uint8_t> blocked = countBlocked(grid);
    std::vector<std::uint32_t> label(grid.count());
    std::uint32_t labels = 0, best = 0;
    std::size_t most = 0;
    std::vector<Cell> open;
    const auto take = [&](const Cell& cell) {
        if (!grid.contains(cell) || grid.holds(cell)) return;
        std::uint32_t& here = label[grid.indexOf(cell)];
        if (here != 0 || blocked[grid.indexOf(cell)] < kWithin) return;
        here = labels;
        open.push_back(cell);
    };
    forEachCell(grid, [&](const Cell& start, std::size_t index) {
        if (label[index] != 0) return;
        ++labels;
        take(start);
        std::size_t cells = 0;
        while (!open.empty()) {
            const Cell cell = open.back();
            open.pop_back();
            ++cells;
            for (const Cell& by : kNeighbours) take(moved(cell, by));
        }
        if (cells > most) {
            most = cells;
            best = labels;
        }
    });
    Space space{std::vector<std::uint8_t>(grid.count()), std::vector<std::uint8_t>(grid.count()),
                most, 0};
    if (most == 0) return space;
    double closed = 0;
    for (std::size_t i = 0; i < label.size(); ++i) {
        if (label[i] != best) continue;
        space.isIn[i] = 1;
        space.isStanding[i] = blocked[i] >= kStanding;
        closed += blocked[i];
    }
    space.closedShare = closed / (kDirections * static_cast<double>(most));
    return space;
}

// The side of a neighbour from which a cell is seen that lies in this direction.
constexpr std::array<std::size_t, 6> kSeenFrom{1, 0, 3, 2, 5, 4};

struct Faces {
    double fronts{}, all{};
    void count(const OccupancyGrid& grid, const Cell& cell, std::size_t direction) {
        const float front = grid.areaSeenFrom(kSeenFrom[direction], cell);
        const float back = grid.areaSeenFrom(direction, cell);
        if (!(front + back > 0)) return;
        ++all;
        // Both sides of a thin wall are in one cell; then the front is what is seen.
        if (front >= back / 4) ++fronts;
    }
    double share() const { return all > 0 ? fronts / all : 0; }
};

Faces seenFromInside(const OccupancyGrid& grid, const Space& space) {
    Faces faces;
    forEachCell(grid, [&](const Cell& cell, std::size_t index) {
        if (space.isIn[index] == 0) return;
        for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
            const Cell next = moved(cell, kNeighbours[d]);
            if (grid.contains(next) && grid.holds(next)) faces.count(grid, next, d);
        }
    });
    return faces;
}

struct Outside {
    Faces faces;
    double columns{}, hits{};
};

// Along each column of cells from each side, as far as the first that holds surface.
Outside seenFromOutside(const OccupancyGrid& grid) {
    Outside outside;
    const Cell& size = grid.size();
    for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
        const std::size_t axis = d / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = OccupancyGrid::kMargin; i < size[u] - OccupancyGrid::kMargin; ++i) {
            for (int j = OccupancyGrid::kMargin; j < size[v] - OccupancyGrid::kMargin; ++j) {
                Cell cell{};
                cell[u] = i;
                cell[v] = j;
                cell[axis] = d % 2 == 0 ? size[axis] - 1 : 0;
                while (grid.contains(cell) && !grid.holds(cell)) cell = moved(cell, kNeighbours[d]);
                ++outside.columns;
                if (!grid.contains(cell)) continue;
                ++outside.hits;
                outside.faces.count(grid, cell, d);
            }
        }
    }
    return outside;
}

// How much of the lamps' area shines into the space.
double lampShare(const OccupancyGrid& grid, const Space& space) {
    double inside = 0, all = 0;
    for (const OccupancyGrid::Lamp& lamp : grid.lamps()) {
        for (std::size_t d = 0; d < kNeighbours.size(); ++d) {
            const double area = static_cast<double>(lamp.areas[d]);
            all += area;
            // A lamp lies close below a ceiling, in one cell with it or two.
            Cell next = moved(lamp.cell, kNeighbours[d]);
            if (grid.contains(next) && grid.holds(next)) next = moved(next, kNeighbours[d]);
            if (grid.contains(next) && space.isIn[grid.indexOf(next)] != 0) inside += area;
        }
    }
    return all > 0 ? inside / all : 0;
}

bool isRoom(const OccupancyGrid& grid, const Space& space) {
    const Cell& size = grid.size();
    double bounds = 1;
    for (const int side : size) bounds *= side - 2 * OccupancyGrid::kMargin;
    if (space.closedShare < kClosedShare) return false;
    if (static_cast<double>(space.cells) < kLeastShare * bounds) return false;
    const double lit = lampShare(grid, space);
    if (lit > kMostly) return true;
    if (seenFromInside(grid, space).share() < kMostly) return false;
    const Outside outside = seenFromOutside(grid);
    if (outside.faces.share() < 1 - kMostly) return true;
    return (grid.lamps().empty() || lit > 0) && outside.hits >= kBoxShare * outside.columns;
}

// Of each cell the number of steps to the nearest that is not in the space (of 3 along an axis, 4
// and 5 along diagonals: within some per cent of Euclid's).
std::vector<std::int32_t> distances(const OccupancyGrid& grid, const Space& space) {
    constexpr std::int32_t kFar = 1 << 20;
    std::vector<std::int32_t> distance(grid.count());
    for (std::size_t i = 0; i < distance.size(); ++i)
        distance[i] = space.isStanding[i] != 0 ? kFar : 0;
    const Cell& size = grid.size();
    for (const int towards : {-1, 1}) {
        const auto at = [&](int i, std::size_t axis) {
            return towards < 0 ? i : size[axis] - 1 - i;
        };
        for (int k = 0; k < size[2]; ++k) {
            for (int j = 0; j < size[1]; ++j) {
                for (int i = 0; i < size[0]; ++i) {
                    const Cell cell{at(i, 0), at(j, 1), at(k, 2)};
                    std::int32_t& here = distance[grid.indexOf(cell)];
                    if (here == 0) continue;
                    for (int code = 0; code < 13; ++code) {
                        const Cell by{towards * (1 - code % 3), towards * (1 - code / 3 % 3),
                                      towards * (1 - code / 9)};
                        const Cell next = moved(cell, by);
                        const std::int32_t step =
                            2 + std::abs(by[0]) + std::abs(by[1]) + std::abs(by[2]);
                        const std::int32_t there =
                            grid.contains(next) ? distance[grid.indexOf(next)] : 0;
                        here = std::min(here, there + step);
                    }
                }
            }
        }
    }
    return distance;
}

// The widest place; of several the one nearest to their middle.
Cell widestPlace(const OccupancyGrid& grid, const std::vector<std::int32_t>& distance) {
    const std::int32_t most = *std::ranges::max_element(distance);
    Point middle{};
    double count = 0;
    forEachCell(grid, [&](const Cell& cell, std::size_t index) {
        if (distance[index] != most) return;
        ++count;
        for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += cell[axis];
    });
    Cell best{};
    double nearest = 0;
    bool isFirst = true;
    forEachCell(grid, [&](const Cell& cell, std::size_t index) {
        if (distance[index] != most) return;
        double squared = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double off = cell[axis] - middle[axis] / count;
            squared += off * off;
        }
        if (!isFirst && squared >= nearest) return;
        isFirst = false;
        nearest = squared;
        best = cell;
    });
    return best;
}

// How many cells far one can go from a place before a cell is none that `isFree`.
template <typename IsFree>
double freeCells(const OccupancyGrid& grid, const Point& from, const Point& along,
                 const IsFree& isFree) {
    constexpr double kStep = 0.25;
    for (double gone = kStep;; gone += kStep) {
        Point at = from;
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] += gone * grid.cellSize() * along[axis];
        const Cell cell = grid.cellOf(at);
        if (!grid.contains(cell) || !isFree(cell)) return gone - kStep;
    }
}

// Around a square, from -z on: without functions that differ from processor to processor.
Point levelDirection(int view) {
    constexpr int kSide = kViews / 4;
    const int turned = (view + kSide / 2) % kViews;
    const double across = 2.0 * (turned % kSide) / kSide - 1;
    Point along{across, 0, -1};
    for (int i = 0; i < turned / kSide; ++i) along = {-along[2], 0, along[0]};
    const double length = std::sqrt(along[0] * along[0] + along[2] * along[2]);
    for (double& part : along) part /= length;
    return along;
}

}  // namespace

bool isClosedAround(const OccupancyGrid& grid, const std::array<double, 3>& place) {
    if (!(grid.cellSize() > 0)) return false;
    const auto isEmpty = [&](const Cell& cell) { return !grid.holds(cell); };
    int open = 0;
    for (int code = 0; code < 27; ++code) {
        const Cell by{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
        if (by == Cell{}) continue;
        Cell cell = grid.cellOf(place);
        if (!grid.contains(cell)) return false;
        do {
            cell = moved(cell, by);
        } while (grid.contains(cell) && isEmpty(cell));
        if (!grid.contains(cell)) ++open;
    }
    return open <= 1;
}

std::optional<ViewPoint> viewOfRoom(const OccupancyGrid& grid) {
    const Space space = largestSpaceWithin(grid);
    if (space.cells == 0 || !isRoom(grid, space)) return std::nullopt;
    const std::vector<std::int32_t> distance = distances(grid, space);
    const Cell widest = widestPlace(grid, distance);
    const Point place = grid.middleOf(widest);
    // Half as wide is no doorway yet.
    const std::int32_t wide = distance[grid.indexOf(widest)] / 2;
    const auto isEmpty = [&](const Cell& cell) { return !grid.holds(cell); };
    const auto isWide = [&](const Cell& cell) { return distance[grid.indexOf(cell)] >= wide; };
    Point best{};
    double longest = 0, behind = 0;
    for (int i = 0; i < kViews; ++i) {
        const Point along = levelDirection(i);
        const double free = freeCells(grid, place, {-along[0], 0, -along[2]}, isWide);
        const double view = freeCells(grid, place, along, isEmpty) + free;
        constexpr double kClearlyLonger = 1.01;
        if (!(view > kClearlyLonger * longest)) continue;
        longest = view;
        best = along;
        behind = free;
    }
    ViewPoint view;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        view.eye[axis] = place[axis] - behind * grid.cellSize() * best[axis];
        view.lookAt[axis] = view.eye[axis] + longest * grid.cellSize() * best[axis];
    }
    return view;
}

}  // namespace pm::host
