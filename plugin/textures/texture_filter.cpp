// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/texture_filter.h"

#include <algorithm>
#include <cmath>

namespace pm::plugin {

namespace {

// Along a long and narrow footprint; beyond, it is widened.
constexpr int kMostProbes = 16;
// Of a texel outside of a picture that is black there; no level is so wide.
constexpr std::int32_t kOutside = -(1 << 30);

// Two neighbouring texels along an axis, and the weight of the second.
struct Pair {
    std::array<std::int32_t, 2> texels;
    float second;
};

// place: of the picture's width or height; size: of the level, texels.
Pair pairAt(float place, std::int32_t size, Wrap wrap) {
    // Brought near first, so that a place far off loses no more bits by the level's size.
    if (wrap == Wrap::kRepeat) place -= std::floor(place);
    if (wrap == Wrap::kMirror) {
        place -= 2.0f * std::floor(0.5f * place);
        if (place > 1.0f) place = 2.0f - place;
    }
    place = std::clamp(place, -1.0f, 2.0f);
    const float x = place * static_cast<float>(size) - 0.5f, floor = std::floor(x);
    const auto first = static_cast<std::int32_t>(floor);
    Pair pair{{first, first + 1}, x - floor};
    for (std::int32_t& texel : pair.texels) {
        if (texel >= 0 && texel < size) continue;
        if (wrap == Wrap::kRepeat)
            texel = texel < 0 ? size - 1 : 0;
        else
            texel = wrap == Wrap::kBlack ? kOutside : std::clamp(texel, 0, size - 1);
    }
    return pair;
}

class LookUp {
  public:
    LookUp(const TexturePicture& picture, HeldTiles& tiles)
        : m_picture(picture), m_file(*picture.file), m_tiles(tiles) {}

    bool around(std::size_t level, Vec2f place, TexelQuad& quad) {
        const TextureLevel& of = m_file.levels[level];
        const Pair across = pairAt(place.x, of.width, m_picture.wrapS),
                   down = pairAt(place.y, of.height, m_picture.wrapT);
        quad.right = across.second;
        quad.lower = down.second;
        return m_tiles.four(m_file, level, across.texels, down.texels, quad.texels);
    }

    // Adds a share of a level's value there.
    bool add(std::size_t level, Vec2f place, float share, TexelValues& sum) {
        TexelQuad quad;
        if (!around(level, place, quad)) return false;
        const float upper = share * (1.0f - quad.lower), lower = share * quad.lower;
        const float left = 1.0f - quad.right, right = quad.right;
        const auto& t = quad.texels;
        for (std::size_t i = 0; i < 4; ++i)
            sum[i] += upper * (left * t[0][i] + right * t[1][i]) +
                      lower * (left * t[2][i] + right * t[3][i]);
        return true;
    }

  private:
    const TexturePicture& m_picture;
    const TextureFile& m_file;
    HeldTiles& m_tiles;
};

// The ellipse into which a footprint's sides make a circle, texels of the finest level.
struct Ellipse {
    double longer = 0, shorter = 0;  // whole lengths, like the sides'
    double x = 1, y = 0;             // unit direction of the longer axis
};

// The singular values of the matrix of which the sides are the columns.
Ellipse ellipseOf(const TexturePicture& picture, Vec2f sideX, Vec2f sideY) {
    const double w = picture.width, h = picture.height;
    const double ax = static_cast<double>(sideX.x) * w, ay = static_cast<double>(sideX.y) * h;
    const double bx = static_cast<double>(sideY.x) * w, by = static_cast<double>(sideY.y) * h;
    const double xx = ax * ax + bx * bx, yy = ay * ay + by * by, xy = ax * ay + bx * by;
    const double mean = 0.5 * (xx + yy), half = 0.5 * (xx - yy);
    const double spread = std::sqrt(half * half + xy * xy);
    Ellipse ellipse{std::sqrt(mean + spread), std::sqrt(std::max(0.0, mean - spread))};
    // An eigenvector of the larger eigenvalue, by the row that doesn't cancel.
    const double vx = half >= 0 ? half + spread : xy, vy = half >= 0 ? xy : spread - half;
    if (const double length = std::sqrt(vx * vx + vy * vy); length > 0) {
        ellipse.x = vx / length;
        ellipse.y = vy / length;
    }
    return ellipse;
}

// The two levels between which a probe of a width, texels of the finest level, is looked up, and
// the share of the coarser one.
struct LevelPair {
    std::size_t finer = 0;
    float coarser = 0.0f;
};

LevelPair levelsFor(double width, std::size_t levels) {
    if (!(width > 1.0)) return {};
    const int exponent = std::min(std::ilogb(width), 31);
    const auto finer = static_cast<std::size_t>(exponent);
    if (finer + 1 >= levels) return {levels - 1, 0.0f};
    return {finer, static_cast<float>(std::ldexp(width, -exponent) - 1.0)};
}

// Of such footprints the finest level is looked up, and no probes are needed for it.
bool isWithinATexel(const TexturePicture& picture, const Vec2f& side) {
    return std::abs(side.x) * static_cast<float>(picture.width) <= 1.0f &&
           std::abs(side.y) * static_cast<float>(picture.height) <= 1.0f;
}

}  // namespace

bool filtered(const TexturePicture& picture, HeldTiles& tiles, Vec2f place, Vec2f sideX,
              Vec2f sideY, TexelValues& value) {
    LookUp lookUp(picture, tiles);
    value = {};
    const std::size_t levels = picture.file->levels.size();
    if (levels == 1 || (isWithinATexel(picture, sideX) && isWithinATexel(picture, sideY)))
        return lookUp.add(0, place, 1.0f, value);
    const Ellipse ellipse = ellipseOf(picture, sideX, sideY);
    const double width = std::max(ellipse.shorter, ellipse.longer / kMostProbes);
    // Each probe stands for a part as long as it is wide, or nearly.
    const double aspect = ellipse.longer / std::max(1.0, width);
    const int probes = std::clamp(static_cast<int>(std::lround(aspect)), 1, kMostProbes);
    const LevelPair level = levelsFor(width, levels);
    const double step = ellipse.longer / probes;
    for (int i = 0; i < probes; ++i) {
        const double along = step * (i - 0.5 * (probes - 1));
        const Vec2f at{place.x + static_cast<float>(along * ellipse.x / picture.width),
                       place.y + static_cast<float>(along * ellipse.y / picture.height)};
        const float share = 1.0f / static_cast<float>(probes);
        if (!lookUp.add(level.finer, at, share * (1.0f - level.coarser), value)) return false;
        if (level.coarser > 0.0f && !lookUp.add(level.finer + 1, at, share * level.coarser, value))
            return false;
    }
    return true;
}

bool texelsAround(const TexturePicture& picture, HeldTiles& tiles, Vec2f place, TexelQuad& quad) {
    return LookUp(picture, tiles).around(0, place, quad);
}

}  // namespace pm::plugin
