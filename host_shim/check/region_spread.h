// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// R, G and B of one size, values row by row, each over `window`.
struct Beauty {
    PixelRect window;
    std::array<std::span<const float>, 3> values;
};
// The picture lives longer. Errors: kBadInput when R, G or B is missing.
Beauty beautyOf(const Picture& picture);

// Squares of a window, those at its right and lower end smaller; R, G and B apart. side 0: one
// region, the whole.
class RegionGrid {
  public:
    RegionGrid(const PixelRect& window, std::int32_t side);

    std::int32_t columns() const { return m_columns; }
    std::int32_t rows() const { return m_rows; }
    PixelRect rect(std::int32_t column, std::int32_t row) const;
    // Row by row.
    PixelRect rectOf(std::size_t region) const;
    // Means over the regions, row by row, three values each.
    std::vector<double> means(const Beauty& picture) const;

  private:
    PixelRect m_window;
    std::int32_t m_side{}, m_columns{}, m_rows{};
};

// What regions of a scene's picture are from one seed to the next: means and variances over renders
// that differ in the seed alone. So all that pixels of a render have in common is in it (gather
// points, photons, what a pilot decided), which standard errors pixel by pixel don't know.
struct RegionSpread {
    std::int32_t side{};                 // 0: the whole picture
    std::int32_t renders{};              // at least 3
    std::vector<double> mean, variance;  // as RegionGrid::means has them; of one render
    std::vector<double> stored;          // the means of the picture that is kept
    // Standard errors beyond which a region is no chance.
    double limit{};
};

// means: of each render, the one that is kept first. The limit is what chance alone passes in one
// of 10^6 pictures, by Student's t with the renders less one as degrees of freedom and corrected
// for the number of regions; or half as much again as any of the renders is off by from the others
// where that is more. Errors: kInternal for fewer than 3 renders.
RegionSpread spreadOf(const PixelRect& window, std::int32_t side,
                      const std::vector<std::vector<double>>& means);

struct RegionFinding {
    PixelRect rect;
    int channel{};      // 0 to 2
    double z{};         // standard errors that it is off by, signed
    double relative{};  // of the mean, signed
};

// The region of a new render with the same settings that is off by most standard errors. floor:
// what is no difference, in the values' unit.
RegionFinding furthestRegion(const PixelRect& window, const RegionSpread& spread,
                             const std::vector<double>& means, double floor = 0);

// The region that differs most, relative to its value; of pictures that should be the same.
RegionFinding mostChangedRegion(const PixelRect& window, std::int32_t side,
                                const std::vector<double>& wanted, const std::vector<double>& got);
// So many of them, each by its colour that differs most, the most changed first; those that differ.
std::vector<RegionFinding> changedRegions(const PixelRect& window, std::int32_t side,
                                          const std::vector<double>& wanted,
                                          const std::vector<double>& got, std::size_t most);

// The relative change of one region that is beyond the limit, of the regions that are not black the
// median; 0 when all are.
double seenChange(const RegionSpread& spread);

// "region 16,32 to 32,48: G is 2.03 % brighter".
std::string describe(const RegionFinding& finding);

}  // namespace pm::host
