// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lamps that shine where their texture does: points on them are chosen by it, for shadow rays and
// photons alike, and rays that meet them ask for the same density.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/lights/lamp_texture.h"
#include "tests/support/aimed.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// 1 % for the whole file, shared among at most 20 tests.
constexpr double kSignificance = 0.01 / 20;
constexpr double kPiD = std::numbers::pi;
using Domain = LampTexture::Domain;
using Texels = std::function<Rgb(std::uint32_t, std::uint32_t)>;

std::shared_ptr<const SkyPicture> picture(std::uint32_t side, const Texels& texels) {
    return std::make_shared<const SkyPicture>(side, side, texels);
}

// Four texels of 64 x 64, one thousandth of all.
bool isSpot(std::uint32_t x, std::uint32_t y) {
    return (x == 5 && y == 10) || (x == 40 && y == 21) || (x == 22 && y == 50) ||
           (x == 60 && y == 61);
}
std::shared_ptr<const SkyPicture> spots() {
    return picture(64, [](auto x, auto y) { return isSpot(x, y) ? Rgb(1000.0f) : Rgb{}; });
}
std::shared_ptr<const SkyPicture> checks() {
    return picture(64, [](auto x, auto y) { return (x / 8 + y / 8) % 2 ? Rgb(1.0f) : Rgb(0.1f); });
}
std::shared_ptr<const SkyPicture> halves() {
    return picture(2, [](auto x, auto) { return x ? Rgb(3, 2, 1) : Rgb{}; });
}

LampTexture lookAt(Domain domain, const std::shared_ptr<const SkyPicture>& of, double texels) {
    LampTexture::Lamp lamp{domain, texels, std::size_t{1} << 20, {}};
    lamp.look = [&](Vec2f uv, float) {
        const Texel t = of->lookUp(0, {uv});
        return LampTexture::Look{(static_cast<double>(t.r) + t.g + t.b) / 3};
    };
    return LampTexture(lamp);
}

double pValue(Domain domain, const LampTexture& sampled, const LampTexture& stated) {
    Random random(3);
    const auto sample = [&]() -> std::optional<Vec2f> {
        float density;
        return sampled.sample(random.next2D(), density);
    };
    return squarePValue(200'000, sample, [&](double x, double y) {
        const auto at = [&](double shift) {
            const Vec2f point{static_cast<float>(x + shift), static_cast<float>(y + shift)};
            return static_cast<double>(stated.density(point));
        };
        if (domain == Domain::kSquare) return at(0);
        // Of the two halves that a diagonal divides a small square in.
        constexpr double kShift = 1.0 / 256 / 6;
        return (x + y < 1 + kShift ? at(-kShift) : 0) + (x + y < 1 - kShift ? at(kShift) : 0);
    });
}

TEST(LampTexture, SamplesItsDensity) {
    // Looked at so coarsely that the test's bins hold whole cells.
    for (const Domain domain : {Domain::kTriangle, Domain::kSquare}) {
        const LampTexture all[] = {lookAt(domain, spots(), 8), lookAt(domain, checks(), 8),
                                   lookAt(domain, halves(), 2)};
        for (std::size_t i = 0; i < 3; ++i) {
            ASSERT_FALSE(all[i].isEven());
            EXPECT_GT(pValue(domain, all[i], all[i]), kSignificance) << i;
            EXPECT_LT(pValue(domain, all[i], all[(i + 1) % 3]), kSignificance) << i;
        }
    }
}

// What a point was chosen with is what is said of it afterwards; nowhere is it 0.
TEST(LampTexture, StatesOneDensity) {
    for (const Domain domain : {Domain::kTriangle, Domain::kSquare})
        for (const auto& of : {spots(), checks(), halves()}) {
            const LampTexture texture = lookAt(domain, of, 64);
            Random random(4);
            int unlike = 0;
            for (int i = 0; i < 20'000; ++i) {
                float density;
                const Vec2f at = texture.sample(random.next2D(), density);
                ASSERT_GE(density, 0.0199f);
                // On the border of two cells a rounding may tell the other.
                unlike += std::abs(texture.density(at) / density - 1) > 1e-5f;
            }
            EXPECT_LE(unlike, 10);
        }
}

// The variance of what is chosen falls from a thousandfold to next to nothing; of any size.
TEST(LampTexture, LeavesLittleVariance) {
    for (const Domain domain : {Domain::kTriangle, Domain::kSquare})
        for (const std::uint32_t side : {16u, 64u, 256u, 1024u, 2048u}) {
            const auto of = picture(side, [&](auto x, auto y) {
                return x == side / 3 && y == side / 4 ? Rgb(1.0f) : Rgb{};
            });
            const LampTexture texture = lookAt(domain, of, side);
            Random random(5);
            const Moments found = momentsOf(20'000, [&](auto) {
                float density;
                const Vec2f at = texture.sample(random.next2D(), density);
                return static_cast<double>(of->lookUp(0, {at}).r / density);
            });
            const double expected = (domain == Domain::kTriangle ? 2.0 : 1.0) / side / side;
            EXPECT_NEAR(found.mean, expected, 4 * found.standardError) << side;
            // Of the last, places are half as many as texels along a side: their mean over a few is
            // what is known, in place of one in 4 million.
            EXPECT_LT(found.variance / expected / expected, side > 1024 ? 400 : 3) << side;
            EXPECT_NEAR(texture.mean() / expected, 1, side > 1024 ? 5 : 0.05) << side;
            EXPECT_LT(texture.memoryBytes(), 1u << 20);
        }
}

TEST(LampTexture, OfOneColourIsEven) {
    const auto grey = picture(8, [](auto, auto) { return Rgb(0.3f); });
    const LampTexture texture = lookAt(Domain::kTriangle, grey, 8);
    EXPECT_TRUE(texture.isEven());
    EXPECT_NEAR(texture.mean(), 0.3, 1e-6);
    EXPECT_TRUE(lookAt(Domain::kSquare, picture(8, [](auto, auto) { return Rgb{}; }), 8).isEven());
}

// A lamp of two triangles, 2 x 2, that faces down from y = 2, over a floor at 0.
struct Lamp {
    SceneMaker maker;
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<LightSampler> lights;

    // uv: of its corners; none: the lamp has no texture coordinates.
    Lamp(std::shared_ptr<const TextureSource> textures, const std::vector<Vec2f>& uv,
         std::uint32_t divisions = 1) {
        MaterialDescription lamp;
        lamp.emission = Rgb(1.0f);
        lamp.emissionTexture = 0;
        maker.description.textures = std::move(textures);
        maker.quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, maker.material(lamp), divisions);
        if (!uv.empty()) addTexcoords(uv);
        maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, maker.diffuse(Rgb(0.5f)));
        finish();
    }
    void finish() {
        scene = maker.build();
        lights = std::make_unique<LightSampler>(*scene);
    }
    void addTexcoords(const std::vector<Vec2f>& uv) {
        InstanceDescription& instance = maker.description.instances.back();
        TriangleMesh mesh = *std::get<std::shared_ptr<const TriangleMesh>>(instance.shape);
        mesh.texcoordIndices = mesh.triangles;
        for (const Vec3f& p : mesh.positions) {
            const float s = 0.5f * (p.x + 1), t = 0.5f * (p.z + 1);
            const auto at = [&](float a, float b, float c, float d) {
                return (a * (1 - s) + b * s) * (1 - t) + (d * (1 - s) + c * s) * t;
            };
            mesh.texcoords.push_back(
                {at(uv[0].x, uv[1].x, uv[2].x, uv[3].x), at(uv[0].y, uv[1].y, uv[2].y, uv[3].y)});
        }
        instance.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    }
    Surface floorAt(double x, double z) const {
        Surface surface;
        EXPECT_TRUE(
            scene->intersect({Vec3f(Vec3d{x, 0.1, z} - scene->centre()), {0, -1, 0}}, surface));
        return surface;
    }
    // Of next-event estimation at the floor: irradiance, red.
    Moments irradiance(const Surface& floor, std::uint32_t samples) const {
        Random random(6);
        return momentsOf(samples, [&](auto) {
            LightSample s;
            if (!lights->sample(floor, random.next2D(), s)) return 0.0;
            const float cosine = std::max(0.0f, dot(s.direction, floor.geometricNormal));
            return static_cast<double>(s.radiance.r * cosine / s.pdfSolidAngle);
        });
    }
};

const std::vector<Vec2f> kWhole = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

// The light of the four texels, each as a lamp of its own: cos cos A / d^2.
double ofSpots(double x, double z) {
    double sum = 0;
    for (std::uint32_t j = 0; j < 64; ++j)
        for (std::uint32_t i = 0; i < 64; ++i) {
            if (!isSpot(i, j)) continue;
            const double dx = -1 + (i + 0.5) / 32 - x, dz = -1 + (j + 0.5) / 32 - z;
            const double d2 = dx * dx + dz * dz + 4;
            sum += 1000.0 / 1024 * 4 / (d2 * d2);
        }
    return sum;
}

TEST(TexturedLamp, IlluminatesAsWhatShinesOnIt) {
    for (const std::uint32_t divisions : {1u, 40u}) {
        const Lamp lamp(spots(), kWhole, divisions);
        for (const double x : {-1.5, 0.1, 0.8}) {
            const Moments found = lamp.irradiance(lamp.floorAt(x, 0.3), 20'000);
            const double expected = ofSpots(x, 0.3);
            EXPECT_NEAR(found.mean, expected, 4 * found.standardError + 1e-3 * expected) << x;
            // Without the texture 1000. Of many triangles none is forgotten: a tenth is chosen
            // evenly.
            EXPECT_LT(found.variance / expected / expected, divisions == 1 ? 2 : 3) << x;
        }
    }
}

// However the picture lies on the lamp: rays that meet it ask for the density that it was sampled
// with, and the light is that of evenly spread points.
TEST(TexturedLamp, RaysAskForWhatIsSampled) {
    const std::vector<std::vector<Vec2f>> cases = {
        kWhole,
        {{0, 0}, {7, 0}, {7, 5}, {0, 5}},                 // repeated
        {{0.1f, 0.1f}, {0.9f, 0.1f}, {1, 1}, {0, 0.2f}},  // stretched
        {{0, 0}, {3, 3}, {3, 3}, {0, 0}},                 // along a line
        {{0.3f, 0.3f}, {0.3f, 0.3f}, {0.3f, 0.3f}, {0.3f, 0.3f}},
        {{0, 0}, {3000, 0}, {3000, 3000}, {0, 3000}},  // finer than can be looked at
        {}};
    constexpr std::size_t kFine = 5;
    const std::shared_ptr<const SkyPicture> all[] = {checks(), spots(), halves()};
    for (const auto& of : all)
        for (std::size_t c = 0; c < cases.size(); ++c) {
            if (c == kFine && of != all[0]) continue;  // takes a second
            const Lamp lamp(of, cases[c]);
            const Surface floor = lamp.floorAt(0.4, -0.2);
            Random random(7);
            int unlike = 0;
            double mean = 0, meanOfEven = 0, squares = 0;
            constexpr int kSamples = 20'000;
            for (int i = 0; i < kSamples; ++i) {
                LightSample s;
                Surface met;
                ASSERT_TRUE(lamp.lights->sample(floor, random.next2D(), s));
                const auto f = static_cast<double>(
                    s.radiance.r * dot(s.direction, floor.geometricNormal) / s.pdfSolidAngle);
                mean += f / kSamples;
                // Evenly, of both triangles alike.
                const Light& light = lamp.scene->lights()[static_cast<std::size_t>(i % 2)];
                const Surface on = lamp.scene->pointOnLight(light, random.next2D());
                const Vec3f way = on.position - floor.position;
                const double e = 4 * 4 * static_cast<double>(lamp.lights->frontRadiance(on).r) /
                                 std::pow(static_cast<double>(lengthSquared(way)), 2);
                meanOfEven += e / kSamples;
                squares += (e * e + f * f) / kSamples;
                if (!lamp.scene->intersect(rayFrom(floor, s.direction), met)) continue;
                const float asked = lamp.lights->pdfSolidAngle(floor, s.direction, met);
                ASSERT_GT(asked, 0.0f);
                unlike += std::abs(asked / s.pdfSolidAngle - 1) > 1e-3f;
            }
            EXPECT_NEAR(mean, meanOfEven, 4 * std::sqrt(squares / kSamples) + 1e-9) << c;
            EXPECT_LE(unlike, kSamples / 1000) << c;
        }
}

// Photons leave where the texture shines, and carry its flux.
TEST(TexturedLamp, EmitsItsFluxWhereItShines) {
    for (const std::uint32_t divisions : {1u, 20u}) {
        const Lamp lamp(spots(), kWhole, divisions);
        Random random(8);
        double nearSpots = 0, flux = 0;
        std::array<double, 4> ofSpot{};
        constexpr int kPhotons = 40'000;
        for (int i = 0; i < kPhotons; ++i) {
            EmittedPhoton photon;
            const float choice = random.next();
            const Vec2f point = random.next2D();
            if (!lamp.lights->emit(choice, point, random.next2D(), photon)) continue;
            const auto f = static_cast<double>(photon.flux.r) / kPhotons;
            const Vec3d at = Vec3d(photon.ray.origin) + lamp.scene->centre();
            flux += f;
            nearSpots += 1.0 / kPhotons;
            ofSpot[(at.x > 0 ? 1 : 0) + (at.z > 0 ? 2 : 0)] += f;
        }
        const double expected = kPiD * 4 * 4 * 1000 / 4096;
        EXPECT_NEAR(flux, expected, 0.02 * expected);
        for (const double one : ofSpot) EXPECT_NEAR(one, expected / 4, 0.05 * expected / 4);
        EXPECT_GT(nearSpots, 0.8);
    }
}

// A sphere with a small bright spot, seen from a floor that looks up at it.
struct Globe {
    SceneMaker maker;
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<LightSampler> lights;

    explicit Globe(bool isMesh, const Texels& texels) {
        MaterialDescription lamp;
        lamp.emission = Rgb(1.0f);
        lamp.emissionTexture = 0;
        maker.description.textures = picture(64, texels);
        const auto material = maker.material(lamp);
        if (isMesh) {
            maker.meshSphere({0, 0, 0}, 1, material, false, 40);
            addTexcoords();
        } else {
            maker.sphere({0, 0, 0}, 1, material);
        }
        maker.description.instances.back().transform = {1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1, 0};
        maker.quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, maker.diffuse(Rgb(0.5f)));
        scene = maker.build();
        lights = std::make_unique<LightSampler>(*scene);
    }
    // Latitude and longitude; the seam lies on the back.
    void addTexcoords() {
        InstanceDescription& instance = maker.description.instances.back();
        TriangleMesh mesh = *std::get<std::shared_ptr<const TriangleMesh>>(instance.shape);
        mesh.texcoordIndices = mesh.triangles;
        for (const Vec3f& p : mesh.positions)
            mesh.texcoords.push_back(
                {static_cast<float>(0.5 +
                                    std::atan2(static_cast<double>(p.x), static_cast<double>(p.z)) /
                                        (2 * kPiD)),
                 static_cast<float>(std::acos(std::clamp(-static_cast<double>(p.y), -1.0, 1.0)) /
                                    kPiD)});
        instance.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    }
};

// A spot in front, below the middle, of 2 x 2 texels: seen from (0, 0, 2).
Rgb globeSpot(std::uint32_t x, std::uint32_t y) {
    return (x == 31 || x == 32) && (y == 20 || y == 21) ? Rgb(100.0f) : Rgb{};
}

TEST(TexturedLamp, GlobesShineFromTheirSpots) {
    // Its middle, and its area: its rows' solid angle.
    const double angle = kPiD * 21 / 64,
                 area = 2 * kPiD * 2 / 64 * (std::cos(kPiD * 20 / 64) - std::cos(kPiD * 22 / 64));
    const Vec3d normal{0, -std::cos(angle), std::sin(angle)};
    const Vec3d spot = Vec3d{0, 2, 0} + normal;
    for (const bool isMesh : {false, true}) {
        const Globe globe(isMesh, globeSpot);
        Surface floor;
        ASSERT_TRUE(globe.scene->intersect(
            {Vec3f(Vec3d{0.2, 0.1, 2} - globe.scene->centre()), {0, -1, 0}}, floor));
        const Vec3d way = spot - Vec3d{0.2, 0, 2};
        const double d2 = lengthSquared(way);
        const double expected = 100 * area * way.y * -dot(way, normal) / (d2 * d2);
        Random random(9);
        int unlike = 0, lit = 0;
        const Moments found = momentsOf(40'000, [&](auto) {
            LightSample s;
            Surface met;
            if (!globe.lights->sample(floor, random.next2D(), s)) return 0.0;
            if (globe.scene->occluded(s.shadowRay)) return 0.0;
            if (s.radiance.r > 1 && globe.scene->intersect(rayFrom(floor, s.direction), met)) {
                ++lit;
                unlike += std::abs(globe.lights->pdfSolidAngle(floor, s.direction, met) /
                                       s.pdfSolidAngle -
                                   1) > 1e-2f;
            }
            return static_cast<double>(s.radiance.r * dot(s.direction, floor.geometricNormal) /
                                       s.pdfSolidAngle);
        });
        EXPECT_NEAR(found.mean, expected, 4 * found.standardError + 0.03 * expected) << isMesh;
        EXPECT_LT(found.variance / found.mean / found.mean, 4) << isMesh;
        EXPECT_LE(unlike, lit / 100) << isMesh;
        EXPECT_GT(lit, 10'000) << isMesh;
    }
}

// The same by photons, aimed and not: what lands on a ball of glass beside the spot.
TEST(TexturedLamp, AimedPhotonsLandTheFluxOfTheUnaimed) {
    for (const bool isMesh : {false, true}) {
        Globe globe(isMesh, globeSpot);
        MaterialDescription glass;
        glass.kind = MaterialKind::kDielectric;
        globe.maker.sphere({0, 0.7, 1.2}, 0.3, globe.maker.material(glass));
        const Aimed aimed(globe.maker.build());
        const auto landed = [&](bool aim, std::uint64_t photons) {
            return momentsOf(16, [&](std::uint32_t i) {
                const auto r = aimed.trace(PhotonKind::kCaustic, photons, 20 + i, aim);
                double flux = 0;
                for (const Photon& p : r.photons) flux += static_cast<double>(p.flux.r);
                return flux;
            });
        };
        const Moments want = landed(false, 10'000), got = landed(true, 5'000);
        ASSERT_GT(want.mean, 0);
        EXPECT_NEAR(got.mean, want.mean, 4 * std::hypot(want.standardError, got.standardError))
            << isMesh;
        EXPECT_LT(got.standardError, want.standardError) << isMesh;
    }
}

// A host's texture with texels that are no light, seen as it is or without them.
class BadPicture final : public TextureSource {
  public:
    explicit BadPicture(const SkyPicture& clean) : m_clean(clean) {}
    Texel lookUp(std::int32_t, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        const Texel t = m_clean.lookUp(0, {uv});
        return {t.r - 0.5f, t.g - 0.5f, t.b - 0.5f};
    }
    Texel lookUpOfLight(std::int32_t, Vec2f uv) const override { return m_clean.lookUp(0, {uv}); }
    BadTexels badTexels(std::int32_t, const CancelCheck&) const override { return {7, 2}; }
    std::string name(std::int32_t) const override { return "lamp.exr"; }
    std::array<std::uint32_t, 2> texels(std::int32_t i) const override { return m_clean.texels(i); }
    std::uint64_t failureCount() const override { return 0; }

  private:
    SkyPicture m_clean;
};

TEST(TexturedLamp, TexelsThatAreNoLightCountAsNone) {
    const Lamp clean(checks(), kWhole), bad(std::make_shared<const BadPicture>(*checks()), kWhole);
    EXPECT_TRUE(clean.scene->notices().empty());
    ASSERT_EQ(bad.scene->notices().size(), 1u);
    EXPECT_EQ(bad.scene->notices()[0].code, NoticeCode::kTexture);
    EXPECT_NE(bad.scene->notices()[0].text.find("lamp.exr"), std::string::npos);
    const Surface floor = clean.floorAt(0.2, 0.2);
    EXPECT_EQ(clean.irradiance(floor, 1000).mean, bad.irradiance(floor, 1000).mean);
    // An environment's, too.
    SceneMaker maker;
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, maker.diffuse(Rgb(0.5f)));
    maker.sky(Rgb(1.0f), std::make_shared<const BadPicture>(*checks()));
    const auto scene = maker.build();
    ASSERT_EQ(scene->notices().size(), 1u);
    const Vec3f up{0.1f, 0.9f, 0.2f};
    SceneMaker same;
    same.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, same.diffuse(Rgb(0.5f)));
    same.sky(Rgb(1.0f), checks());
    EXPECT_EQ(scene->environment().radiance(up), same.build()->environment().radiance(up));
}

}  // namespace
}  // namespace pm::test
