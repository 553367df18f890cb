// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/scene_core.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pm {

namespace {

constexpr std::size_t kBins = 4096;
// Where less of the width than this is empty at a stretch, what lies there lies together.
constexpr double kLeastGap = 0.25;
// A ground is at least so wide, over the whole.
constexpr double kLeastGround = 0.25;

// How much begins in, and whether something covers, each bin of an axis.
class Bins {
  public:
    Bins(double begin, double end) : m_begin(begin), m_scale(kBins / (end - begin)) {}

    void add(double lo, double hi) {
        const std::size_t first = binOf(lo), last = binOf(hi);
        ++m_counts[first];
        for (std::size_t i = first; i <= last; ++i) m_covered[i] = true;
    }

    // The longest stretch without anything: its first bin, and how many.
    std::pair<std::size_t, std::size_t> longestGap() const {
        std::size_t best = 0, length = 0, begin = 0;
        for (std::size_t i = 0; i < kBins; ++i) {
            if (m_covered[i])
                begin = i + 1;
            else if (i + 1 - begin > length) {
                best = begin;
                length = i + 1 - begin;
            }
        }
        return {best, length};
    }
    std::uint64_t countBefore(std::size_t bin) const {
        std::uint64_t count = 0;
        for (std::size_t i = 0; i < bin; ++i) count += m_counts[i];
        return count;
    }
    double beginOf(std::size_t bin) const { return m_begin + static_cast<double>(bin) / m_scale; }

  private:
    std::size_t binOf(double at) const {
        return static_cast<std::size_t>(
            std::clamp((at - m_begin) * m_scale, 0.0, static_cast<double>(kBins - 1)));
    }

    double m_begin, m_scale;
    std::vector<std::uint64_t> m_counts = std::vector<std::uint64_t>(kBins);
    std::vector<bool> m_covered = std::vector<bool>(kBins);
};

int widestAxis(const Vec3d& size) {
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

// How far a place is from a box.
double distanceTo(const Box3d& box, const Vec3d& place) {
    Vec3d off;
    for (int axis = 0; axis < 3; ++axis)
        off[axis] = std::max({0.0, box.lo[axis] - place[axis], place[axis] - box.hi[axis]});
    return length(off);
}

}  // namespace

std::optional<Box3d> findCore(const Box3d& whole, const EachBox& forEachBox,
                              const std::optional<Vec3d>& eye) {
    const double most = maxAbsComponent(whole.size()) / kCoreTimes;
    Box3d part;
    const auto forEachSmall = [&](const auto& visit) {
        forEachBox([&](const Box3d& box) {
            if (maxAbsComponent(box.size()) <= most) visit(box);
        });
    };
    forEachSmall([&](const Box3d& box) { part.grow(box); });
    if (part.empty()) return {};
    // What is neither small nor a ground is a part of the scene that no core would hold.
    bool hasOthers = false;
    forEachBox([&](const Box3d& box) {
        const double size = maxAbsComponent(box.size());
        hasOthers = hasOthers || (size > most && size < kLeastGround * kCoreTimes * most);
    });
    if (hasOthers) return {};
    while (maxAbsComponent(part.size()) > most) {
        const int axis = widestAxis(part.size());
        const auto isIn = [&](const Box3d& box) {
            for (int i = 0; i < 3; ++i)
                if (box.lo[i] < part.lo[i] || box.hi[i] > part.hi[i]) return false;
            return true;
        };
        Bins bins(part.lo[axis], part.hi[axis]);
        std::uint64_t all = 0;
        forEachSmall([&](const Box3d& box) {
            if (!isIn(box)) return;
            bins.add(box.lo[axis], box.hi[axis]);
            ++all;
        });
        const auto [gap, length] = bins.longestGap();
        if (static_cast<double>(length) < kLeastGap * kBins) return {};
        const double middle = bins.beginOf(gap + length / 2);
        Box3d below, above;
        forEachSmall([&](const Box3d& box) {
            if (isIn(box)) (box.lo[axis] < middle ? below : above).grow(box);
        });
        const std::uint64_t countBelow = bins.countBefore(gap);
        double preference = static_cast<double>(countBelow) - static_cast<double>(all - countBelow);
        if (eye) preference = distanceTo(above, *eye) - distanceTo(below, *eye);
        part = preference >= 0 ? below : above;
    }
    return part;
}

}  // namespace pm
