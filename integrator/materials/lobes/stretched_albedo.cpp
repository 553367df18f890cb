// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/stretched_albedo.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/table_cell.h"

namespace pm {

namespace {

float missingOf(const Ggx& ggx, const Vec3f& out) {
    constexpr std::uint32_t kNormals = 256;
    double sum = 0;
    forEachReflection(ggx, out, kNormals, [&](const Vec3f&, float weight, float) {
        sum += static_cast<double>(weight);
    });
    return std::max(0.0f, 1.0f - static_cast<float>(sum / kNormals));
}

}  // namespace

StretchedAlbedo::StretchedAlbedo(float stretch) {
    constexpr float kLeast = 1e-4f;
    const auto part = [](std::size_t i, std::size_t size) {
        return static_cast<float>(i) / static_cast<float>(size - 1);
    };
    for (std::size_t r = 0; r < kSize; ++r) {
        const Ggx ggx{std::max(kLeast, part(r, kSize) * part(r, kSize)), stretch};
        double mean = 0;
        for (std::size_t c = 0; c < kSize; ++c)
            for (std::size_t t = 0; t < kTurns; ++t) {
                const float cosine = std::max(kLeast, part(c, kSize) * part(c, kSize));
                const float sine = std::sqrt(1.0f - cosine * cosine), turn = part(t, kTurns);
                m_rows[r][c][t] =
                    missingOf(ggx, {sine * std::sqrt(1.0f - turn), sine * std::sqrt(turn), cosine});
            }
        constexpr std::uint32_t kDirections = 1024;
        for (std::uint32_t i = 0; i < kDirections; ++i)
            mean += static_cast<double>(inRow(m_rows[r], sampleCosineHemisphere(spreadPoint(i))));
        m_means[r] = static_cast<float>(mean / kDirections);
    }
}

float StretchedAlbedo::inRow(const Row& row, const Vec3f& w) {
    const float flat2 = w.x * w.x + w.y * w.y;
    const TableCell c(std::sqrt(w.z), kSize), t(flat2 > 0.0f ? w.y * w.y / flat2 : 0.5f, kTurns);
    const auto along = [&](const std::array<float, kTurns>& of) {
        return std::lerp(of[t.low], of[t.low + 1], t.part);
    };
    return std::lerp(along(row[c.low]), along(row[c.low + 1]), c.part);
}

float StretchedAlbedo::missing(const Vec3f& w, float alpha) const {
    const TableCell r(std::sqrt(alpha), kSize);
    return std::lerp(inRow(m_rows[r.low], w), inRow(m_rows[r.low + 1], w), r.part);
}

float StretchedAlbedo::meanMissing(float alpha) const {
    const TableCell r(std::sqrt(alpha), kSize);
    return std::lerp(m_means[r.low], m_means[r.low + 1], r.part);
}

}  // namespace pm
