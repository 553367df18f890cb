// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/sheen_albedo.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrator/materials/lobes/sheen.h"

namespace pm {

namespace {

float integrate(float cosine, float roughness) {
    constexpr std::uint32_t kDirections = 1024;
    const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    double sum = 0;
    for (std::uint32_t i = 0; i < kDirections; ++i) {
        Vec3f in;
        if (Sheen::sampleIn(out, spreadPoint(i), in))
            sum +=
                static_cast<double>(Sheen::formula(roughness, out, in) / Sheen::density(out, in));
    }
    return static_cast<float>(sum / kDirections);
}

}  // namespace

SheenAlbedo::SheenAlbedo() {
    for (std::size_t r = 0; r < kLobeTableSize; ++r) {
        const float roughness =
            std::max(kLeastSheenRoughness, static_cast<float>(r) / (kLobeTableSize - 1));
        for (std::size_t c = 0; c < kLobeTableSize; ++c)
            m_reflected[r][c] = integrate(tableCosine(c), roughness);
        m_scale[r] = 1.0f / std::max(1.0f, *std::ranges::max_element(m_reflected[r]));
        for (float& reflected : m_reflected[r]) reflected *= m_scale[r];
    }
}

const SheenAlbedo& SheenAlbedo::table() {
    static const SheenAlbedo table;
    return table;
}

float SheenAlbedo::at(float cosine, float roughness) const {
    const TableCell r(roughness, kLobeTableSize), c = cellOfCosine(cosine);
    const auto along = [&](std::size_t row) {
        return std::lerp(m_reflected[row][c.low], m_reflected[row][c.low + 1], c.part);
    };
    return std::lerp(along(r.low), along(r.low + 1), r.part);
}

float SheenAlbedo::scale(float roughness) const {
    const TableCell r(roughness, kLobeTableSize);
    return std::lerp(m_scale[r.low], m_scale[r.low + 1], r.part);
}

}  // namespace pm
