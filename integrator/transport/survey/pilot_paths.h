// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/path/camera_step.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Cells of equal size that cover the frame, row by row: a pilot path starts in each.
struct FrameLattice {
    std::size_t columns = 0, rows = 0;
    double cellWidth = 0, cellHeight = 0;  // pixels

    // Squares of 3 x 3 pixels; of a frame that would have more than about `most` of these, larger
    // ones.
    static FrameLattice squares(const RenderSettings& settings, double most);
    // So many across and down, whatever the frame.
    static FrameLattice fixed(const RenderSettings& settings, std::size_t columns,
                              std::size_t rows);

    std::size_t size() const { return columns * rows; }
};

// Follows camera paths, one from a jittered place in each cell, before anything is rendered: to
// where a render will ask for light. visit gets the cell's number and what the path meets there;
// the path ends where it returns false, and where a camera path of any kind would.
// Threads: works in parallel in the calling TBB arena; visit is called from any of its threads, for
// one cell from one. Throws Error(kCancelled) soon after cancel is set.
void followPilotPaths(const Scene& scene, const Camera& camera, const FrameLattice& lattice,
                      std::uint64_t seed, const CancelCheck& cancel,
                      const std::function<bool(std::size_t path, const PathStop& stop)>& visit);

}  // namespace pm
