// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The limit surface of a cage, face by face: the only header that stands for OpenSubdiv, and it
// shows nothing of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/geometry/subdivision.h"
#include "integrator/values/box.h"
#include "integrator/values/vec.h"

namespace pm {

// How a face of a given size is sampled. The points on its boundary come first: vertex 0, the
// points of edge 0, vertex 1 and so on.
struct SamplePattern {
    std::vector<double> coords;  // pairs (u, v)
    std::vector<TriangleMesh::Corners> facets;
    std::uint32_t boundaryPoints = 0;

    std::uint32_t pointCount() const { return static_cast<std::uint32_t>(coords.size() / 2); }
};

// The uniform pattern of a face of `faceSize` corners whose edges are cut into `rate` pieces.
SamplePattern makeSamplePattern(SubdivisionScheme scheme, std::uint32_t faceSize, int rate);

// Connects a cage and prepares its evaluation. Constant once built: any number of threads may each
// use an Evaluator of their own on it. The cage must outlive it.
class LimitSurface {
  public:
    // One corner of a face and the edge from there to the next corner.
    struct FaceCorner {
        std::uint32_t vertex = 0;
        std::uint32_t edge = 0;
        bool forwards = true;  // whether the face runs along the edge in the edge's own direction
    };

    // A point of the surface. Tangents along u and v, whose cross product points to the front.
    struct Sample {
        Vec3d position, tangentU, tangentV;
        Vec2f texcoord;  // (0, 0) without texture coordinates
    };

    // The same with what texture coordinates change by along u and v; zeros without any.
    struct ChartSample {
        Vec3d position, tangentU, tangentV;
        std::array<double, 2> texcoord{}, alongU{}, alongV{};
    };

    class Evaluator {
      public:
        explicit Evaluator(const LimitSurface& surface);
        ~Evaluator();
        Evaluator(Evaluator&&) noexcept;
        Evaluator& operator=(Evaluator&&) = delete;
        // Turns to a face that has a surface; costs 14 to 140 us where it is irregular.
        void select(std::uint32_t face);
        // The point at (u, v), a pair of a SamplePattern, of the selected face.
        Sample evaluate(const double* uv) const;
        ChartSample evaluateChart(const std::array<double, 2>& uv) const;

        // Of the selected face: whether it is one bicubic patch, and a box that holds its surface.
        bool isBicubic() const;
        Box3d hull() const;

      private:
        struct State;
        std::unique_ptr<State> m_state;
    };

    // The cage must have passed validate(). Throws Error(kInvalidScene) for what OpenSubdiv
    // rejects.
    explicit LimitSurface(const SubdivisionCage& cage);
    ~LimitSurface();
    LimitSurface(const LimitSurface&) = delete;
    LimitSurface& operator=(const LimitSurface&) = delete;

    std::size_t edgeCount() const;
    // The two vertices of an edge, the lower one first.
    std::pair<std::uint32_t, std::uint32_t> edge(std::uint32_t index) const;
    // False for holes, and for faces at a boundary that is not interpolated.
    bool hasSurface(std::uint32_t face) const;
    bool hasTexcoords() const;
    void listCorners(std::uint32_t face, std::vector<FaceCorner>& corners) const;
    // Creases given for pairs of vertices that are no edge.
    std::size_t ignoredCreases() const;
    // Vertices of two faces that had to be made sharp.
    std::size_t openedVertices() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace pm
