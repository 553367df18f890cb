// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/ggx_albedo.h"

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/table_cell.h"

namespace pm {

namespace {

constexpr std::uint32_t kNormals = 1024;
constexpr float kLeastCosine = 1e-4f, kLeastAlpha = 1e-5f;

GgxShares integrate(float cosine, float alpha) {
    const Ggx ggx{alpha};
    const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    double normal = 0, grazing = 0;
    for (std::uint32_t i = 0; i < kNormals; ++i) {
        const Vec3f h = ggx.sampleVisible(out, spreadPoint(i));
        const float seen = dot(out, h);
        const Vec3f in = h * (2.0f * seen) - out;
        if (!(in.z > 0.0f)) continue;
        const float weight = ggx.maskingOfBoth(out, in) / ggx.masking(out);
        normal += static_cast<double>(weight);
        grazing += static_cast<double>(weight * schlickWeight(std::min(seen, 1.0f)));
    }
    return {static_cast<float>(normal / kNormals), static_cast<float>(grazing / kNormals)};
}

GgxShares mix(const GgxShares& a, const GgxShares& b, float t) {
    return {a.normal + (b.normal - a.normal) * t, a.grazing + (b.grazing - a.grazing) * t};
}

}  // namespace

GgxAlbedo::GgxAlbedo() {
    for (std::size_t r = 0; r < kSize; ++r) {
        const float roughness = static_cast<float>(r) / (kSize - 1);
        const float alpha = std::max(kLeastAlpha, roughness * roughness);
        double normal = 0, grazing = 0;
        for (std::size_t c = 0; c < kSize; ++c) {
            const float root = static_cast<float>(c) / (kSize - 1);
            m_shares[r][c] = integrate(std::max(kLeastCosine, root * root), alpha);
        }
        constexpr int kSteps = 1024;  // of 2 mu d mu = d mu^2, which is even
        for (int i = 0; i < kSteps; ++i) {
            const float root = std::sqrt(std::sqrt((static_cast<float>(i) + 0.5f) / kSteps));
            const TableCell cell(root, kSize);
            const GgxShares shares =
                mix(m_shares[r][cell.low], m_shares[r][cell.low + 1], cell.part);
            normal += static_cast<double>(shares.normal);
            grazing += static_cast<double>(shares.grazing);
        }
        m_means[r] = {static_cast<float>(normal / kSteps), static_cast<float>(grazing / kSteps)};
    }
}

const GgxAlbedo& GgxAlbedo::table() {
    static const GgxAlbedo table;
    return table;
}

GgxShares GgxAlbedo::at(float cosine, float alpha) const {
    const TableCell r(std::sqrt(alpha), kSize), c(std::sqrt(cosine), kSize);
    const auto along = [&](std::size_t row) {
        return mix(m_shares[row][c.low], m_shares[row][c.low + 1], c.part);
    };
    return mix(along(r.low), along(r.low + 1), r.part);
}

GgxShares GgxAlbedo::mean(float alpha) const {
    const TableCell r(std::sqrt(alpha), kSize);
    return mix(m_means[r.low], m_means[r.low + 1], r.part);
}

}  // namespace pm
