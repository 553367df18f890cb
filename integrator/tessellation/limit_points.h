// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "integrator/geometry/face_pattern.h"
#include "integrator/geometry/limit_shape.h"
#include "integrator/tessellation/height_field.h"
#include "integrator/tessellation/triangle_group.h"
#include "integrator/values/transform.h"

namespace pm {

// A limit surface that stands in a scene, displaced.
struct PlacedLimit {
    const LimitShape& shape;
    Transform toScene;                        // object to the scene's own coordinates
    std::vector<const HeightField*> heights;  // of each slot of the cage; null: none
    std::vector<std::uint16_t> rates;         // of each edge

    // Of the slot of a face.
    const HeightField* heightsOf(std::uint32_t face) const {
        const auto& slots = shape.cage().mesh.faceMaterials;
        return heights.empty() ? nullptr : heights[slots.empty() ? 0 : slots[face]];
    }
};

// Evaluates points of it. A point of an edge or vertex is where its owner says, displaced by the
// owner's height along the owner's normal, whoever asks: neighbours have the same bits there. Keeps
// what it has prepared of faces. One thread.
class LimitPoints {
  public:
    using UV = std::array<double, 2>;

    explicit LimitPoints(const PlacedLimit& placed) : m_placed(placed) {}

    // Turns to a face that has a surface, whose points are asked for.
    void select(std::uint32_t face);
    // The pieces of its edges.
    EdgeRates rates() const { return m_rates; }
    TriangleGroup::Point point(const PatternPoint& point);
    // Not displaced, nor as its owner says.
    Vec3d limitPosition(const UV& uv);
    // Of that: a box that holds all of the selected face; whether it is a bicubic patch.
    Box3d hull();
    bool isBicubic();

  private:
    struct Frame {
        Vec3d position, tangentU, tangentV;  // scene's own coordinates
        Vec3d normal;                        // unit, out of the front; 0: there is none
        std::array<double, 2> texcoord, alongU, alongV;
    };
    const LimitSurface::Evaluator& evaluator(std::uint32_t face);
    std::uint32_t sizeOf(std::uint32_t face) const {
        return m_placed.shape.cage().mesh.faceVertexCounts[face];
    }
    Frame frame(std::uint32_t face, const UV& uv);
    Vec3d normalAt(std::uint32_t face, const UV& uv);
    Vec3d turned(const Vec3d& objectVector) const;
    Vec3d frontNormal(const Vec3d& tangentU, const Vec3d& tangentV) const;
    Vec3d displaced(std::uint32_t face, const UV& uv);
    Vec3d positionOnEdge(const PatternPoint& point);
    Vec3f shadingNormal(const Frame& frame) const;

    const PlacedLimit& m_placed;
    std::unordered_map<std::uint32_t, LimitSurface::Evaluator> m_evaluators;
    std::uint32_t m_face = 0;
    std::vector<LimitSurface::FaceCorner> m_corners;
    std::vector<int> m_rates;
    double m_step = 0;  // of the selected face's parameters: half a piece
};

}  // namespace pm
