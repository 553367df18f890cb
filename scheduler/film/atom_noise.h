// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "integrator/values/error_scale.h"
#include "scheduler/buckets/bucket_grid.h"

namespace pm {

// What one half of the passes, the even or the odd ones, has seen of a pixel by the samples that it
// has in any case.
struct SeenSamples {
    double samples = 0;  // their number
    double sums[3]{};    // of the beauty
    double square = 0;   // sum over samples and channels of the beauty squared
    double edges = 0;    // of the passes, those whose samples met unlike surfaces
    // Sum over passes and channels of the square of a pass's sum over its samples' number.
    double ofPasses = 0;
};

// Relative variance of samples taken together: over r^2 + offset, r their mean, the mean of the
// channels; 0 of fewer than two. offset: of an ErrorScale.
double relativeVariance(const SeenSamples& seen, double offset);

// What the seen samples of an atom's 8 x 8 pixels, row by row, lead to expect of the relative
// variance of each pixel's samples.
class AtomNoise {
  public:
    AtomNoise(std::span<const SeenSamples, kAtomPixels> seen, const ErrorScale& scale);

    // By the pixel's own samples and by its neighbours, which count as so many of its own; of a
    // pixel with an edge also by what the atom's edges have shown, and are taken for before.
    double ofPixel(std::size_t pixel, double neighbours) const;

    // Relative variance that a pass's mean has by what its samples share, of so many samples each:
    // what passes differ by, and their samples don't explain. A mean over the atom's pixels without
    // edges, which sequences cure, less what its standard error is by those samples; 0 before a
    // second pass.
    double shared(double samplesOfPass) const;

    struct Expected {
        double byAll = 0;
        double byOthers = 0;  // by other pixels alone: nothing that this one has seen has a part
    };

    // The same, where passes share no noise; by all: of its own samples and of an edge that they
    // may have missed, as far as the means of its neighbours tell of one. What the pixel differs by
    // from all of the atom counts only as far as pixels differ more than by the noise of few
    // samples (as James and Stein's estimator does, taking that for normal noise), and as their
    // means differ more than such samples would make them: even noise comes out even, also light
    // that few have met. And it is lowered by how much less than variance / n the means of n
    // samples differ between pixels, beside gradients: what low-discrepancy sequences cure.
    // By others: by the pixels around, and in place of all of the atom the fields of the other
    // colour of a chessboard.
    Expected evened(std::size_t pixel) const;

  private:
    using Values = std::array<double, kAtomPixels>;

    // What pixels show together of their variances.
    class Together {
      public:
        void add(double samples, double variance);
        // Of a pixel within; scale: what its relative variance is over.
        void addBend(double variance, double bend, double scale);
        void finish();
        // Of every pixel the same is expected.
        bool isEven() const { return m_believed == 0; }
        double expected(double shown) const {
            return m_ofSequence * (m_mean + m_believed * (shown - m_mean));
        }

      private:
        double m_count = 0, m_samples = 0, m_squares = 0;
        // Sums of variances and of bends, relative and not.
        double m_within = 0, m_bends = 0, m_absoluteWithin = 0, m_absoluteBends = 0;
        double m_mean = 0;        // of variances
        double m_believed = 1;    // of what one differs from the mean by
        double m_ofSequence = 1;  // what low-discrepancy sequences leave of a variance
    };

    double varianceOfEdges() const;
    double around(std::size_t pixel, bool withIt) const;
    double bend(std::size_t pixel) const;
    double apart(std::size_t a, std::size_t b) const;  // their means
    double contrast(std::size_t pixel) const;          // of an edge that may lie in it
    double missed(std::size_t pixel) const;            // relative variance

    std::span<const SeenSamples, kAtomPixels> m_seen;
    double m_offset;  // of relMSE's denominator
    std::array<std::array<double, 3>, kAtomPixels> m_means{};
    Values m_scales{};    // sum over the channels of r^2 + offset
    Values m_ofOwn{};     // variances of the pixels' samples
    Values m_variance{};  // the same, or of what is around where one sample has no spread
    Together m_all;
    std::array<Together, 2> m_ofColour;  // of the chessboard's fields
    double m_ofEdges = 0;                // relative variance of pixels with edges, together
};

}  // namespace pm
