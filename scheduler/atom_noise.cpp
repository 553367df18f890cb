// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/atom_noise.h"

#include <algorithm>

#include "scheduler/frame_error.h"

namespace pm {
namespace {

constexpr std::size_t kSide = kAtomSizePixels;
// The least that low-discrepancy sequences are believed to leave of a variance.
constexpr double kLeastOfSequence = 0.02;

// Calls visit with each pixel of the 3 x 3 around this one that lies in the atom.
template <typename Visit>
void visitAround(std::size_t pixel, Visit visit) {
    const std::size_t x = pixel % kSide, y = pixel / kSide;
    for (std::size_t j = y - std::min<std::size_t>(y, 1); j <= std::min(kSide - 1, y + 1); ++j)
        for (std::size_t i = x - std::min<std::size_t>(x, 1); i <= std::min(kSide - 1, x + 1); ++i)
            visit(j * kSide + i);
}

void addTo(SeenSamples& sum, const SeenSamples& seen) {
    sum.samples += seen.samples;
    for (std::size_t c = 0; c < 3; ++c) sum.sums[c] += seen.sums[c];
    sum.square += seen.square;
}

std::size_t colourOf(std::size_t pixel) {
    return (pixel % kSide + pixel / kSide) % 2;
}

}  // namespace

double relativeVariance(const SeenSamples& seen) {
    if (!(seen.samples > 1)) return 0;
    const double share = 1 / seen.samples;
    double ofMean = 0;
    for (const double sum : seen.sums) ofMean += (sum * share) * (sum * share);
    const double apart = std::max(0.0, seen.square * share - ofMean);
    return apart / ((1 - share) * (ofMean + 3 * kRelMseOffset));
}

AtomNoise::AtomNoise(std::span<const SeenSamples, kAtomPixels> seen) : m_seen(seen) {
    const Values bendOf = bends();
    for (std::size_t i = 0; i < kAtomPixels; ++i) {
        m_ofOwn[i] = m_variance[i] = relativeVariance(seen[i]);
        for (Together* const to : {&m_all, &m_ofColour[colourOf(i)]})
            to->add(seen[i].samples, m_ofOwn[i], bendOf[i]);
        if (seen[i].samples > 1) continue;
        SeenSamples about;
        visitAround(i, [&](std::size_t at) { addTo(about, seen[at]); });
        m_variance[i] = relativeVariance(about);
    }
    for (Together* const together : {&m_all, &m_ofColour[0], &m_ofColour[1]}) together->finish();
}

// Half of it what the pixels around show by themselves, half by what they differ from each other,
// since an edge between two pixels mostly cuts one of them.
AtomNoise::Expected AtomNoise::around(std::size_t pixel) const {
    SeenSamples together;
    double sum = 0, sumOfOwn = 0, count = 0;
    visitAround(pixel, [&](std::size_t at) {
        if (at == pixel) return;
        addTo(together, m_seen[at]);
        sum += m_variance[at];
        sumOfOwn += m_ofOwn[at];
        ++count;
    });
    const double byOthers = (sumOfOwn / count + relativeVariance(together)) / 2;
    addTo(together, m_seen[pixel]);
    sum += m_variance[pixel];
    return {(sum / (count + 1) + relativeVariance(together)) / 2, byOthers};
}

// Of each pixel that is not at the atom's border, the square of how much its mean differs from the
// middle of two others on either side, which knows no gradient: relative, as the variance of one
// mean. Both ways over corners, where the fields of a chessboard are of one colour.
AtomNoise::Values AtomNoise::bends() const {
    std::array<std::array<double, 3>, kAtomPixels> means;
    for (std::size_t i = 0; i < kAtomPixels; ++i)
        for (std::size_t c = 0; c < 3; ++c) means[i][c] = m_seen[i].sums[c] / m_seen[i].samples;
    Values squares{};
    for (std::size_t i = kSide; i < kAtomPixels - kSide; ++i) {
        if (i % kSide == 0 || i % kSide + 1 == kSide) continue;
        double square = 0, ofMean = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double twice = 2 * means[i][c];
            const double falling = means[i - kSide - 1][c] - twice + means[i + kSide + 1][c];
            const double rising = means[i - kSide + 1][c] - twice + means[i + kSide - 1][c];
            square += (falling * falling + rising * rising) / 2;
            ofMean += means[i][c] * means[i][c];
        }
        // Such a difference has six times the variance of one mean.
        squares[i] = square / 6 / (ofMean + 3 * kRelMseOffset);
    }
    return squares;
}

void AtomNoise::Together::add(double samples, double variance, double bend) {
    ++m_count;
    m_samples += samples;
    m_mean += variance;
    m_squares += variance * variance;
    m_bends += bend;
}

void AtomNoise::Together::finish() {
    m_mean /= m_count;
    const double samples = m_samples / m_count, square = m_mean * m_mean;
    if (!(samples > 1 && m_mean > 0)) return;
    // Of n normal numbers the estimates of a variance v vary by 2 v^2 / (n - 1).
    const double ofNoise = 2 / (samples - 1) * square, apart = m_squares / m_count - square;
    m_believed = apart > ofNoise ? 1 - ofNoise / apart : 0;
    // Only the pixels within have a bend.
    constexpr double kWithin = static_cast<double>((kSide - 2) * (kSide - 2)) / kAtomPixels;
    const double ofMeans = m_bends / (m_count * kWithin);
    const double left = std::min(1.0, samples * ofMeans / m_mean);
    // Squared: of more samples it cures all the more.
    m_ofSequence = std::max(kLeastOfSequence, left * left);
}

double AtomNoise::pooled(std::size_t pixel, double around, double neighbours) const {
    const double own = m_seen[pixel].samples;
    return (own * m_variance[pixel] + neighbours * around) / (own + neighbours);
}

double AtomNoise::ofPixel(std::size_t pixel, double neighbours) const {
    return pooled(pixel, around(pixel).byAll, neighbours);
}

AtomNoise::Expected AtomNoise::evened(std::size_t pixel, double neighbours) const {
    const Together& others = m_ofColour[1 - colourOf(pixel)];
    if (m_all.isEven() && others.isEven()) return {m_all.expected(0), others.expected(0)};
    const Expected about = around(pixel);
    return {m_all.expected(pooled(pixel, about.byAll, neighbours)),
            others.expected(about.byOthers)};
}

}  // namespace pm
