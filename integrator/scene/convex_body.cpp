// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/convex_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "integrator/materials/material_description.h"

namespace pm {

namespace {

// Each corner is held against each plane.
constexpr std::uint64_t kMostTriangles = 10'000;

struct Triangle {
    std::array<Vec3d, 3> corners;
    bool shines = false;

    // To an edge, as at the poles of a ball made of quads.
    bool isCollapsed() const {
        return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    }
    Vec3d normal() const { return cross(corners[1] - corners[0], corners[2] - corners[0]); }
};

struct Ball {
    Vec3d centre;
    double radius;
    bool shines;
};

// A plane of the body, its unit normal outwards. tolerance: what rounding may do to what lies in
// it.
struct Plane {
    Vec3d normal;
    double distance, tolerance;

    double above(const Vec3d& p) const { return dot(normal, p) - distance; }
};

class Body {
  public:
    explicit Body(const Scene& scene) : m_scene(scene) {}

    bool isConvex() {
        if (!collect()) return false;
        if (m_balls.size() + (m_triangles.empty() ? 0 : 1) != 1) return false;
        return (m_triangles.empty() || (findPlanes() && isClosed())) && lightsAreOutside();
    }

  private:
    // False where something lets light through.
    bool collect() {
        const SceneDescription& description = m_scene.description();
        if (m_scene.hasInstances()) return false;
        for (std::uint32_t i = 0; i < description.instances.size(); ++i) {
            const InstanceDescription& instance = description.instances[i];
            const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&instance.shape);
            if (mesh ? !addMesh(instance, **mesh) : !addBall(i)) return false;
        }
        return true;
    }

    bool addBall(std::uint32_t index) {
        const MaterialTraits& material =
            m_scene.traits(m_scene.description().instances[index].materials[0]);
        if (material.isInvisible) return true;
        if (!material.isOpaque) return false;
        if (!m_scene.isSphere(index)) return false;
        const SphereShape sphere = m_scene.ballAround(index);
        const bool shines = material.emits;
        if (!material.isBlack)
            m_balls.push_back({sphere.centre, sphere.radius, shines});
        else if (shines)
            m_lampBalls.push_back({sphere.centre, sphere.radius, true});
        return true;
    }

    bool addMesh(const InstanceDescription& instance, const TriangleMesh& mesh) {
        const Transform& m = instance.transform;
        const auto toScene = [&](const Vec3f& point) {
            const Vec3d p(point);
            return Vec3d{m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                         m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                         m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]} -
                   m_scene.centre();
        };
        const bool mirrored = dot(Vec3d{m[0], m[1], m[2]},
                                  cross(Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]})) < 0;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::uint32_t slot = mesh.materials.empty() ? 0 : mesh.materials[i];
            const MaterialTraits& material = m_scene.traits(instance.materials[slot]);
            if (material.isInvisible) continue;
            if (!material.isOpaque) return false;
            Triangle triangle;
            for (std::size_t k = 0; k < 3; ++k)
                triangle.corners[k] = toScene(mesh.positions[mesh.triangles[i][k]]);
            if (mirrored) std::swap(triangle.corners[1], triangle.corners[2]);
            triangle.shines = material.emits;
            if (!material.isBlack)
                m_triangles.push_back(triangle);
            else if (triangle.shines)
                m_lamps.push_back(triangle);
        }
        return true;
    }

    // False where corners lie on both sides of one, or a lamp's front is not the outside.
    bool findPlanes() {
        for (const Triangle& triangle : m_triangles) {
            const Vec3d normal = triangle.normal();
            if (!(length(normal) > 0)) continue;
            Plane plane{normalize(normal), 0, 0};
            plane.distance = dot(plane.normal, triangle.corners[0]);
            double above = 0, below = 0;
            for (const Triangle& other : m_triangles) {
                for (const Vec3d& corner : other.corners) {
                    const double height = plane.above(corner);
                    const double tolerance = 32 * 0x1p-24 * length(corner);
                    plane.tolerance = std::max(plane.tolerance, tolerance);
                    if (std::abs(height) <= tolerance) continue;
                    above = std::max(above, height);
                    below = std::max(below, -height);
                }
                if (above > 0 && below > 0) return false;
            }
            if (above > 0 && triangle.shines) return false;
            if (above > 0) plane = {-plane.normal, -plane.distance, plane.tolerance};
            if (above > 0 || below > 0) m_planes.push_back(plane);
        }
        return !m_planes.empty();
    }

    // Whether each edge is that of two triangles.
    bool isClosed() const {
        using Point = std::array<double, 3>;
        std::map<std::pair<Point, Point>, int> edges;
        for (const Triangle& triangle : m_triangles) {
            if (triangle.isCollapsed()) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d &p = triangle.corners[k], &q = triangle.corners[(k + 1) % 3];
                Point a{p.x, p.y, p.z}, b{q.x, q.y, q.z};
                if (b < a) std::swap(a, b);
                ++edges[{a, b}];
            }
        }
        return std::ranges::all_of(edges, [](const auto& edge) { return edge.second == 2; });
    }

    bool isOutside(std::span<const Vec3d> points, double radius) const {
        const auto isBefore = [&](const Plane& plane) {
            return std::ranges::all_of(points, [&](const Vec3d& p) {
                return plane.above(p) - radius > plane.tolerance + 32 * 0x1p-24 * length(p);
            });
        };
        if (m_balls.empty()) return std::ranges::any_of(m_planes, isBefore);
        Vec3d middle;
        for (const Vec3d& p : points) middle += p * (1.0 / static_cast<double>(points.size()));
        const Ball& ball = m_balls[0];
        if (!(length(middle - ball.centre) > 0)) return false;
        const Vec3d normal = normalize(middle - ball.centre);
        return isBefore({normal, dot(normal, ball.centre) + ball.radius, 0});
    }

    bool lightsAreOutside() const {
        const auto isPointOutside = [&](const Light& light) {
            const std::array<Vec3d, 1> point{light.position()};
            return !light.isAtPoint() || isOutside(point, 0);
        };
        return std::ranges::all_of(m_scene.nearLights(), isPointOutside) &&
               std::ranges::all_of(
                   m_lamps, [&](const Triangle& lamp) { return isOutside(lamp.corners, 0); }) &&
               std::ranges::all_of(m_lampBalls, [&](const Ball& lamp) {
                   const std::array<Vec3d, 1> centre{lamp.centre};
                   return isOutside(centre, lamp.radius);
               });
    }

    const Scene& m_scene;
    std::vector<Triangle> m_triangles, m_lamps;  // that reflect; that only shine
    std::vector<Ball> m_balls, m_lampBalls;
    std::vector<Plane> m_planes;
};

}  // namespace

bool isConvexBody(const Scene& scene) {
    return scene.triangleCount() <= kMostTriangles && Body(scene).isConvex();
}

}  // namespace pm
