// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/ggx_albedo.h"

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/table_cell.h"
#include "integrator/materials/lobes/table_rows.h"

namespace pm {

namespace {

constexpr std::uint32_t kNormals = 1024;

GgxShares integrate(float cosine, float alpha) {
    const Ggx ggx{alpha};
    const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    double normal = 0, grazing = 0;
    forEachReflection(ggx, out, kNormals, [&](const Vec3f&, float weight, float seen) {
        normal += static_cast<double>(weight);
        grazing += static_cast<double>(weight * schlickWeight(std::min(seen, 1.0f)));
    });
    return {static_cast<float>(normal / kNormals), static_cast<float>(grazing / kNormals)};
}

GgxShares mix(const GgxShares& a, const GgxShares& b, float t) {
    return {a.normal + (b.normal - a.normal) * t, a.grazing + (b.grazing - a.grazing) * t};
}

}  // namespace

GgxAlbedo::GgxAlbedo() {
    forEachTableRow(kSize, [this](std::size_t r) {
        for (std::size_t c = 0; c < kSize; ++c)
            m_shares[r][c] = integrate(tableCosine(c), tableAlpha(r));
        const auto part = [&](float GgxShares::*which) {
            return static_cast<float>(meanOverCosines([&](float cosine) {
                const TableCell cell = cellOfCosine(cosine);
                return static_cast<double>(
                    mix(m_shares[r][cell.low], m_shares[r][cell.low + 1], cell.part).*which);
            }));
        };
        m_means[r] = {part(&GgxShares::normal), part(&GgxShares::grazing)};
    });
}

const GgxAlbedo& GgxAlbedo::table() {
    static const GgxAlbedo table;
    return table;
}

GgxShares GgxAlbedo::at(float cosine, float alpha) const {
    const TableCell r = cellOfAlpha(alpha), c = cellOfCosine(cosine);
    const auto along = [&](std::size_t row) {
        return mix(m_shares[row][c.low], m_shares[row][c.low + 1], c.part);
    };
    return mix(along(r.low), along(r.low + 1), r.part);
}

GgxShares GgxAlbedo::mean(float alpha) const {
    const TableCell r = cellOfAlpha(alpha);
    return mix(m_means[r.low], m_means[r.low + 1], r.part);
}

}  // namespace pm
