// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/environment.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

constexpr std::uint32_t kLeastColumns = 64;
// Share of the choices of rows, and of cells within a row, made evenly: texels that the table's
// cells are too coarse for are found all the same.
constexpr double kEvenShare = 0.05;
// Look-ups along a cell's side: of pictures wider than 32768 texels some are left out.
constexpr std::uint32_t kMostSteps = 16;
// A cell counts for at least this share of its brightest neighbour, whose light interpolation
// carries over the border between them.
constexpr double kNeighbourShare = 0.1;

// Sums of the probabilities as the random numbers have them, in steps of 2^-24: a cell is taken
// with the probability that they leave it.
void accumulate(std::span<const double> probabilities, float* cumulative) {
    double sum = 0;
    for (std::size_t i = 0; i < probabilities.size(); ++i) {
        sum += probabilities[i];
        cumulative[i] = static_cast<float>(std::min(1.0, std::round(sum * 0x1p24) * 0x1p-24));
    }
    cumulative[probabilities.size() - 1] = 1.0f;
}

float shareOf(std::span<const float> cumulative, std::size_t i) {
    return cumulative[i] - (i > 0 ? cumulative[i - 1] : 0.0f);
}

// Parts of [0, 1] in the tables that say where to begin a search; a power of two, so that a number
// times it is exact.
constexpr std::size_t kParts = 256;

void fillStarts(std::span<const float> cumulative, std::uint16_t* starts) {
    std::size_t i = 0;
    for (std::size_t part = 0; part <= kParts; ++part) {
        while (i + 1 < cumulative.size() &&
               cumulative[i] * static_cast<float>(kParts) <= static_cast<float>(part))
            ++i;
        starts[part] = static_cast<std::uint16_t>(i);
    }
}

// The first entry that is more than u, in [0, 1), by the table of starts. u becomes where in the
// share it lay, in [0, 1).
std::size_t choose(std::span<const float> cumulative, const std::uint16_t* starts, float& u) {
    const auto part = static_cast<std::size_t>(u * static_cast<float>(kParts));
    const auto it = std::upper_bound(cumulative.begin() + starts[part],
                                     cumulative.begin() + starts[part + 1], u);
    const auto i = static_cast<std::size_t>(it - cumulative.begin());
    const float begin = i > 0 ? cumulative[i - 1] : 0.0f;
    u = std::min((u - begin + 0x1p-25f) / shareOf(cumulative, i), 1.0f - 0x1p-24f);
    return i;
}

}  // namespace

Environment::Environment(const EnvironmentDescription& description, const TextureSource* textures,
                         const CancelCheck& cancel, bool hasBadTexels)
    : m_scale(description.radiance),
      m_texture(description.texture),
      m_textures(textures),
      m_hasBadTexels(hasBadTexels) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        m_axes[axis] = Vec3f(Vec3d{description.toWorld[axis], description.toWorld[4 + axis],
                                   description.toWorld[8 + axis]});
    // What rounding moves a place by, in a look-up, at most.
    constexpr float kRounding = 0x1p-21f;
    if (m_texture != kNoTexture)
        m_halfTexel =
            std::min(0.5f, 0.5f / static_cast<float>(m_textures->texels(m_texture)[1]) + kRounding);
    if (m_texture == kNoTexture || isBlack(m_scale))
        m_integral = 4 * std::numbers::pi * channelMean(m_scale);
    else
        fillTable(cancel);
}

Vec3f Environment::toLocal(const Vec3f& direction) const {
    return {dot(m_axes[0], direction), dot(m_axes[1], direction), dot(m_axes[2], direction)};
}

Vec3f Environment::toWorld(const Vec3f& local) const {
    return normalize(m_axes[0] * local.x + m_axes[1] * local.y + m_axes[2] * local.z);
}

Vec2f Environment::toPicture(const Vec3f& local) const {
    const Vec3d d(local);
    const double across = 0.5 + pinnedAtan2Turns(d.x, -d.z);
    const double up = 2.0 * pinnedAtan2Turns(std::sqrt(d.x * d.x + d.z * d.z), -d.y);
    return {static_cast<float>(across), static_cast<float>(up)};
}

// Beyond the middles of the first and the last row lie the poles, not the other one of them.
float Environment::keptFromPoles(float up) const {
    return std::clamp(up, m_halfTexel, 1.0f - m_halfTexel);
}

Rgb Environment::texel(Vec2f uv) const {
    uv.y = keptFromPoles(uv.y);
    const Texel t = asLight(m_hasBadTexels ? m_textures->lookUpOfLight(m_texture, uv)
                                           : m_textures->lookUp(m_texture, {uv}));
    return m_scale * Rgb(t.r, t.g, t.b);
}

Rgb Environment::radiance(const Vec3f& direction) const {
    if (m_texture == kNoTexture) return m_scale;
    return texel(toPicture(toLocal(direction)));
}

double Environment::meanOfCell(std::size_t column, std::size_t row, std::uint32_t steps) const {
    double sum = 0;
    for (std::uint32_t j = 0; j < steps; ++j)
        for (std::uint32_t i = 0; i < steps; ++i) {
            const double x = static_cast<double>(column) + (i + 0.5) / steps;
            const double y = static_cast<double>(row) + (j + 0.5) / steps;
            sum += channelMean(
                texel({static_cast<float>(x / m_columns), static_cast<float>(y / m_rowCount)}));
        }
    return sum / (static_cast<double>(steps) * steps);
}

// Source (a picture as a table of rows and of cells within them): Pharr, Jakob & Humphreys,
// "Physically Based Rendering", 3rd edition, section 14.2.4.
void Environment::fillTable(const CancelCheck& cancel) {
    // Two cells to a texel, whose middles then have the mean of what interpolation makes of them;
    // of large pictures many texels to a cell, each looked at.
    const auto [across, down] = m_textures->texels(m_texture);
    m_columns = std::clamp(2 * across, kLeastColumns, kMostColumns);
    m_rowCount = std::clamp(2 * down, kLeastColumns / 2, kMostColumns / 2);
    const std::uint32_t steps = std::clamp(
        std::max((across + m_columns - 1) / m_columns, (down + m_rowCount - 1) / m_rowCount), 1u,
        kMostSteps);
    const std::size_t columns = m_columns, rows = m_rowCount;
    for (std::uint32_t row = 0; row <= m_rowCount; ++row)
        m_heights.push_back(
            -sinCosTurns(0.5f * static_cast<float>(row) / static_cast<float>(rows)).cos);
    std::vector<double> means(columns * rows), rowSums(rows);
    tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
        cancel.throwIfSet("looking at the environment's texture");
        for (std::size_t column = 0; column < columns; ++column)
            means[row * columns + column] = meanOfCell(column, row, steps);
    });
    for (std::size_t row = 0; row < rows; ++row) {
        const double sum =
            std::accumulate(means.begin() + static_cast<std::ptrdiff_t>(row * columns),
                            means.begin() + static_cast<std::ptrdiff_t>((row + 1) * columns), 0.0);
        m_integral += sum / static_cast<double>(columns) * solidAngleOfRow(row);
    }
    m_cumulative.resize(columns * rows);
    m_columnStarts.resize((kParts + 1) * rows);
    tbb::parallel_for(std::size_t{0}, rows,
                      [&](std::size_t row) { rowSums[row] = fillRow(means, row); });
    fillRows(rowSums);
}

double Environment::solidAngleOfRow(std::size_t row) const {
    return 2 * std::numbers::pi *
           (static_cast<double>(m_heights[row + 1]) - static_cast<double>(m_heights[row]));
}

// Returns the sum of the row's weights.
double Environment::fillRow(std::span<const double> means, std::size_t row) {
    const std::size_t columns = m_columns, last = m_rowCount - 1;
    std::vector<double> weights(columns);
    double sum = 0;
    for (std::size_t column = 0; column < columns; ++column) {
        double brightest = 0;
        for (std::size_t y = row > 0 ? row - 1 : 0; y <= std::min(row + 1, last); ++y)
            for (const std::size_t x : {column + columns - 1, column, column + 1})
                brightest = std::max(brightest, means[y * columns + x % columns]);
        weights[column] = std::max(means[row * columns + column], kNeighbourShare * brightest);
        sum += weights[column];
    }
    const double even = 1.0 / static_cast<double>(columns);
    for (double& weight : weights)
        weight = (1 - kEvenShare) * (sum > 0 ? weight / sum : even) + kEvenShare * even;
    accumulate(weights, m_cumulative.data() + row * columns);
    fillStarts(columnsOf(row), m_columnStarts.data() + row * (kParts + 1));
    return sum;
}

void Environment::fillRows(std::span<const double> rowSums) {
    std::vector<double> weights;
    double total = 0;
    for (std::size_t row = 0; row < rowSums.size(); ++row) {
        weights.push_back(rowSums[row] * solidAngleOfRow(row));
        total += weights.back();
    }
    m_rows.resize(rowSums.size());
    m_rowStarts.resize(kParts + 1);
    if (!(total > 0)) return;
    for (std::size_t row = 0; row < rowSums.size(); ++row)
        weights[row] = (1 - kEvenShare) * weights[row] / total +
                       kEvenShare * solidAngleOfRow(row) / (4 * std::numbers::pi);
    accumulate(weights, m_rows.data());
    fillStarts(m_rows, m_rowStarts.data());
}

float Environment::pdfOfCell(std::uint32_t column, std::uint32_t row) const {
    const float solidAngle =
        2.0f * kPi / static_cast<float>(m_columns) * (m_heights[row + 1] - m_heights[row]);
    return shareOf(m_rows, row) * shareOf(columnsOf(row), column) / solidAngle;
}

Vec3f Environment::sample(Vec2f u, float& pdf) const {
    if (m_columns == 0) {
        pdf = 0.25f * kInvPi;
        return sampleUniformSphere(u);
    }
    const std::size_t row = choose(m_rows, m_rowStarts.data(), u.x);
    const std::size_t column =
        choose(columnsOf(row), m_columnStarts.data() + row * (kParts + 1), u.y);
    pdf = pdfOfCell(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
    const float y = m_heights[row] + (m_heights[row + 1] - m_heights[row]) * u.x;
    const float r = std::sqrt(std::max(0.0f, 1.0f - y * y));
    const SinCos turn =
        sinCosTurns((static_cast<float>(column) + u.y) / static_cast<float>(m_columns));
    return toWorld({-r * turn.sin, y, r * turn.cos});
}

float Environment::pdfSolidAngle(const Vec3f& direction) const {
    if (m_columns == 0) return 0.25f * kInvPi;
    const Vec3f local = toLocal(direction);
    const Vec2f uv = toPicture(local);
    const auto cellOf = [](float v, std::uint32_t count) {
        return std::min(static_cast<std::uint32_t>(v * static_cast<float>(count)), count - 1);
    };
    std::uint32_t row = cellOf(uv.y, m_rowCount);
    while (row > 0 && local.y < m_heights[row]) --row;
    while (row + 1 < m_rowCount && local.y >= m_heights[row + 1]) ++row;
    return pdfOfCell(cellOf(uv.x, m_columns), row);
}

}  // namespace pm
