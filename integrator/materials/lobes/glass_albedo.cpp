// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/glass_albedo.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/table_cell.h"
#include "integrator/materials/lobes/table_rows.h"

namespace pm {

namespace {

constexpr std::uint32_t kNormals = 512;

// eta: index beyond over that on this side.
float integrate(float cosine, float alpha, float eta) {
    const Ggx ggx{alpha};
    const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    double sum = 0;
    for (std::uint32_t i = 0; i < kNormals; ++i) {
        const Vec3f h = ggx.sampleVisible(out, spreadPoint(i));
        const float seen = std::min(1.0f, dot(out, h));
        const float reflected = fresnelDielectric(seen, eta);
        const float masking = ggx.masking(out);
        const Vec3f in = h * (2.0f * seen) - out;
        if (in.z > 0.0f)
            sum += static_cast<double>(reflected * ggx.maskingOfBoth(out, in) / masking);
        const float cos2 = 1.0f - (1.0f - seen * seen) / (eta * eta);
        if (!(cos2 > 0.0f)) continue;
        const Vec3f beyond = h * (seen / eta - std::sqrt(cos2)) - out / eta;
        if (beyond.z < 0.0f)
            sum +=
                static_cast<double>((1.0f - reflected) * ggx.maskingOfBoth(out, beyond) / masking);
    }
    return static_cast<float>(sum / kNormals);
}

}  // namespace

GlassAlbedo::GlassAlbedo(float ior) : m_ior(ior) {
    for (int side = 0; side < 2; ++side) {
        forEachTableRow(kSize, [this, side](std::size_t r) { fill(side, r); });
        const float eta = side == 0 ? ior : 1.0f / ior;
        m_letsThrough[static_cast<std::size_t>(side)] =
            static_cast<float>(meanOverCosines([&](float cosine) {
                return static_cast<double>(1.0f - fresnelDielectric(cosine, eta));
            }));
    }
}

const GlassAlbedo& GlassAlbedo::usual() {
    static const GlassAlbedo glass(1.5f);
    return glass;
}

void GlassAlbedo::fill(int side, std::size_t r) {
    Row& row = m_rows[static_cast<std::size_t>(side)][r];
    const float eta = side == 0 ? m_ior : 1.0f / m_ior;
    for (std::size_t c = 0; c < kSize; ++c)
        row.missing[c] = std::max(0.0f, 1.0f - integrate(tableCosine(c), tableAlpha(r), eta));
    row.mean = static_cast<float>(meanOverCosines([&](float cosine) {
        const TableCell c = cellOfCosine(cosine);
        return static_cast<double>(std::lerp(row.missing[c.low], row.missing[c.low + 1], c.part));
    }));
}

float GlassAlbedo::missing(int side, float cosine, float alpha) const {
    const TableCell r = cellOfAlpha(alpha), c = cellOfCosine(cosine);
    const auto& rows = m_rows[static_cast<std::size_t>(side)];
    const auto along = [&](const Row& row) {
        return std::lerp(row.missing[c.low], row.missing[c.low + 1], c.part);
    };
    return std::lerp(along(rows[r.low]), along(rows[r.low + 1]), r.part);
}

float GlassAlbedo::meanMissing(int side, float alpha) const {
    const TableCell r = cellOfAlpha(alpha);
    const auto& rows = m_rows[static_cast<std::size_t>(side)];
    return std::lerp(rows[r.low].mean, rows[r.low + 1].mean, r.part);
}

float GlassAlbedo::crossing(int side, float alpha) const {
    // Reciprocity asks that both sides' shares stand as the other's missing light times the square
    // of its index; as much goes through as both sides' smooth boundaries allow.
    const float ofOther[2] = {meanMissing(1, alpha) * m_ior * m_ior, meanMissing(0, alpha)};
    if (!(ofOther[0] > 0.0f && ofOther[1] > 0.0f)) return 0.0f;
    const float most = std::min(m_letsThrough[0] / ofOther[0], m_letsThrough[1] / ofOther[1]);
    return most * ofOther[side];
}

}  // namespace pm
