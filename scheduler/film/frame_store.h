// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "integrator/values/error_scale.h"
#include "integrator/values/rect.h"
#include "scheduler/film/frame_error.h"
#include "scheduler/film/sample_allotment.h"
#include "scheduler/film/zeroed_vector.h"

namespace pm {

// The frame while it is rendered: over a window of pixels, the mean of every channel over the
// passes made so far, and for three of them, the beauty, how much the passes differ.
//
// A pass gives a pixel the mean x_k of its w_k samples. The store holds, for each pixel, sums in
// double that are updated pass by pass:
//     W = sum w_k,   mean = sum w_k x_k / W,   M2 = sum w_k (x_k - mean)^2  (Welford's update [1]).
// With n passes that had samples, and x_k of variance s^2 / w_k, M2 / (n - 1) estimates s^2 without
// bias, and so M2 / ((n - 1) W) the variance of the mean. Where the passes are equally heavy this
// needs no assumption on how variance depends on w_k, so it also holds what the samples of a pass
// share, such as its photons. Where passes avoid what others did (one low-discrepancy sequence over
// several of them) it is too large, never too small.
// For the frame's error (see FrameError) the sums of a pixel's even passes are kept apart.
//
// Adaptive renders give a pixel more samples in the even passes by what its odd passes show, and
// the reverse (see SampleRule). There the sums of the even passes are kept for all channels, and
//     mean = (v_even mean_even + v_odd mean_odd) / (v_even + v_odd),
// v what the passes with samples weigh: 1 each, or by SampleRule where passes share no noise:
// weights that no sample of the pixel decides on, so that this has no bias. Its variance is then
// that of a sample, M2 / (n - 1), times the sum over the halves of (v_half / v)^2 / W_half. An
// atom's samples are allotted as soon as a pass of it is there (allotsAfter), so the store holds
// whole atoms, also those that the window cuts.
//
// At level 0 such a render begins with groups of 2 x 2 pixels: a group's samples count for each of
// its pixels. Where those of a group differ, in what they show or by their spread (isDivided), it
// is divided when samples are allotted; its pixels forget them as soon as they have one of their
// own. That a group whose samples happen to agree is kept is a blur, and a bias.
//
// [1] Welford, "Note on a method for calculating corrected sums of squares and products",
//     Technometrics 4(3), 1962; with weights as West, Communications of the ACM 22(9), 1979.
//
// A pixel's bits depend on its own passes and their order only; the caller's rounding and
// flush-to-zero modes don't enter (FpEnvironment).
// Threads: every member may be called from any thread at any time. Readers see each pixel between
// two passes, never within one; two pixels may be seen after different passes. The passes of one
// pixel must be added one after the other in pass order: the caller sees to that.
class FrameStore {
  public:
    static constexpr std::int32_t kBeautyChannels = 3;

    // window: pixels, coordinates within +-2^29; not empty. channels: floats a pixel, at least
    // kBeautyChannels. beautyFirst: the first of the three channels whose error is told.
    // biasProbeFirst: the first of three that hold their bias probe, -1 where nothing is biased.
    // emissionFirst: the first of three with the part of the beauty that comes from lamps the pixel
    // sees, -1 where that is not told apart. rule: of adaptive renders; there the last 6 channels
    // of a pass are its SeenSamples up to `edges`, added up by halves, which can't be read; with
    // groups one more follows, the contribution: any number from 0 on that is alike where samples
    // show the same. errorScale: of errors, and of the rule in place of its own. Errors:
    // kInvalidArgument outside of that; kOutOfMemory.
    FrameStore(const Rect& window, std::int32_t channels, std::int32_t beautyFirst,
               std::int32_t biasProbeFirst = -1, std::int32_t emissionFirst = -1,
               const std::optional<SampleRule>& rule = std::nullopt,
               const ErrorScale& errorScale = {});

    const Rect& window() const { return m_window; }
    std::int32_t channels() const { return m_channels; }
    // Of adaptive renders.
    const std::optional<SampleRule>& rule() const { return m_rule; }

    // Bytes that a store of this size takes; if adaptive, with a rule that isAlone(), others a
    // little less.
    static std::uint64_t memoryBytes(const Rect& window, std::int32_t channels,
                                     std::int32_t biasProbeFirst = -1, bool adaptive = false,
                                     bool groups = false);

    // Adds pass `pass`, from 0, of the pixels of rect. pixels: for each pixel, row by row, the
    // means of its samples in this pass, channels() floats side by side. weights: for each pixel
    // its number of samples in this pass; 0 (or anything that is not above it, as NaN) where it had
    // none, and its floats are then not looked at. A NaN or infinity in pixels stays in the pixel:
    // whoever makes them replaces and counts bad values before. Errors: kInvalidArgument when rect
    // is not within the window's atoms, if adaptive not of whole ones, or a span has another size.
    void addPass(std::uint32_t pass, const Rect& rect, std::span<const float> pixels,
                 std::span<const float> weights);

    // Copies the means of channelCount channels from firstChannel on; 0 for pixels outside the
    // window and for those that have no sample yet. destination is where the first channel of pixel
    // (rect.x0, rect.y0) goes; the next pixel of the row lies pixelStrideBytes further and the next
    // row rowStrideBytes further. Either may be negative (a picture stored bottom up) and needs no
    // alignment; bytes between the channels written are left alone.
    // Errors: kInvalidArgument for channels that the store does not have.
    void read(const Rect& rect, std::int32_t firstChannel, std::int32_t channelCount,
              float* destination, std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes) const;

    // As read, but the standard error of the mean of the three beauty channels (their unit); 0
    // where it is not known: fewer than two passes with samples.
    void readStandardError(const Rect& rect, float* destination, std::int64_t pixelStrideBytes,
                           std::int64_t rowStrideBytes) const;

    // As read, but what the error of the mean of the three beauty channels may look like: the means
    // of the even and the odd passes, one minus the other, scaled to the variance of the mean of
    // both. Other than standard errors it keeps what pixels have in common. 0 where a half has no
    // sample.
    void readHalfDifference(const Rect& rect, float* destination, std::int64_t pixelStrideBytes,
                            std::int64_t rowStrideBytes) const;

    // As read, but one float: the number of samples so far.
    void readSampleCount(const Rect& rect, float* destination, std::int64_t pixelStrideBytes,
                         std::int64_t rowStrideBytes) const;

    // Samples so far (the sum of the weights); 0 outside the window.
    double sampleCount(std::int32_t x, std::int32_t y) const;

    // Standard error of the mean of the three beauty channels (their unit); nothing outside the
    // window and where fewer than two passes had samples.
    std::optional<std::array<float, 3>> standardError(std::int32_t x, std::int32_t y) const;

    // The samples that the pixels of rect, row by row, are to get in a pass of an adaptive render:
    // how many, and how many the pixel's passes of that half have had so far; of a pixel that is
    // still one of a group neither, as who renders knows. rect within the window's atoms.
    struct NextSamples {
        std::uint32_t had = 0, count = 0;
        bool isOfGroup = false;
    };
    void nextSamples(std::uint32_t pass, const Rect& rect, std::span<NextSamples> next) const;

    // Whether the pixel has no samples but those of its group; false outside the window.
    bool showsGroup(std::int32_t x, std::int32_t y) const;

    // What is known of the frame's error without a reference: of the pixels whose even and odd
    // passes both had samples; nothing where there is no such pixel.
    // inParallel: in the threads of the arena that it is called in; the same bits.
    std::optional<FrameError> estimateError(bool inParallel = false) const;

    // The same pixel by pixel, row by row from the top, as FrameErrorSum::add takes them.
    using ErrorVisitor =
        std::function<void(std::int32_t x, std::int32_t y, const PixelError& pixel)>;
    void visitErrors(const ErrorVisitor& visit) const {
        visitErrors(m_window.y0, m_window.y1, visit);
    }

  private:
    friend class FrameStoreBytes;  // the arrays below as bytes; a new one belongs there too

    // In place of a group's contribution: it has no sample yet; its samples show more than one; it
    // is divided, but the pixel still has its samples only; the pixel has samples of its own.
    static constexpr float kUnseen = -1, kUnlike = -2, kDivided = -3, kOwn = -4;

    // Reads one pixel, index in the window, to floats; called under its band's lock.
    template <typename ReadPixel>
    void readRows(const Rect& rect, std::int32_t floatsPerPixel, float* destination,
                  std::int64_t pixelStrideBytes, std::int64_t rowStrideBytes,
                  ReadPixel readPixel) const;

    void allocate();
    void checkPass(const Rect& rect, std::size_t floats, std::size_t weights) const;
    void addPixel(std::size_t pixel, const float* values, double weight);
    void addToEvenPasses(std::size_t pixel, const float* values, double weight);
    bool isAdaptive() const { return m_rule.has_value(); }
    bool hasGroups() const { return m_rule && m_rule->groups; }
    std::int32_t passChannels() const;
    // What the even and odd passes of a pixel weigh in its mean, if adaptive.
    struct Halves {
        double even = 0, odd = 0;
    };
    Halves halves(std::size_t pixel) const;
    void addWeightOfPass(std::size_t pixel, std::uint32_t pass);
    void allot(const Rect& atom, std::uint32_t passes);
    void allotHalf(const Rect& atom, std::uint32_t passes, std::size_t half);
    void divideGroups(const Rect& atom);
    void noteContribution(std::size_t pixel, float contribution);
    void forget(std::size_t pixel);
    // Where the sum of a pixel's even passes stands; of beauty, probe and, if adaptive, any
    // channel.
    double evenSum(std::size_t pixel, std::int32_t channel) const;
    void readMeans(std::int32_t y, std::vector<NeighbourRows::Pixel>& row) const;
    void visitErrors(std::int32_t begin, std::int32_t end, const ErrorVisitor& visit) const;
    void visitError(std::int32_t x, std::int32_t y, const NeighbourRows& rows,
                    const ErrorVisitor& visit) const;
    double mean(std::size_t pixel, std::int32_t channel) const;
    double halfDifference(std::size_t pixel, std::int32_t beautyChannel) const;
    double varianceOfMean(std::size_t pixel, std::int32_t beautyChannel) const;
    std::size_t pixelIndex(std::int32_t x, std::int32_t y) const;
    std::mutex& bandLock(std::int32_t y) const;

    Rect m_window;
    Rect m_area;                // what is held: the window's atoms
    std::int32_t m_channels{};  // that are read; without SeenSamples
    std::int32_t m_beautyFirst{};
    std::int32_t m_biasProbeFirst{};
    std::int32_t m_emissionFirst{};
    std::optional<SampleRule> m_rule;
    ErrorScale m_errorScale;

    ZeroedVector<double> m_sums;           // sum w_k x_k, for each pixel and channel
    ZeroedVector<double> m_weights;        // W, for each pixel
    ZeroedVector<double> m_deviations;     // M2, for each pixel and beauty channel
    ZeroedVector<std::uint32_t> m_passes;  // n, for each pixel
    // Of even passes. Sums: for each pixel those of beauty, then of the probe; all if adaptive.
    ZeroedVector<double> m_evenSums, m_evenWeights;
    ZeroedVector<std::uint32_t> m_evenPasses;
    // If adaptive: for each pixel of even passes, then of odd ones, the samples a pass and what was
    // seen.
    std::vector<std::uint16_t> m_allotted;
    ZeroedVector<SeenSamples> m_seen;
    // If the rule isAlone(), in the same order: what a pass weighs in the pixel's mean, and the sum
    // of what those weighed that were made.
    std::vector<std::uint16_t> m_passWeights;
    ZeroedVector<double> m_halfWeights;
    // If there are groups: of each pixel the contribution that its group's samples have shown so
    // far, or one of the numbers above.
    std::vector<float> m_groups;

    // One for each row of atoms on the frame's grid: buckets of one row of buckets share a few,
    // which are held for microseconds; others share none.
    std::unique_ptr<std::mutex[]> m_bandLocks;
};

}  // namespace pm
