// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Limit surfaces that are cut on demand, for tests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "integrator/geometry/limit_shape.h"
#include "integrator/scene/scene.h"
#include "integrator/tessellation/limit_groups.h"
#include "tests/support/scene_maker.h"

namespace pm::test {

// rate: of each edge; 0: by the camera, if any.
inline void addLimit(SceneMaker& maker, SubdivisionCage cage, std::uint32_t rate,
                     std::uint32_t material, const Transform& place = kIdentityTransform) {
    std::uint32_t slots = 1;
    for (const std::uint32_t slot : cage.mesh.faceMaterials) slots = std::max(slots, slot + 1);
    InstanceDescription instance;
    instance.shape = std::make_shared<const LimitShape>(std::move(cage), 4);
    instance.materials.assign(slots, material);
    instance.tessellationRate = rate;
    instance.transform = place;
    maker.description.instances.push_back(std::move(instance));
}

// The same triangles in one mesh, as Embree would have them.
inline TriangleMesh gathered(const LimitGroups& groups) {
    TriangleMesh mesh;
    for (std::uint32_t g = 0; g < groups.groupCount(); ++g) {
        const auto group = groups.make(g);
        for (std::uint32_t t = 0; t < group->triangleCount(); ++t) {
            const auto at = static_cast<std::uint32_t>(mesh.positions.size());
            for (std::size_t k = 0; k < 3; ++k)
                mesh.positions.push_back(group->point(t, k).position);
            mesh.triangles.push_back({at, at + 1, at + 2});
            mesh.materials.push_back(0);
            mesh.faces.push_back(0);
        }
    }
    return mesh;
}

// A height that is a function of the texture coordinates.
class Waves final : public HeightField {
  public:
    explicit Waves(double size, double frequency = 40.0) : m_size(size), m_frequency(frequency) {}
    double at(const std::array<double, 2>& t) const override {
        return m_size * std::sin(m_frequency * t[0] + 0.3) * std::cos(m_frequency * t[1]);
    }
    std::array<double, 2> range() const override { return {-m_size, m_size}; }

  private:
    double m_size, m_frequency;
};

}  // namespace pm::test
