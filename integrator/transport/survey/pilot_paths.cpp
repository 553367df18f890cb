// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/survey/pilot_paths.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace pm {

namespace {

constexpr double kPixelsOfACell = 9.0;

}  // namespace

FrameLattice FrameLattice::squares(const RenderSettings& settings, double most) {
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const double side = std::sqrt(std::max(kPixelsOfACell, pixels / most));
    return {static_cast<std::size_t>(std::ceil(settings.width / side)),
            static_cast<std::size_t>(std::ceil(settings.height / side)), side, side};
}

FrameLattice FrameLattice::fixed(const RenderSettings& settings, std::size_t columns,
                                 std::size_t rows) {
    return {columns, rows, settings.width / static_cast<double>(columns),
            settings.height / static_cast<double>(rows)};
}

void followPilotPaths(const Scene& scene, const Camera& camera, const FrameLattice& lattice,
                      std::uint64_t seed, const CancelCheck& cancel,
                      const std::function<bool(std::size_t path, const PathStop& stop)>& visit) {
    tbb::parallel_for(std::size_t{0}, lattice.size(), [&](std::size_t i) {
        cancel.throwIfSet("looking where light will be asked for");
        const Sampler sampler(seed, 0, i, 0);
        const Vec2f jitter = sampler.get2D(Purpose::kPlace);
        const double x = static_cast<double>(i % lattice.columns) + static_cast<double>(jitter.x);
        const double y = static_cast<double>(i / lattice.columns) + static_cast<double>(jitter.y);
        const double atX = x * lattice.cellWidth, atY = y * lattice.cellHeight;
        const Ray first = camera.ray({atX, atY});
        followCameraPath(scene, first, camera.footprint({atX, atY}, first), sampler,
                         [&](const PathStop& stop) { return visit(i, stop); });
    });
}

}  // namespace pm
