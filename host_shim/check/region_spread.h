// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/pictures/picture.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pm::host {

// Squares of a picture's data window, those at its right and lower end smaller; R, G and B apart.
// side 0: one region, the whole.
class RegionGrid {
  public:
    RegionGrid(const PixelRect& window, std::int32_t side);

    std::int32_t side() const { return m_side; }
    std::int32_t columns() const { return m_columns; }
    std::int32_t rows() const { return m_rows; }
    PixelRect rect(std::int32_t column, std::int32_t row) const;
    // Means over the regions, row by row, three values each. The picture has R, G, B over `window`.
    std::vector<double> means(const Picture& picture) const;

  private:
    PixelRect m_window;
    std::int32_t m_side{}, m_columns{}, m_rows{};
};

// What regions of a scene's picture are from one seed to the next: means and variances over renders
// that differ in the seed alone. So all that pixels of a render have in common is in it (gather
// points, photons, what a pilot decided), which standard errors pixel by pixel don't know.
struct RegionSpread {
    std::int32_t side{};
    std::int32_t renders{};              // at least 2
    std::vector<double> mean, variance;  // as RegionGrid::means has them; of one render
};

// Errors: kInternal for fewer than 2 renders.
RegionSpread spreadOf(const RegionGrid& grid, const std::vector<std::vector<double>>& means);

struct RegionFinding {
    PixelRect rect;
    int channel{};      // 0 to 2
    double z{};         // standard errors that it is off by
    double relative{};  // of the mean, signed
};

// The region of a new render with the same settings that is off by most standard errors, if that
// is more than `threshold`. A region's variance is taken as no smaller than the mean of those
// around it: of some renders alone it may come out far too small.
std::optional<RegionFinding> furthestRegion(const RegionGrid& grid, const RegionSpread& spread,
                                            const std::vector<double>& means, double threshold);

}  // namespace pm::host
