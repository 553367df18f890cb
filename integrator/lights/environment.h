// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/materials/texture_source.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/rgb.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// Light from infinitely far all around. See Environment for the picture's directions.
struct EnvironmentDescription {
    Rgb radiance;  // W m^-2 sr^-1; times the texture where there is one
    std::int32_t texture = kNoTexture;
    Transform toWorld = kIdentityTransform;  // a rotation; its translation means nothing
};

// Of directions that an environment chose, towards which places could receive its light, in how
// many they do.
struct SkyLooks {
    std::size_t asked = 0, seen = 0;

    // So little of it that it is worth knowing where.
    bool isHidden() const { return 2 * seen < asked; }
};

// Light from infinitely far all around: a constant, or a latitude-longitude picture times it.
//
// In the environment's own space the middle of the picture lies towards -z, its right half towards
// +x, its upper edge towards +y; so a camera that isn't turned sees the middle of the picture as it
// is. Its left and right edges meet, its upper and lower rows end at the poles, whatever the
// texture says of what is outside. Directions are chosen in proportion to the picture's mean over
// cells of a table that is even in the picture; within a cell evenly over the solid angle, a small
// share over all directions. Threads: const functions from any, at once.
class Environment {
  public:
    // textures: may be null without a texture; must outlive this. Looks at every texel, in parallel
    // in the calling TBB arena. hasBadTexels: some count as 0, see TextureSource::lookUpOfLight().
    // Throws Error(kCancelled) soon after `cancel` is set.
    Environment(const EnvironmentDescription& description, const TextureSource* textures,
                const CancelCheck& cancel = {}, bool hasBadTexels = false);

    // Radiance that is seen along a unit direction; W m^-2 sr^-1, >= 0.
    Rgb radiance(const Vec3f& direction) const;

    // A unit direction to look along, and its density, sr^-1, which is > 0.
    Vec3f sample(Vec2f u, float& pdfSolidAngle) const;
    float pdfSolidAngle(const Vec3f& direction) const;

    // The same radiance from everywhere.
    bool isEven() const { return m_columns == 0; }
    // Over all directions, of the mean of the channels; W m^-2.
    double integral() const { return m_integral; }

    std::uint64_t memoryBytes() const {
        return (m_cumulative.size() + m_rows.size()) * sizeof(float) +
               m_heights.size() * sizeof(float) +
               (m_columnStarts.size() + m_rowStarts.size()) * sizeof(std::uint16_t);
    }

    // The table has no more cells than this across, half as many down.
    static constexpr std::uint32_t kMostColumns = 2048;

  private:
    Vec2f toPicture(const Vec3f& local) const;
    Vec3f toLocal(const Vec3f& direction) const;
    Vec3f toWorld(const Vec3f& local) const;
    float keptFromPoles(float up) const;
    Rgb texel(Vec2f uv) const;
    void fillTable(const CancelCheck& cancel);
    double meanOfCell(std::size_t column, std::size_t row, std::uint32_t steps) const;
    double solidAngleOfRow(std::size_t row) const;
    double fillRow(std::span<const double> means, std::size_t row);
    void fillRows(std::span<const double> rowSums);
    float pdfOfCell(std::uint32_t column, std::uint32_t row) const;
    std::span<const float> columnsOf(std::size_t row) const {
        return std::span(m_cumulative).subspan(row * m_columns, m_columns);
    }

    Rgb m_scale;
    std::int32_t m_texture = kNoTexture;
    const TextureSource* m_textures = nullptr;
    bool m_hasBadTexels = false;
    float m_halfTexel = 0.5f;  // of the picture's height, and what rounding moves a place by
    Vec3f m_axes[3];           // of the environment's space, in the world's
    double m_integral = 0;
    std::uint32_t m_columns = 0, m_rowCount = 0;  // of the table; 0: all directions alike
    std::vector<float> m_cumulative;              // of the cells of each row, its last is 1
    std::vector<float> m_rows;                    // of the rows
    // Where to look for a number in these: of each of as many parts of [0, 1], the first entry that
    // is beyond its beginning. A search through all of a row would wait for memory at each step.
    std::vector<std::uint16_t> m_columnStarts;  // of each row, kParts + 1
    std::vector<std::uint16_t> m_rowStarts;
    std::vector<float> m_heights;  // of the rows' lower edges, the cosines to -y: -1 ... 1
};

}  // namespace pm
