// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/mixed_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "host_shim/pictures/picture_io.h"

namespace pm::host::test {
namespace {

constexpr const char* kMaterials =
    "newmtl grey\nKd 0.7 0.7 0.7\n"
    "newmtl red\nKd 0.6 0.1 0.08\n"
    "newmtl checks\nKd 0.9 0.9 0.9\nmap_Kd checks.png\n"
    "newmtl glossy\nKd 0.2 0.25 0.3\nKs 0.5 0.5 0.5\nNs 60\nillum 2\n"
    "newmtl mirror\nKd 0 0 0\nKs 0.9 0.9 0.9\nillum 3\n"
    "newmtl glass\nKd 0 0 0\nKs 1 1 1\nTf 0.9 1 0.95\nNi 1.5\nillum 7\n"
    "newmtl lamp\nKd 0 0 0\nKe 20 18 14\n";

constexpr const char* kRoom =
    "mtllib mixed.mtl\n"
    "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
    "v -0.3 1.98 -0.3\nv 0.3 1.98 -0.3\nv 0.3 1.98 0.3\nv -0.3 1.98 0.3\n"
    "vt 0 0\nvt 3 0\nvt 3 3\nvt 0 3\n"
    "usemtl checks\nf 4/1 3/2 2/3 1/4\nusemtl grey\nf 5 6 7 8\nusemtl glossy\nf 1 2 6 5\n"
    "usemtl red\nf 4 1 5 8\nusemtl mirror\nf 2 3 7 6\nusemtl lamp\nf 9 10 11 12\n";

// A ball of quads with its exact normals; its vertices follow the room's twelve.
std::string ballText() {
    constexpr int kRings = 16, kSectors = 32;
    std::string vertices, normals, faces = "usemtl glass\n";
    for (int ring = 0; ring <= kRings; ++ring) {
        const double polar = std::numbers::pi * ring / kRings;
        for (int sector = 0; sector < kSectors; ++sector) {
            const double turn = 2.0 * std::numbers::pi * sector / kSectors;
            const double x = std::sin(polar) * std::cos(turn), y = std::cos(polar);
            const double z = std::sin(polar) * std::sin(turn);
            vertices += fmt::format("v {:.9f} {:.9f} {:.9f}\n", -0.2 + 0.4 * x, 0.5 + 0.4 * y,
                                    0.3 + 0.4 * z);
            normals += fmt::format("vn {:.9f} {:.9f} {:.9f}\n", x, y, z);
        }
    }
    const auto corner = [](int ring, int sector) {
        const int number = ring * kSectors + sector % kSectors + 1;
        return fmt::format(" {}//{}", number + 12, number);
    };
    for (int ring = 0; ring < kRings; ++ring) {
        for (int sector = 0; sector < kSectors; ++sector) {
            const bool top = ring == 0, bottom = ring + 1 == kRings;
            faces += fmt::format(
                "f{}{}{}{}\n", corner(ring, sector), top ? "" : corner(ring, sector + 1),
                bottom ? "" : corner(ring + 1, sector + 1), corner(ring + 1, sector));
        }
    }
    return vertices + normals + faces;
}

void writeChecks(const std::filesystem::path& file) {
    constexpr std::int32_t kSide = 64;
    DisplayPicture picture{kSide, kSide, 3, {}};
    for (std::int32_t i = 0; i < kSide * kSide; ++i) {
        const bool light = ((i % kSide / 8) + (i / kSide / 8)) % 2 == 0;
        const float code = light ? 0.9f : 0.3f;
        picture.values.insert(picture.values.end(), {code, code * 0.8f, code * 0.5f});
    }
    writeDisplayPicture(file, picture);
}

}  // namespace

void writeMixedScene(const std::filesystem::path& folder) {
    std::ofstream(folder / "mixed.mtl", std::ios::binary) << kMaterials;
    std::ofstream(folder / "mixed.obj", std::ios::binary) << kRoom << ballText();
    writeChecks(folder / "checks.png");
}

}  // namespace pm::host::test
