// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "integrator/values/rect.h"
#include "scheduler/film/compensated_sum.h"

namespace pm {

// How far a frame is from the truth, as relMSE (mean over pixels and channels of
// (x - r)^2 / (r^2 + offset), the offset of an ErrorScale), told without a reference.
//
// What it rests on: the passes fall into two halves, even and odd ones, that share no random
// number. What the halves of a pixel differ by is noise, whatever the samples within a half share
// (photons, low-discrepancy sequences); what they have in common beside the light is bias.
//   noise: with halves of weights v, w and means a, b, E[(a - b)^2] v w / (v + w)^2 is the variance
//          of the pixel's mean.
//   bias:  each half's mean d of the probe, the same picture with radii narrowed by sqrt(2) minus
//          the picture. E[d_even d_odd] is its square, free of noise; bias squared is so many times
//          as much (kBiasPerProbe, frame_store_error.cpp).
// Both are divided by m^2 + offset, m a stand-in for the reference out of the pixel's mean and its
// neighbours' (see standIn). Where a pixel sees a lamp neither will do (see SeldomLight).
//
// What it does not see: light that no pass has found yet; bias that narrowing by sqrt(2) doesn't
// change. Light finer than the narrower radius is blurred at both: there the error is at least what
// is told (see unresolvedShare). Where a handful of pixels makes most of the error, as rims of
// small lamps in mirrors and glass do, it knows their error to a factor only: that of the rest is
// in noiseTrimmed.
struct FrameError {
    double noise = 0;         // relMSE of noise
    double noiseTrimmed = 0;  // the same without the pixels that have most of it, 1 in 1000
    // relMSE of bias. Its own noise may make it negative: then nothing is known but that it is
    // small.
    double bias = 0;
    // Of `bias`, from squares of 32 x 32 pixels; nothing where there is one square only.
    std::optional<double> biasStandardError;
    // relMSE at most of what is missing since light was cut off that nothing can end; whoever
    // renders knows it.
    double cut = 0;
    // How well `noise` is known, from the same squares: its standard error is noise * sqrt(2 / n)
    // of n degrees of freedom. Nothing where there is no noise or one square only.
    std::optional<double> noiseDegreesOfFreedom;
    // Of the pixels, those whose light is finer than the narrower radius shows.
    double unresolvedShare = 0;

    double total() const { return noise + std::max(0.0, bias) + cut; }
    double totalTrimmed() const { return noiseTrimmed + std::max(0.0, bias) + cut; }
    // Whether the truth may be far above: more pixels are unresolved than the trimmed figure drops.
    bool isLowerBound() const;
};

// What one pixel adds: the sums over its three channels.
struct PixelError {
    double noise = 0, bias = 0;
    bool isUnresolved = false;
};

// Of a square of pixels.
struct ErrorSquare {
    double noise = 0, bias = 0, pixels = 0, unresolved = 0;
    void add(const PixelError& pixel);
};

// What the squares tell beside the means over the frame: fills the last members of `error`, whose
// means are there.
void addSpread(std::span<const ErrorSquare> squares, FrameError& error);

// Of the pixels, those left out of the trimmed figure.
inline constexpr double kErrorTrimmedShare = 0.001;
// Side of the squares whose shares of the bias count as independent: wider than most blurs.
inline constexpr std::int32_t kErrorSquarePixels = 32;

// Adds up the pixels of a frame, given in one fixed order.
class FrameErrorSum {
  public:
    // window: of the frame; expected: at most so many pixels will come.
    explicit FrameErrorSum(const Rect& window);

    void add(std::int32_t x, std::int32_t y, const PixelError& pixel);
    // Nothing where no pixel was added.
    std::optional<FrameError> result() const;

  private:
    double trimmedNoise() const;

    Rect m_window;
    std::int32_t m_columns;
    std::vector<ErrorSquare> m_squares;
    std::vector<double> m_noise;  // of each pixel
};

// What is like a pixel, by its up to 8 neighbours: an outlier is neither their mean nor within what
// they span, even when one neighbour is an outlier too.
struct Neighbours {
    double low = 0, high = 0;  // the second lowest and the second highest; of few the outermost
    double mean = 0;
    std::int32_t count = 0;
};

// A pixel that few samples saw a lamp from: at its rim, in a mirror or through glass. Its own mean
// is the worse a guess the larger the error is: had the lamp's true share of the pixel been a tenth
// of what came up by chance, the relative error would be a hundredfold of what the mean makes of
// it. So the mean of 1 / (r^2 + offset) over what r may be. How many samples saw the lamp is told
// from the noise, (mean / its standard error)^2 as of a Poisson count; where any share of the pixel
// was as likely as another, the count to be expected has the Gamma distribution of shape one more.
class SeldomLight {
  public:
    // Square of the pixel's mean light from lamps and variance of its mean, each summed over the
    // channels; both above 0.
    SeldomLight(double lampSquare, double variance);

    // Mean of 1 / (r^2 + offset), r the truth of a channel whose means are `lamp` of lamps and
    // `rest` of all else.
    double meanInverse(double lamp, double rest, double offset) const;

  private:
    static constexpr std::size_t kNodes = 128;
    double m_seen;
    bool m_many;  // so many that the mean is as good as the truth
    std::array<double, kNodes> m_counts{}, m_weights{};
};

// Finds neighbours in rows that are given from the top, one by one.
class NeighbourRows {
  public:
    // The mean beauty of a pixel, where it has samples.
    struct Pixel {
        double values[3]{};
        bool sampled = false;
    };

    explicit NeighbourRows(std::size_t width);

    // The row that enters next; to be filled by the caller.
    std::vector<Pixel>& nextRow();
    // Around pixel x of the row that entered one before the latest.
    Neighbours around(std::size_t x, std::size_t channel) const;

  private:
    std::vector<Pixel> m_rows[3];
    std::size_t m_next = 0;
};

}  // namespace pm
