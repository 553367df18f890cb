// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The three neutral scenes that several renderers were measured on, as plain numbers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm::bench {

// Corners p, p+e0, p+e0+e1, p+e1; the front is where cross(e0, e1) points.
struct NeutralQuad {
    std::string name;
    Vec3d p, e0, e1;
    std::string material;
};

struct NeutralSphere {
    std::string name;
    Vec3d centre;
    double radius = 0;
    std::string material;  // "mirror" (of reflectance 1) or "glass" (smooth, ior 1.5)
};

// Flat triangles, the front where they run counter-clockwise.
struct NeutralMesh {
    std::string name;
    std::vector<Vec3f> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;  // into positions
    std::string material;
};

struct NeutralCamera {
    Vec3d position, lookAt, up;
    double verticalDegrees = 0;
};

struct NeutralScene {
    std::string key;        // "A", "B" or "C"
    std::string name;       // "cornell-diffuse", "cornell-caustic", "sds"
    std::int32_t size = 0;  // pixels, square
    std::map<std::string, Rgb> reflectances;
    std::vector<NeutralQuad> quads;
    std::vector<NeutralSphere> spheres;
    std::vector<NeutralMesh> meshes;  // of our own scenes; no file has any
    NeutralQuad lamp;                 // black, shines from its front
    Rgb radiance;                     // of the lamp
    NeutralCamera camera;
};

// key: of the file scenes.json. Throws nlohmann::json::exception or Error(kIo).
NeutralScene readNeutralScene(const std::filesystem::path& file, const std::string& key);

// Axes of the camera: to the right, up, and back along the view.
struct CameraAxes {
    Vec3d right, up, back;
};
CameraAxes axesOf(const NeutralCamera& camera);

}  // namespace pm::bench
