// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scheduler/film/frame_error.h"

namespace pm::plugin {

// A render's error over time: after each of its first passes, then ever more seldom, and after its
// last one. Some 50 points for a million passes. A plain value.
class ErrorCurve {
  public:
    struct Point {
        std::uint32_t passes = 0;
        double seconds = 0;           // since the render was started
        double processorSeconds = 0;  // of the whole process, since then
        std::optional<FrameError> error;
    };

    // Whether a point after so many passes belongs to the curve.
    bool wants(std::uint32_t passes) const;
    // More passes than before.
    void add(const Point& point);
    const std::vector<Point>& points() const { return m_points; }

  private:
    std::vector<Point> m_points;
};

}  // namespace pm::plugin
