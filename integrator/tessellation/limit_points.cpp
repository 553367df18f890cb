// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/tessellation/limit_points.h"

#include <algorithm>
#include <cmath>

namespace pm {

namespace {

// Below these ratios a tangent is rounding noise.
constexpr double kLeastRatio = 1e-7;

Vec3d unitOrZero(const Vec3d& v) {
    const double size = length(v);
    return size > 0 && std::isfinite(size) ? v / size : Vec3d(0.0);
}

}  // namespace

const LimitSurface::Evaluator& LimitPoints::evaluator(std::uint32_t face) {
    const auto found = m_evaluators.find(face);
    if (found != m_evaluators.end()) return found->second;
    LimitSurface::Evaluator made(m_placed.shape.surface());
    made.select(face);
    return m_evaluators.emplace(face, std::move(made)).first->second;
}

void LimitPoints::select(std::uint32_t face) {
    m_face = face;
    m_placed.shape.surface().listCorners(face, m_corners);
    m_rates.clear();
    for (const LimitSurface::FaceCorner& corner : m_corners)
        m_rates.push_back(m_placed.rates[corner.edge]);
    m_step = 0.5 / *std::ranges::max_element(m_rates);
}

Vec3d LimitPoints::turned(const Vec3d& v) const {
    const Transform& m = m_placed.toScene;
    return {dot(row(m, 0), v), dot(row(m, 1), v), dot(row(m, 2), v)};
}

Vec3d LimitPoints::frontNormal(const Vec3d& tangentU, const Vec3d& tangentV) const {
    const double lengthU = length(tangentU), lengthV = length(tangentV);
    const Vec3d normal = cross(tangentU, tangentV);
    const double size = length(normal);
    const bool isGood = std::min(lengthU, lengthV) > kLeastRatio * std::max(lengthU, lengthV) &&
                        size > kLeastRatio * lengthU * lengthV && std::isfinite(size);
    if (!isGood) return Vec3d(0.0);
    return normal / (determinant(m_placed.toScene) < 0 ? -size : size);
}

LimitPoints::Frame LimitPoints::frame(std::uint32_t face, const UV& uv) {
    const LimitSurface::ChartSample s = evaluator(face).evaluateChart(uv);
    Frame frame{transformPoint(m_placed.toScene, s.position),
                turned(s.tangentU),
                turned(s.tangentV),
                {},
                s.texcoord,
                s.alongU,
                s.alongV};
    frame.normal = frontNormal(frame.tangentU, frame.tangentV);
    if (frame.normal == Vec3d(0.0)) frame.normal = normalAt(face, uv);
    return frame;
}

// Where the surface has none, that of a place close by in the face.
Vec3d LimitPoints::normalAt(std::uint32_t face, const UV& uv) {
    const UV middle = middleOfFace(m_placed.shape.cage().scheme, sizeOf(face));
    for (const double share : {1e-4, 1e-2, 0.5}) {
        const UV near{uv[0] + (middle[0] - uv[0]) * share, uv[1] + (middle[1] - uv[1]) * share};
        const LimitSurface::ChartSample s = evaluator(face).evaluateChart(near);
        const Vec3d normal = frontNormal(turned(s.tangentU), turned(s.tangentV));
        if (!(normal == Vec3d(0.0))) return normal;
    }
    return Vec3d(0.0);
}

Vec3d LimitPoints::displaced(std::uint32_t face, const UV& uv) {
    const Frame at = frame(face, uv);
    const HeightField* const heights = m_placed.heightsOf(face);
    return heights ? at.position + at.normal * heights->at(at.texcoord) : at.position;
}

Vec3d LimitPoints::positionOnEdge(const PatternPoint& point) {
    const LimitShape& shape = m_placed.shape;
    const LimitSurface::FaceCorner& corner = m_corners[point.edge];
    const bool isVertex = point.step == 0;
    const LimitShape::Owner owner =
        isVertex ? shape.ownerOfVertex(corner.vertex) : shape.ownerOfEdge(corner.edge);
    double share = 0.0;
    if (!isVertex) {
        const auto rate = static_cast<std::uint32_t>(m_rates[point.edge]);
        // The same step seen from either end.
        const bool isAlong = owner.forwards == corner.forwards;
        share = static_cast<double>(isAlong ? point.step : rate - point.step) / rate;
    }
    const UV uv = pointOfEdge(shape.cage().scheme, sizeOf(owner.face), owner.corner, share);
    return displaced(owner.face, uv);
}

// Of what is displaced: the heights' slopes lean the limit's own tangents.
Vec3f LimitPoints::shadingNormal(const Frame& at) const {
    const HeightField* const heights = m_placed.heightsOf(m_face);
    if (!heights) return Vec3f(at.normal);
    const auto slope = [&](const UV& along) {
        const UV after{at.texcoord[0] + along[0] * m_step, at.texcoord[1] + along[1] * m_step},
            before{at.texcoord[0] - along[0] * m_step, at.texcoord[1] - along[1] * m_step};
        return (heights->at(after) - heights->at(before)) / (2 * m_step);
    };
    const Vec3d normal = frontNormal(at.tangentU + at.normal * slope(at.alongU),
                                     at.tangentV + at.normal * slope(at.alongV));
    return Vec3f(normal == Vec3d(0.0) ? at.normal : normal);
}

TriangleGroup::Point LimitPoints::point(const PatternPoint& asked) {
    const Frame at = frame(m_face, asked.uv);
    TriangleGroup::Point point;
    point.normal = shadingNormal(at);
    point.texcoord = {static_cast<float>(at.texcoord[0]), static_cast<float>(at.texcoord[1])};
    // Along u of the texture, by the inverse of how it changes.
    const double size = at.alongU[0] * at.alongV[1] - at.alongU[1] * at.alongV[0];
    if (size != 0.0)
        point.tangent = Vec3f(unitOrZero((at.tangentU * at.alongV[1] - at.tangentV * at.alongU[1]) *
                                         (size < 0 ? -1.0 : 1.0)));
    if (asked.edge != PatternPoint::kInside) {
        point.position = Vec3f(positionOnEdge(asked));
    } else {
        const HeightField* const heights = m_placed.heightsOf(m_face);
        point.position =
            Vec3f(heights ? at.position + at.normal * heights->at(at.texcoord) : at.position);
    }
    return point;
}

Vec3d LimitPoints::limitPosition(const UV& uv) {
    return transformPoint(m_placed.toScene, evaluator(m_face).evaluateChart(uv).position);
}

// A box in object space, turned.
Box3d LimitPoints::hull() {
    const Box3d own = evaluator(m_face).hull();
    Box3d box;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const Vec3d p = transformPoint(m_placed.toScene, {(corner & 1) != 0 ? own.hi.x : own.lo.x,
                                                          (corner & 2) != 0 ? own.hi.y : own.lo.y,
                                                          (corner & 4) != 0 ? own.hi.z : own.lo.z});
        box.grow({p, p});
    }
    return box;
}

bool LimitPoints::isBicubic() {
    return evaluator(m_face).isBicubic();
}

}  // namespace pm
