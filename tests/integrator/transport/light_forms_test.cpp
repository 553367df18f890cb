// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Light straight from lamps against closed forms, for both integrators: form factors (the mean over
// a receiver that fills the frame), irradiance at a point (a frame that sees next to nothing else).
// The receivers reflect rho = 1/2, and L = rho E / pi.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/sampling/warps.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr float kRho = 0.5f;

class LightForm : public ::testing::TestWithParam<IntegratorKind> {
  protected:
    MeasuredLayers render(const SceneMaker& maker, std::int32_t width = 16,
                          std::int32_t height = 16) const {
        RenderSettings settings = smallFrame(width, height, GetParam(), 8, 4);
        settings.photons = 10'000;
        return measure(maker.build(), settings);
    }
    // The frame holds light from lamps only, and that with irradiance E on the average. Beyond
    // standard errors float sums and what is stated with each case are allowed.
    void expectIrradiance(const SceneMaker& maker, double irradiance, double allowed,
                          const char* what, std::int32_t width = 16,
                          std::int32_t height = 16) const {
        const MeasuredLayers m = render(maker, width, height);
        const auto radiance = static_cast<float>(static_cast<double>(kRho) / kPiD * irradiance);
        EXPECT_TRUE(agrees(m.direct, Rgb(radiance), allowed)) << what;
        EXPECT_TRUE(agrees(m.beauty, Rgb(radiance), allowed)) << what;
        // A form that is met by noise alone is not met.
        EXPECT_LT(m.direct.standardError[0], 0.01 * static_cast<double>(radiance)) << what;
    }
};

INSTANTIATE_TEST_SUITE_P(Both, LightForm,
                         ::testing::Values(IntegratorKind::kPhoton, IntegratorKind::kPath),
                         [](const auto& info) {
                             return info.param == IntegratorKind::kPhoton ? "photon" : "path";
                         });

std::uint32_t lamp(SceneMaker& maker) {
    return maker.diffuse({}, Rgb(1.0f));
}

// A view angle that just holds `half` at a distance.
double degreesFor(double half, double distance) {
    return 2 * std::atan(half / distance) * 180 / kPiD;
}

// A regular polygon of 128 sides with the area of a disk, at height z around the z axis.
void addDisk(SceneMaker& maker, double radius, double z, bool facesDown, std::uint32_t material) {
    constexpr std::uint32_t kSides = 128;
    const double r = radius * std::sqrt(kPiD / (kSides / 2.0 * std::sin(2 * kPiD / kSides)));
    TriangleMesh mesh;
    mesh.positions.push_back(Vec3f(Vec3d{0, 0, z}));
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const double phi = 2 * kPiD * i / kSides;
        mesh.positions.push_back(Vec3f(Vec3d{r * std::cos(phi), r * std::sin(phi), z}));
        const std::uint32_t a = 1 + i, b = 1 + (i + 1) % kSides;
        mesh.triangles.push_back(facesDown ? TriangleMesh::Corners{0, b, a}
                                           : TriangleMesh::Corners{0, a, b});
    }
    mesh.materials.assign(kSides, 0);
    mesh.faces.assign(kSides, 0);
    InstanceDescription disk;
    disk.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    disk.materials = {material};
    maker.description.instances.push_back(std::move(disk));
}

TEST_P(LightForm, ParallelRectangles) {  // analytic A1: a x b, gap 1
    for (const auto& [a, b, factor] :
         {std::tuple{1, 1, 0.19982490}, {2, 2, 0.41525328}, {1, 2, 0.28587538}}) {
        SceneMaker maker;
        const double x = a, y = b;
        maker.quad({-x / 2, -y / 2, 0}, {x, 0, 0}, {0, y, 0}, maker.diffuse(Rgb(kRho)));
        maker.quad({-x / 2, -y / 2, 1}, {0, y, 0}, {x, 0, 0}, lamp(maker));
        maker.camera({0, 0, 0.5}, {0, 0, 0}, {0, 1, 0}, degreesFor(y / 2, 0.5));
        expectIrradiance(maker, kPiD * factor, 1e-4, "A1", 16 * a, 16 * b);
    }
}

TEST_P(LightForm, PerpendicularRectangles) {  // analytic A2: emitter w x 1, receiver h x 1
    for (const auto& [w, h, factor] :
         {std::tuple{1, 1, 0.20004378}, {1, 2, 0.23285260}, {2, 1, 0.11642630}}) {
        SceneMaker maker;
        const double x = w, z = h;
        maker.quad({0, 0, 0}, {x, 0, 0}, {0, 1, 0}, lamp(maker));
        maker.quad({0, 0, 0}, {0, 1, 0}, {0, 0, z}, maker.diffuse(Rgb(kRho)));
        maker.camera({1, 0.5, z / 2}, {0, 0.5, z / 2}, {0, 1, 0}, degreesFor(0.5, 1));
        expectIrradiance(maker, kPiD * factor * x / z, 1e-4, "A2", 16 * h, 16);
    }
}

TEST_P(LightForm, ParallelDisks) {  // analytic A3: emitter r1, receiver r2, gap 1
    for (const auto& [r1, r2, factor] :
         {std::tuple{1.0, 1.0, 0.38196601}, {0.5, 1.0, 0.46887113}, {1.0, 2.0, 0.76393202}}) {
        SceneMaker maker;
        addDisk(maker, r2, 0, false, maker.diffuse(Rgb(kRho)));
        addDisk(maker, r1, 1, true, lamp(maker));
        maker.camera({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, degreesFor(r2 * 1.01, 0.9));
        // The flux that arrives, over the whole frame.
        const double flux = kPiD * factor * kPiD * r1 * r1;
        expectIrradiance(maker, flux / (4 * 1.01 * 1.01 * r2 * r2), 5e-4, "A3");
    }
}

// A patch around the origin that faces `normal`, seen from a little above it.
void addPatch(SceneMaker& maker, Vec3d at, Vec3d normal) {
    const Frame frame{Vec3f(normalize(normal))};
    const Vec3d t(frame.tangent), b(frame.bitangent), n(frame.normal);
    const double half = 1e-3;
    maker.quad(at - (t + b) * half, t * (2 * half), b * (2 * half), maker.diffuse(Rgb(kRho)));
    maker.camera(at + n * 0.1, at, t, degreesFor(half * 0.5, 0.1));
}

TEST_P(LightForm, Sphere) {  // analytic A4 and B2: E = pi L (R/d)^2 cos(theta)
    for (const double degrees : {0.0, 30.0, 60.0}) {
        const double theta = degrees * kPiD / 180;
        SceneMaker maker;
        maker.sphere(Vec3d{std::sin(theta), 0, std::cos(theta)} * 2, 1, lamp(maker));
        addPatch(maker, {}, {0, 0, 1});
        expectIrradiance(maker, kPiD * 0.25 * std::cos(theta), 1e-3, "B2");
    }
}

// A lamp that fills 1.7 % of the view: photon maps leave it to next-event estimation alone, whose
// weight must then be 1. Against the other strategy it would lack the square of that share, 3e-4.
TEST_P(LightForm, SmallSphere) {
    SceneMaker maker;
    maker.sphere({0, 0, 2}, 0.26, lamp(maker));
    addPatch(maker, {}, {0, 0, 1});
    expectIrradiance(maker, kPiD * 0.13 * 0.13, 3e-5, "B2");
}

TEST_P(LightForm, Disk) {  // analytic A6 and B4
    for (const auto& [offset, factor] :
         {std::pair{0.0, 0.5}, {0.5, 0.4379826}, {1.0, 0.2763932}, {2.0, 0.0527864}}) {
        SceneMaker maker;
        addDisk(maker, 1, 1, true, lamp(maker));
        addPatch(maker, {offset, 0, 0}, {0, 0, 1});
        expectIrradiance(maker, kPiD * factor, 1e-3, "B4");
    }
}

// Lambert's formula for a polygon that shines with radiance 1 and lies above the horizon.
double polygonIrradiance(const std::vector<Vec3d>& vertices, Vec3d at, Vec3d normal) {
    double sum = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3d a = normalize(vertices[i] - at);
        const Vec3d b = normalize(vertices[(i + 1) % vertices.size()] - at);
        sum += std::acos(dot(a, b)) * dot(normalize(cross(a, b)), normal);
    }
    return std::abs(sum) / 2;
}

// A unit square at z = 1 that faces down, in pieces.
std::vector<Vec3d> addSquare(SceneMaker& maker, std::uint32_t divisions = 1) {
    maker.quad({-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0}, lamp(maker), divisions);
    return {{-0.5, -0.5, 1}, {0.5, -0.5, 1}, {0.5, 0.5, 1}, {-0.5, 0.5, 1}};
}

TEST_P(LightForm, Polygon) {  // analytic A7 and B1
    struct Patch {
        Vec3d at, normal;
    };
    for (const Patch& patch : {Patch{{0, 0, 0}, {0, 0, 1}},
                               {{0.5, 0.5, 0}, {0, 0, 1}},
                               {{1.5, -0.7, 0.2}, {0, 0, 1}},
                               {{0.4, 0.1, 0}, normalize(Vec3d{0.3, -0.2, 1})},
                               {{1.2, 0, 0.5}, normalize(Vec3d{-1, 0.1, 0.8})}}) {
        SceneMaker maker;
        const std::vector<Vec3d> square = addSquare(maker);
        const double e = polygonIrradiance(square, patch.at, patch.normal);
        if (patch.at.x == 0) {
            EXPECT_NEAR(e, 0.75227469, 1e-8);
        }
        if (patch.at.x == 0.5) {
            EXPECT_NEAR(e, kPiD * 0.13853161, 1e-7);
        }
        addPatch(maker, patch.at, patch.normal);
        expectIrradiance(maker, e, 1e-3, "B1");
    }
}

// The same square in 9800 triangles (B9): chosen by the tree of lamps, and by what it learnt.
TEST_P(LightForm, PolygonInManyPieces) {
    SceneMaker maker;
    addSquare(maker, 70);
    addPatch(maker, {}, {0, 0, 1});
    expectIrradiance(maker, 0.75227469, 1e-3, "B9");
}

// Emission test (B1b; Smits & Jensen 2000): the light on a floor is the same on both sides of the
// lamp's middle, whether the lamp is one polygon or a hundred.
TEST_P(LightForm, LampIsSymmetrical) {
    for (const std::uint32_t divisions : {1u, 10u}) {
        SceneMaker maker;
        addSquare(maker, divisions);
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(kRho)));
        maker.camera({0, 0, 0.99}, {0, 0, 0}, {0, 1, 0}, degreesFor(1, 0.99));
        const std::vector<MeasuredLayers> halves =
            measureRegions(maker.build(), smallFrame(16, 16, GetParam(), 8, 4), {0, 0, 16, 16},
                           {{0, 0, 8, 16}, {8, 0, 16, 16}, {0, 0, 16, 8}, {0, 8, 16, 16}});
        for (const std::size_t i : {1u, 2u, 3u})
            EXPECT_TRUE(agree(halves[i].direct, halves[0].direct, 1e-4, 6)) << divisions;
    }
}

TEST_P(LightForm, PointLight) {  // analytic B3: E = I cos(theta) / d^2
    SceneMaker maker;
    maker.pointLight({std::sqrt(3.0), 0, 1}, Rgb(1.0f));
    addPatch(maker, {}, {0, 0, 1});
    expectIrradiance(maker, 0.125, 1e-3, "B3");
}

TEST_P(LightForm, Sun) {  // analytic B7: E = pi L sin^2(alpha), alpha = 0.2665 degrees
    SceneMaker maker;
    const double sine = std::sin(0.2665 * kPiD / 180);
    maker.sphere({0, 0, 1000}, 1000 * sine, lamp(maker));
    addPatch(maker, {}, {0, 0, 1});
    expectIrradiance(maker, 6.797e-5, 5e-4, "B7");
}

// A black room that shines stands for an environment: E = pi L (B5).
TEST_P(LightForm, EvenSurroundings) {
    SceneMaker maker;
    maker.box({-2, -2, -2}, {2, 2, 2}, lamp(maker), true);
    maker.sphere({0, 0, 0}, 1, maker.diffuse(Rgb(kRho)));
    maker.camera({0, 0, 1.9}, {0, 0, 0}, {0, 1, 0}, 30);
    expectIrradiance(maker, kPiD, 1e-4, "B5");
}

// What reflects or transmits everything can't be told from such surroundings (C2).
TEST_P(LightForm, WhiteFurnace) {
    for (const auto& [name, material] : {std::pair{"Lambert", MaterialDescription{}},
                                         {"mirror", mirror(1)},
                                         {"glass", glass()},
                                         {"denser glass", glass(2.4f)},
                                         {"a hollow", glass(1 / 1.33f)}}) {
        SceneMaker maker;
        maker.box({-2, -2, -2}, {2, 2, 2}, lamp(maker), true);
        MaterialDescription m = material;
        if (m.kind == MaterialKind::kSurface) m.diffuse = Rgb(1.0f);
        maker.sphere({0, 0, 0}, 1, maker.material(m));
        maker.camera({0, 0, 1.9}, {0, 0, 0}, {0, 1, 0}, 80);
        EXPECT_TRUE(agrees(render(maker).beauty, Rgb(1.0f), 1e-4)) << name;
    }
}

// CIE overcast sky, L (1 + 2 cos(theta)) / 3 (B6): a dome of 24 x 48 flat lamps, each with the
// radiance of its middle. Exactly what they bring is the sum of Lambert's formula; the sky itself
// brings 7 pi / 9.
TEST_P(LightForm, OvercastSky) {
    constexpr int kRings = 24, kColumns = 48;
    SceneMaker maker;
    double expected = 0;
    const auto corner = [](int ring, int column) {
        // A hair above the horizon.
        const double theta = (kPiD / 2 - 1e-3) * ring / kRings, phi = 2 * kPiD * column / kColumns;
        return Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                     std::cos(theta)};
    };
    for (int ring = 0; ring < kRings; ++ring) {
        const double middle = (kPiD / 2 - 1e-3) * (ring + 0.5) / kRings;
        const double radiance = (1 + 2 * std::cos(middle)) / 3;
        const auto material = maker.diffuse({}, Rgb(static_cast<float>(radiance)));
        TriangleMesh mesh;
        const auto add = [&](const std::array<Vec3d, 3>& triangle) {
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            for (const Vec3d& p : triangle) mesh.positions.push_back(Vec3f(p));
            mesh.triangles.push_back({first, first + 1, first + 2});
            expected +=
                radiance * polygonIrradiance({triangle.begin(), triangle.end()}, {}, {0, 0, 1});
        };
        for (int i = 0; i < kColumns; ++i) {
            add({corner(ring, i), corner(ring + 1, i + 1), corner(ring + 1, i)});
            if (ring > 0) add({corner(ring, i), corner(ring, i + 1), corner(ring + 1, i + 1)});
        }
        maker.mesh(std::move(mesh), material);
    }
    EXPECT_NEAR(expected, 7 * kPiD / 9, 0.002);
    addPatch(maker, {}, {0, 0, 1});
    // All points of the patch but the middle see the lowest lamps at another height.
    expectIrradiance(maker, expected, 1e-3, "B6");
}

}  // namespace
}  // namespace pm::test
