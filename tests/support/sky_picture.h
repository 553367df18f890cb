// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "integrator/materials/texture_source.h"
#include "integrator/values/rgb.h"

namespace pm::test {

// A latitude-longitude picture as any host's texture: bilinear between the middles of its texels,
// repeated across, clamped above and below; its only texture is number 0.
class SkyPicture final : public TextureSource {
  public:
    // texel: of column and row, counted from the lower left.
    SkyPicture(std::uint32_t width, std::uint32_t height,
               const std::function<Rgb(std::uint32_t, std::uint32_t)>& texel)
        : m_width(width), m_height(height) {
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) m_texels.push_back(texel(x, y));
    }

    Texel lookUp(std::int32_t, const TextureContext& asked) const override {
        const Vec2f uv = asked.uv;
        const float x = uv.x * static_cast<float>(m_width) - 0.5f;
        const float y = uv.y * static_cast<float>(m_height) - 0.5f;
        const float x0 = std::floor(x), y0 = std::floor(y);
        const Rgb lower = between(at(x0, y0), at(x0 + 1, y0), x - x0);
        const Rgb upper = between(at(x0, y0 + 1), at(x0 + 1, y0 + 1), x - x0);
        const Rgb c = between(lower, upper, y - y0);
        return {c.r, c.g, c.b};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {m_width, m_height}; }
    std::uint64_t failureCount() const override { return 0; }

  private:
    static Rgb between(const Rgb& a, const Rgb& b, float t) { return a * (1 - t) + b * t; }
    Rgb at(float x, float y) const {
        const auto w = static_cast<std::int64_t>(m_width), h = static_cast<std::int64_t>(m_height);
        const std::int64_t column = (static_cast<std::int64_t>(x) % w + w) % w;
        const std::int64_t row =
            std::min(std::max(static_cast<std::int64_t>(y), std::int64_t{0}), h - 1);
        return m_texels[static_cast<std::size_t>(row * w + column)];
    }

    std::uint32_t m_width, m_height;
    std::vector<Rgb> m_texels;
};

// A blue sky with a sun of a few texels, and a dark ground.
inline std::shared_ptr<const SkyPicture> sunnySky() {
    return std::make_shared<const SkyPicture>(32, 16, [](std::uint32_t x, std::uint32_t y) {
        if ((x == 20 || x == 21) && y == 12) return Rgb(60.0f, 50.0f, 30.0f);
        const float up = static_cast<float>(y) / 15.0f;
        return y < 8 ? Rgb(0.1f, 0.08f, 0.05f) : Rgb(0.3f, 0.5f, 0.9f) * up;
    });
}

// A turn about no axis of the coordinates.
inline Transform aTurn() {
    const double c1 = std::cos(0.7), s1 = std::sin(0.7), c2 = std::cos(-0.4), s2 = std::sin(-0.4);
    // About x after about y.
    return {c1, 0, s1, 0, s2 * s1, c2, -s2 * c1, 0, -c2 * s1, s2, c2 * c1, 0};
}

}  // namespace pm::test
