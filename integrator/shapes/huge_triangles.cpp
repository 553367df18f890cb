// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/huge_triangles.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace pm {

namespace {

void grow(Vec3d& lo, Vec3d& hi, const Vec3d& otherLo, const Vec3d& otherHi) {
    for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], otherLo[axis]);
        hi[axis] = std::max(hi[axis], otherHi[axis]);
    }
}

}  // namespace

void HugeTriangles::addSize(double size) {
    if (m_largest.size() == kMost) {
        if (!(size > m_largest.front())) return;
        std::ranges::pop_heap(m_largest, std::greater<>());
        m_largest.pop_back();
    }
    m_largest.push_back(size);
    std::ranges::push_heap(m_largest, std::greater<>());
}

void HugeTriangles::addBox(double size, const Vec3d& lo, const Vec3d& hi) {
    // Of several as large as the least of the largest all are among the others.
    if (m_largest.size() == kMost && !(size > m_largest.front()))
        grow(m_lo, m_hi, lo, hi);
    else
        m_large.push_back({size, lo, hi});
}

double HugeTriangles::mostNotHuge() const {
    std::vector<Large> large = m_large;
    std::ranges::sort(large, {}, &Large::size);
    Vec3d lo = m_lo, hi = m_hi;
    for (const Large& one : large) {
        const double width = lo.x <= hi.x ? length(hi - lo) : 0.0;
        // Points and what is nothing but them say nothing of what is small.
        if (width > 0 && one.size > kTimes * width) return kTimes * width;
        grow(lo, hi, one.lo, one.hi);
    }
    return std::numeric_limits<double>::infinity();
}

}  // namespace pm
