// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/tessellation/edge_rates.h"

#include <algorithm>
#include <cmath>

namespace pm {

namespace {

constexpr double kPi = 3.14159265358979323846;

double distanceToSegment(const Vec3d& point, const Vec3d& a, const Vec3d& b) {
    const Vec3d along = b - a;
    const double squared = lengthSquared(along);
    const double share = squared > 0 ? std::clamp(dot(point - a, along) / squared, 0.0, 1.0) : 0.0;
    return length(a + along * share - point);
}

// Whether a ball around the edge reaches into the cone of the picture.
bool isInPicture(const Viewpoint& view, const Vec3d& a, const Vec3d& b) {
    const Vec3d way = (a + b) * 0.5 - view.eye;
    const double distance = length(way), radius = length(b - a);
    if (distance <= radius) return true;
    const double angle = std::acos(std::clamp(dot(way, view.forward) / distance, -1.0, 1.0));
    return angle - std::asin(radius / distance) <= view.halfAngle;
}

double piecesOf(const Viewpoint& view, const Vec3d& a, const Vec3d& b) {
    constexpr double kOutOfPicture = 0.25;
    const double distance = distanceToSegment(view.eye, a, b), size = length(b - a);
    // Nothing is seen under more than half a turn.
    const double angle = distance > 0 ? std::min(size / distance, kPi) : kPi;
    return angle / view.radiansAPiece * (isInPicture(view, a, b) ? 1.0 : kOutOfPicture);
}

}  // namespace

std::vector<std::uint16_t> edgeRates(const LimitShape& shape, const Transform& toScene,
                                     const TessellationRule& rule, const CancelCheck& cancel) {
    const LimitSurface& surface = shape.surface();
    std::vector<std::uint16_t> rates(surface.edgeCount());
    constexpr std::uint32_t kBetweenLooks = 1 << 12;
    for (std::uint32_t edge = 0; edge < rates.size(); ++edge) {
        if (edge % kBetweenLooks == 0) cancel.throwIfSet("tessellating");
        double pieces = rule.rate > 0 ? rule.rate : shape.rate();
        if (rule.rate == 0 && rule.viewpoint) {
            const auto [a, b] = surface.edge(edge);
            const auto& positions = shape.cage().mesh.positions;
            pieces = piecesOf(*rule.viewpoint, transformPoint(toScene, Vec3d(positions[a])),
                              transformPoint(toScene, Vec3d(positions[b])));
        }
        const double most = shape.mostPieces(edge);
        rates[edge] = static_cast<std::uint16_t>(std::clamp(std::ceil(pieces), 1.0, most));
    }
    return rates;
}

}  // namespace pm
