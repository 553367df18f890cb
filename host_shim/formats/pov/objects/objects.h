// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace pm::host::pov {

inline constexpr std::array<std::string_view, 37> kObjects{
    "bicubic_patch",
    "blob",
    "box",
    "cone",
    "cubic",
    "cylinder",
    "difference",
    "disc",
    "height_field",
    "intersection",
    "isosurface",
    "julia_fractal",
    "lathe",
    "light_group",
    "light_source",
    "merge",
    "mesh",
    "mesh2",
    "object",
    "ovus",
    "parametric",
    "plane",
    "poly",
    "polygon",
    "polynomial",
    "prism",
    "quadric",
    "quartic",
    "smooth_triangle",
    "sor",
    "sphere",
    "sphere_sweep",
    "superellipsoid",
    "text",
    "torus",
    "triangle",
    "union",
};

inline bool isObject(std::string_view kind) {
    return std::ranges::find(kObjects, kind) != kObjects.end();
}

// Projections other than the plain one.
inline constexpr std::array<std::string_view, 8> kOtherCameras{
    "orthographic", "fisheye",  "ultra_wide_angle", "omnimax",
    "panoramic",    "cylinder", "spherical",        "mesh_camera",
};

}  // namespace pm::host::pov
