// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// A mesh's ray-tracing structure in its own coordinates, for any number of instances of any scenes
// of one instruction set. Threads: const functions from any.
class SharedMesh {
  public:
    using Triangle = std::array<std::uint32_t, 3>;

    // positions: copied; triangles: referred to. margin: see RimTriangles. Builds in parallel in
    // the calling TBB arena. Throws as RayTracer's constructor and commit().
    SharedMesh(const std::string& isa, std::span<const Vec3f> positions,
               std::span<const Triangle> triangles, double margin, const CancelCheck& cancel);
    ~SharedMesh();
    SharedMesh(const SharedMesh&) = delete;
    SharedMesh& operator=(const SharedMesh&) = delete;

    double margin() const;
    const std::string& isa() const;
    std::uint64_t memoryBytes() const;

  private:
    friend class RayTracer;
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace pm
