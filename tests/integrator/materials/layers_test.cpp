// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Clear coats and fibres over what else a material is, stretched facets, metals by their edge and
// thin walls: energy is kept where nothing absorbs, and what goes one way goes the other.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr float kCosines[] = {0.02f, 0.05f, 0.1f, 0.3f, 0.6f, 1.0f};

// A board of one material, seen along directions in the plane of x and z.
class Board {
  public:
    explicit Board(const MaterialDescription& material)
        : m_all{material}, m_tables(makeMaterialTables(m_all, false, {})) {
        m_surface.geometricNormal = m_surface.shadingNormal = {0, 0, 1};
        m_surface.tangent = {1, 0, 0};
        m_surface.isPane = material.thinWalled;
    }
    Bsdf seenFrom(const Vec3f& out, Transport transport = Transport::kRadiance) const {
        return {{m_all, nullptr, &m_tables}, m_surface, out, transport, Rgb(1.0f)};
    }
    static Vec3f along(float cosine, float turns = 0.0f) {
        const float sine = std::sqrt(1.0f - cosine * cosine);
        const SinCos phi = sinCosTurns(turns);
        return {sine * phi.cos, sine * phi.sin, cosine};
    }

  private:
    std::vector<MaterialDescription> m_all;
    MaterialTables m_tables;
    Surface m_surface;
};

struct Sent {
    double share, error;  // of even light, green, and its standard error
};

Sent sentBack(const Board& board, const Vec3f& out, int count) {
    const Bsdf bsdf = board.seenFrom(out);
    Random random(11);
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        BsdfSample s;
        const Vec2f u = random.next2D();
        if (!bsdf.sample(random.next2D().x, u, s)) continue;
        const auto w = static_cast<double>(s.weight.g);
        sum += w;
        squares += w * w;
    }
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
}

// allowed: beside four standard errors.
void expectWhite(const MaterialDescription& material, double allowed = 0.005,
                 double allowedBelow = 0.02) {
    const Board board(material);
    for (const float cosine : kCosines) {
        const Sent sent = sentBack(board, Board::along(cosine), 20'000);
        EXPECT_NEAR(sent.share, 1.0, (cosine < 0.05f ? allowedBelow : allowed) + 4 * sent.error)
            << "cosine " << cosine << " standard error " << sent.error;
    }
}

MaterialDescription whiteMetal(float roughness) {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = Rgb(1.0f);
    m.roughness = roughness;
    return m;
}

TEST(Layers, WhiteMetalUnderACoatReflectsAll) {
    for (const float coatRoughness : {0.0f, 0.3f, 1.0f})
        for (const float roughness : {0.0f, 0.1f, 0.3f, 0.6f, 1.0f})
            for (const float coat : {0.4f, 1.0f}) {
                SCOPED_TRACE(testing::Message() << "coat " << coat << " of roughness "
                                                << coatRoughness << " over " << roughness);
                MaterialDescription m = whiteMetal(roughness);
                m.coat = coat;
                m.coatRoughness = coatRoughness;
                expectWhite(m);
            }
}

TEST(Layers, WhitePlasterAndPlasticUnderACoatReflectAll) {
    for (const float glossy : {0.0f, 0.04f, 0.2f})
        for (const float coatRoughness : {0.0f, 0.4f}) {
            SCOPED_TRACE(testing::Message() << "glossy " << glossy << " coat " << coatRoughness);
            MaterialDescription m;
            m.diffuse = Rgb(1.0f);
            m.glossy = Rgb(glossy);
            m.roughness = 0.4f;
            m.coat = 1.0f;
            m.coatRoughness = coatRoughness;
            expectWhite(m);
        }
}

// Fibres send back no more than comes in, and what they let pass comes back from white below.
TEST(Layers, WhiteUnderFibresReflectsAll) {
    for (const float roughness : {0.07f, 0.2f, 0.5f, 1.0f})
        for (const bool isPlastic : {false, true}) {
            SCOPED_TRACE(testing::Message()
                         << "roughness " << roughness << (isPlastic ? " over plastic" : ""));
            MaterialDescription m;
            m.diffuse = Rgb(1.0f);
            m.sheen = Rgb(1.0f);
            m.sheenRoughness = roughness;
            if (isPlastic) {
                m.glossy = Rgb(0.04f);
                m.roughness = 0.3f;
            }
            expectWhite(m);
        }
}

// Below a cover diffuse light is a product of a factor by arrival and one by view, so that an
// irradiance weighted by the first says all.
TEST(Layers, DiffuseBelowACoverIsAProduct) {
    std::vector<MaterialDescription> covers(4);
    covers[0].coat = 0.7f;
    covers[0].coatRoughness = 0.3f;
    covers[1].sheen = Rgb(0.6f);
    covers[2].glossy = Rgb(0.04f);
    covers[2].roughness = 0.5f;
    covers[2].coat = 1.0f;
    covers[3].glossy = Rgb(0.04f);
    covers[3].roughness = 0.5f;
    covers[3].sheen = Rgb(0.3f);
    for (MaterialDescription& material : covers) {
        material.diffuse = {0.2f, 0.5f, 0.8f};
        const Board board(material);
        for (const float out : kCosines) {
            const Bsdf bsdf = board.seenFrom(Board::along(out));
            const std::optional<Admission> admission = bsdf.admission();
            ASSERT_TRUE(admission);
            EXPECT_FALSE(admission->isEven());
            for (const float in : kCosines) {
                const Rgb value = bsdf.evaluate(Lobe::kDiffuse, Board::along(in, 0.3f));
                const Rgb kept = bsdf.reflectedOf(Rgb(in * admission->from(in)));
                EXPECT_NEAR(value.g, kept.g, 1e-5f) << "out " << out << " in " << in;
                EXPECT_NEAR(value.b, kept.b, 1e-5f) << "out " << out << " in " << in;
            }
        }
    }
}

TEST(Layers, WhiteStretchedMetalReflectsAll) {
    for (const float anisotropy : {0.3f, 0.8f, 1.0f})
        for (const float roughness : {0.1f, 0.4f, 0.8f})
            for (const float turns : {0.0f, 0.125f, 0.25f}) {
                SCOPED_TRACE(testing::Message() << "anisotropy " << anisotropy << " roughness "
                                                << roughness << " turns " << turns);
                MaterialDescription m = whiteMetal(roughness);
                m.anisotropy = anisotropy;
                m.anisotropyRotation = turns;
                expectWhite(m, 0.02, 0.03);
            }
}

// A Phong lobe's width is kept where a coat makes facets of it.
TEST(Layers, AllLobesAreReciprocalAndSampleTheirDensity) {
    std::vector<MaterialDescription> all;
    MaterialDescription m = whiteMetal(0.5f);
    m.glossy = {0.9f, 0.6f, 0.2f};
    m.edgeTint = {0.5f, 0.5f, 0.9f};
    m.anisotropy = 0.7f;
    m.anisotropyRotation = 0.1f;
    all.push_back(m);
    m.coat = 0.8f;
    m.coatRoughness = 0.3f;
    all.push_back(m);
    MaterialDescription cloth;
    cloth.diffuse = {0.5f, 0.2f, 0.1f};
    cloth.sheen = {0.8f, 0.8f, 0.4f};
    all.push_back(cloth);
    cloth.glossy = Rgb(0.05f);
    cloth.glossyExponent = 20.0f;
    all.push_back(cloth);
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "material " << i);
        const Board board(all[i]);
        Random random(12);
        const Lobe lobe = *std::ranges::find_if(kShinyLobes, [&](Lobe one) {
            return board.seenFrom({0, 0, 1}).has(one);
        });
        for (int k = 0; k < 500; ++k) {
            const auto above = [&] {
                Vec3f d = sampleUniformSphere(random.next2D());
                d.z = std::abs(d.z) + 0.02f;
                return normalize(d);
            };
            const Vec3f a = above(), b = above();
            const float there = board.seenFrom(a).evaluate(lobe, b).g / b.z;
            const float back = board.seenFrom(b).evaluate(lobe, a).g / a.z;
            EXPECT_NEAR(there, back, 3e-3f * there + 1e-6f);
        }
        // The density adds to no more than 1, and to what samples have a value.
        for (const float cosine : {0.1f, 0.5f, 1.0f}) {
            Bsdf bsdf = board.seenFrom(Board::along(cosine, 0.1f));
            bsdf.followAll();
            constexpr int kCount = 200'000;
            double density = 0, squares = 0, light = 0, lightSquares = 0, found = 0;
            for (int k = 0; k < kCount; ++k) {
                const Vec3f in = sampleUniformCone(random.next2D(), 1.0f);
                const double area = 2 * std::numbers::pi;
                const double p = static_cast<double>(bsdf.pdfSolidAngle(lobe, in)) * area;
                const double f = static_cast<double>(bsdf.evaluate(lobe, in).g) * area;
                density += p;
                squares += p * p;
                light += f;
                lightSquares += f * f;
                BsdfSample s;
                if (bsdf.follow(lobe, s, {random.next2D(), random.next()})) found += 1;
            }
            const auto error = [&](double sum, double of) {
                return std::sqrt(std::max(0.0, of / kCount - sum * sum / kCount / kCount) / kCount);
            };
            EXPECT_NEAR(density / kCount, found / kCount, 5 * error(density, squares) + 2e-3);
            const Sent sent = [&] {
                double sum = 0, two = 0;
                Random again(13);
                for (int k = 0; k < 20'000; ++k) {
                    BsdfSample s;
                    if (!bsdf.follow(lobe, s, {again.next2D(), again.next()})) continue;
                    sum += static_cast<double>(s.weight.g);
                    two += static_cast<double>(s.weight.g * s.weight.g);
                }
                const double mean = sum / 20'000;
                return Sent{mean, std::sqrt(std::max(0.0, two / 20'000 - mean * mean) / 20'000)};
            }();
            EXPECT_NEAR(light / kCount, sent.share,
                        5 * std::hypot(error(light, lightSquares), sent.error))
                << "cosine " << cosine;
        }
    }
}

// Source: Gulbrandsen 2014: at normal incidence the colour, whatever the edge; n is between the
// least and the greatest that a metal of that reflectance can have.
TEST(Layers, MetalsOfAnEdgeReflectTheirColour) {
    for (const float r : {0.05f, 0.5f, 0.9f, 0.99f})
        for (const float g : {0.0f, 0.3f, 1.0f}) {
            const MetalIndex index = metalOfEdge(r, g);
            EXPECT_NEAR(fresnelConductor(1.0f, index.n, index.k), r, 2e-5f) << r << " " << g;
            EXPECT_NEAR(fresnelConductor(0.0f, index.n, index.k), 1.0f, 1e-5f);
        }
    EXPECT_NEAR(metalOfEdge(0.5f, 1.0f).n, 1.0f / 3.0f, 1e-6f);
    EXPECT_NEAR(metalOfEdge(0.25f, 0.0f).n, 3.0f, 1e-5f);
    EXPECT_NEAR(metalOfEdge(0.25f, 0.0f).k, 0.0f, 1e-2f);
    MaterialDescription m = whiteMetal(0.0f);
    m.glossy = {0.9f, 0.6f, 0.2f};
    m.edgeTint = Rgb(0.5f);
    const Rgb seen = Board(m).seenFrom({0, 0, 1}).albedo();
    EXPECT_NEAR(seen.r, 0.9f, 1e-4f);
    EXPECT_NEAR(seen.b, 0.2f, 1e-4f);
}

// Highlights are longer along the tangent.
TEST(Layers, StretchedHighlightsLieAlongTheTangent) {
    MaterialDescription m = whiteMetal(0.3f);
    m.anisotropy = 0.8f;
    const Vec3f along = Board::along(0.9f, 0.0f), across = Board::along(0.9f, 0.25f);
    const auto toTop = [&] { return Board(m).seenFrom({0, 0, 1}); };
    EXPECT_GT(toTop().evaluate(Lobe::kWide, along).g, 3 * toTop().evaluate(Lobe::kWide, across).g);
    m.anisotropyRotation = 0.25f;
    EXPECT_LT(3 * toTop().evaluate(Lobe::kWide, along).g, toTop().evaluate(Lobe::kWide, across).g);
}

// What doesn't reflect goes straight on, from both sides alike.
TEST(Layers, ThinWallsLetLightStraightOn) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.thinWalled = true;
    m.roughness = 0.4f;
    for (const float cosine : {0.2f, 1.0f, -0.6f}) {
        const Vec3f out = Board::along(cosine);
        const Bsdf bsdf = Board(m).seenFrom(out);
        const float reflected = bsdf.reflectance(Lobe::kReflection).g;
        const float once = fresnelDielectric(std::abs(cosine), 1.5f);
        EXPECT_NEAR(reflected, 2 * once / (1 + once), 1e-6f);
        EXPECT_NEAR(reflected + bsdf.reflectance(Lobe::kRefraction).g, 1.0f, 1e-6f);
        BsdfSample s;
        ASSERT_TRUE(bsdf.follow(Lobe::kRefraction, s));
        EXPECT_NEAR(length(s.direction + out), 0.0f, 1e-6f);
    }
}

// Glass below a coat is as rough as both.
TEST(Layers, ACoatMakesGlassRougher) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    EXPECT_FALSE(isRoughGlass(m));
    m.coat = 1.0f;
    EXPECT_FALSE(isRoughGlass(m)) << "a smooth coat changes nothing";
    m.coatRoughness = 0.5f;
    EXPECT_FLOAT_EQ(glassRoughness(m), 0.5f);
    m.roughness = 0.5f;
    EXPECT_FLOAT_EQ(glassRoughness(m), std::sqrt(std::sqrt(2 * 0.0625f)));
}

}  // namespace
}  // namespace pm::test
