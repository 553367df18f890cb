// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/lobes/layer_pass.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "integrator/materials/lobes/fresnel.h"
#include "integrator/materials/lobes/ggx.h"
#include "integrator/materials/lobes/ggx_albedo.h"

namespace pm {

namespace {

struct Arrival {
    TableCell cell;  // of the cosine of light that leaves along the row's
    float weight;
    float grazing;  // Schlick's weight at the facet
};

// Where white facets of a width send light along a cosine from; the weights of both add to 1.
struct Arrivals {
    std::vector<Arrival> once, more;
};

Arrivals arrivalsAt(float cosine, float alpha) {
    constexpr std::uint32_t kNormals = 128, kOfMore = 32;
    Arrivals arrivals;
    const Ggx ggx{alpha};
    const Vec3f out{std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
    double sum = 0;
    forEachReflection(ggx, out, kNormals, [&](const Vec3f& in, float weight, float seen) {
        arrivals.once.push_back({cellOfCosine(in.z), weight, schlickWeight(std::min(seen, 1.0f))});
        sum += static_cast<double>(weight);
    });
    const GgxAlbedo& table = GgxAlbedo::table();
    const float missing = table.at(cosine, alpha).missing();
    const float mean = table.mean(alpha).missing();
    for (Arrival& arrival : arrivals.once)
        arrival.weight *= (1.0f - missing) / static_cast<float>(sum);
    double ofMore = 0;
    for (std::uint32_t i = 0; mean > 0.0f && i < kOfMore; ++i) {
        const float of = std::sqrt((static_cast<float>(i) + 0.5f) / kOfMore);
        const float weight = table.at(of, alpha).missing();
        arrivals.more.push_back({cellOfCosine(of), weight, 0.0f});
        ofMore += static_cast<double>(weight);
    }
    for (Arrival& arrival : arrivals.more) arrival.weight *= missing / static_cast<float>(ofMore);
    return arrivals;
}

float mix(float a, float b, float t) {
    return a + (b - a) * t;
}

}  // namespace

LayerPass::Row LayerPass::scaled(const std::array<float, kLobeTableSize>& passes, float alpha) {
    std::array<Arrivals, kLobeTableSize> matrix;
    std::array<float, kLobeTableSize> d;
    for (std::size_t c = 0; c < kLobeTableSize; ++c) {
        matrix[c] = arrivalsAt(tableCosine(c), alpha);
        d[c] = std::sqrt(passes[c]);
    }
    const auto by = [&](const TableCell& cell) {
        return static_cast<double>(mix(d[cell.low], d[cell.low + 1], cell.part));
    };
    const auto sum = [&](const std::vector<Arrival>& arrivals, const auto& weight) {
        double total = 0;
        for (const Arrival& arrival : arrivals)
            total += static_cast<double>(weight(arrival)) * by(arrival.cell);
        return total;
    };
    const auto whole = [](const Arrival& arrival) { return arrival.weight; };
    constexpr int kTurns = 20;
    for (int turn = 0; turn < kTurns; ++turn) {
        std::array<float, kLobeTableSize> next;
        for (std::size_t c = 0; c < kLobeTableSize; ++c) {
            const double arrives = sum(matrix[c].once, whole) + sum(matrix[c].more, whole);
            next[c] = static_cast<float>(
                std::sqrt(static_cast<double>(d[c] * passes[c]) / std::max(arrives, 1e-30)));
        }
        d = next;
    }
    Row row;
    for (std::size_t c = 0; c < kLobeTableSize; ++c) {
        const auto leaves = [&](double arrives) { return d[c] * static_cast<float>(arrives); };
        const auto grazing = [](const Arrival& arrival) {
            return arrival.weight * arrival.grazing;
        };
        row[c] = {d[c],
                  {{leaves(sum(matrix[c].once, whole)), leaves(sum(matrix[c].once, grazing))},
                   leaves(sum(matrix[c].more, whole))}};
    }
    return row;
}

LayerPass::LayerPass(const std::function<float(float)>& passes) {
    std::array<float, kLobeTableSize> all;
    for (std::size_t c = 0; c < kLobeTableSize; ++c) all[c] = passes(tableCosine(c));
    for (std::size_t r = 0; r < kLobeTableSize; ++r) m_rows[r] = scaled(all, tableAlpha(r));
}

float LayerPass::at(float cosine, float alpha) const {
    const TableCell r = cellOfAlpha(alpha), c = cellOfCosine(cosine);
    const auto along = [&](const Row& row) { return mix(row[c.low].d, row[c.low + 1].d, c.part); };
    return mix(along(m_rows[r.low]), along(m_rows[r.low + 1]), r.part);
}

LayerPass::Below LayerPass::below(float cosine, float alpha) const {
    const TableCell r = cellOfAlpha(alpha), c = cellOfCosine(cosine);
    const auto between = [](const Below& a, const Below& b, float t) {
        return Below{{mix(a.once.normal, b.once.normal, t), mix(a.once.grazing, b.once.grazing, t)},
                     mix(a.more, b.more, t)};
    };
    const auto along = [&](const Row& row) {
        return between(row[c.low].below, row[c.low + 1].below, c.part);
    };
    return between(along(m_rows[r.low]), along(m_rows[r.low + 1]), r.part);
}

}  // namespace pm
