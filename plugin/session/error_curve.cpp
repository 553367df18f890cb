// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/error_curve.h"

namespace pm::plugin {

namespace {
constexpr std::uint32_t kEveryPass = 16;     // up to here
constexpr double kStep = 1.414213562373095;  // from there on, as a factor
}  // namespace

bool ErrorCurve::wants(std::uint32_t passes) const {
    return passes <= kEveryPass || m_points.empty() || passes >= kStep * m_points.back().passes;
}

void ErrorCurve::add(const Point& point) {
    m_points.push_back(point);
}

}  // namespace pm::plugin
