// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_centre.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pm::host {

namespace {

// What lies together is at least so many times less wide than all.
constexpr double kTimes = 4096;
// Less of the width than this, empty at a stretch, doesn't part what lies together.
constexpr double kLeastGap = 0.25;
constexpr std::size_t kBins = 4096;

std::size_t widestAxis(const Bounds& b) {
    std::size_t widest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
        if (b.high[axis] - b.low[axis] > b.high[widest] - b.low[widest]) widest = axis;
    return widest;
}

double widthOf(const Bounds& b) {
    const std::size_t axis = widestAxis(b);
    return b.high[axis] - b.low[axis];
}

// Two parts of some faces, on either side of the longest stretch without any.
struct Parts {
    Bounds bounds[2];
    std::uint64_t counts[2] = {0, 0};

    static Bounds nothing() {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    }
    void add(const Bounds& face, std::size_t side) {
        ++counts[side];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            bounds[side].low[axis] = std::min(bounds[side].low[axis], face.low[axis]);
            bounds[side].high[axis] = std::max(bounds[side].high[axis], face.high[axis]);
        }
    }
};

// Within the bounds, and no wider than `most`: what is wider is no part of what lies together.
template <typename Visit>
void forEachIn(const EachFace& forEachFace, const Bounds& bounds, double most, const Visit& visit) {
    forEachFace([&](const Bounds& face) {
        if (widthOf(face) > most) return;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (face.low[axis] < bounds.low[axis] || face.high[axis] > bounds.high[axis]) return;
        visit(face);
    });
}

// Nothing where they lie together.
std::optional<Parts> divide(const EachFace& forEachFace, const Bounds& bounds, double most) {
    const std::size_t axis = widestAxis(bounds);
    const double low = bounds.low[axis], scale = kBins / widthOf(bounds);
    std::vector<bool> holds(kBins);
    const auto binOf = [&](double at) {
        return std::min(static_cast<std::size_t>(std::max(0.0, (at - low) * scale)), kBins - 1);
    };
    forEachIn(forEachFace, bounds, most, [&](const Bounds& face) {
        for (std::size_t i = binOf(face.low[axis]); i <= binOf(face.high[axis]); ++i)
            holds[i] = true;
    });
    std::size_t gap = 0, length = 0;
    for (std::size_t i = 0, begin = 0; i < kBins; ++i) {
        if (holds[i]) {
            begin = i + 1;
        } else if (i + 1 - begin > length) {
            gap = begin;
            length = i + 1 - begin;
        }
    }
    if (static_cast<double>(length) < kLeastGap * kBins) return {};
    const double middle =
        low + (static_cast<double>(gap) + 0.5 * static_cast<double>(length)) / scale;
    Parts parts{{Parts::nothing(), Parts::nothing()}};
    forEachIn(forEachFace, bounds, most,
              [&](const Bounds& face) { parts.add(face, face.low[axis] < middle ? 0 : 1); });
    return parts;
}

double distanceSquared(const Bounds& bounds, const std::array<double, 3>& place) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double off =
            std::max({0.0, bounds.low[axis] - place[axis], place[axis] - bounds.high[axis]});
        sum += off * off;
    }
    return sum;
}

}  // namespace

std::array<double, 3> centreFor(const EachFace& forEachFace, const Bounds& bounds,
                                const std::optional<std::array<double, 3>>& eye) {
    const double most = widthOf(bounds) / kTimes;
    Parts all{{Parts::nothing(), Parts::nothing()}};
    forEachIn(forEachFace, bounds, most, [&](const Bounds& face) { all.add(face, 0); });
    if (all.counts[0] == 0) return bounds.centre();
    Bounds part = all.bounds[0];
    while (widthOf(part) > most) {
        const auto parts = divide(forEachFace, part, most);
        if (!parts) return bounds.centre();
        const bool isSecond =
            eye ? distanceSquared(parts->bounds[1], *eye) < distanceSquared(parts->bounds[0], *eye)
                : parts->counts[1] > parts->counts[0];
        part = parts->bounds[isSecond ? 1 : 0];
    }
    return part.centre();
}

}  // namespace pm::host
