// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/trace_order.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "integrator/values/morton.h"

namespace pm {

namespace {

constexpr double kCells = 1024.0;  // along each axis

}  // namespace

// The Morton code of the point where the photon's first ray leaves the box.
std::uint32_t TraceOrder::keyOf(std::uint64_t index) const {
    const std::optional<Ray> ray = m_walk.firstRay(index);
    if (!ray) return 0;
    const Vec3d& half = m_scene.halfSize();
    const Vec3d origin(ray->origin), direction(ray->direction);
    double way = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0.0)
            way = std::min(
                way, (std::copysign(half[axis], direction[axis]) - origin[axis]) / direction[axis]);
    if (!std::isfinite(way)) return 0;
    std::array<std::uint32_t, 3> cells;
    for (int axis = 0; axis < 3; ++axis) {
        const double place = (origin[axis] + way * direction[axis]) / half[axis];
        // A flat scene has no extent along one axis.
        const double cell = std::isfinite(place) ? kCells * 0.5 * (place + 1.0) : 0.0;
        cells[static_cast<std::size_t>(2 - axis)] =
            static_cast<std::uint32_t>(std::clamp(cell, 0.0, kCells - 1.0));
    }
    return static_cast<std::uint32_t>(mortonKey(cells));
}

std::uint64_t TraceOrder::enter(std::uint64_t position, const CancelCheck& cancel) {
    if (!m_scene.groupCache()) return m_count;
    if (position >= m_begin && position < m_end) return m_end;
    m_begin = position / kWindow * kWindow;
    m_end = std::min(m_begin + kWindow, m_count);
    m_window.resize(m_end - m_begin);
    constexpr std::size_t kAtOnce = 1 << 14;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, m_window.size(), kAtOnce),
        [&](const tbb::blocked_range<std::size_t>& some) {
            cancel.throwIfSet("tracing photons");
            for (std::size_t i = some.begin(); i < some.end(); ++i)
                m_window[i] = {keyOf(m_begin + i), static_cast<std::uint32_t>(m_begin + i)};
        });
    tbb::parallel_sort(m_window);
    return m_end;
}

}  // namespace pm
