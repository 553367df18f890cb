// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/atom_noise.h"

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

constexpr std::size_t kSide = kAtomSizePixels;
// The least that low-discrepancy sequences are believed to leave of a variance.
constexpr double kLeastOfSequence = 0.02;
// What n samples have missed: of an edge of contrast D this share of D^2 over n (where it lies the
// pixel's own square is by so much of D^2 larger than it looks), and this share over n of the
// variance that the neighbours show.
constexpr double kShareOfEdge = 0.04, kSquareOfEdge = 0.1, kShareOfNeighbours = 0.015;
// Where samples meet unlike surfaces there is an edge, and beside it there may be what none has
// met: the lit rim of a wall. The atom's edges are taken to have so much relative variance, as if
// so many samples had shown that, and each of their pixels gets some samples of what they have
// together.
constexpr double kSamplesOfEdge = 2, kVarianceOfEdge = 0.8, kSamplesOfVariance = 128;
// Pixels of an atom that a line cuts. Where far more hold edges it is the surface that is so, of
// leaves or tiles, and what their samples show counts for more: by the square.
constexpr double kMostOfALine = 16;

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

// Whether it has pixels of the atom on all sides.
bool isWithin(std::size_t pixel) {
    const std::size_t x = pixel % kSide, y = pixel / kSide;
    return x > 0 && x + 1 < kSide && y > 0 && y + 1 < kSide;
}

std::size_t colourOf(std::size_t pixel) {
    return (pixel % kSide + pixel / kSide) % 2;
}

}  // namespace

double relativeVariance(const SeenSamples& seen, double offset) {
    if (!(seen.samples > 1)) return 0;
    const double share = 1 / seen.samples;
    double ofMean = 0;
    for (const double sum : seen.sums) ofMean += (sum * share) * (sum * share);
    const double apart = std::max(0.0, seen.square * share - ofMean);
    return apart / ((1 - share) * (ofMean + 3 * offset));
}

AtomNoise::AtomNoise(std::span<const SeenSamples, kAtomPixels> seen, const ErrorScale& scale)
    : m_seen(seen), m_offset(scale.offset()) {
    for (std::size_t i = 0; i < kAtomPixels; ++i) {
        m_scales[i] = 3 * m_offset;
        for (std::size_t c = 0; c < 3; ++c) {
            m_means[i][c] = seen[i].sums[c] / seen[i].samples;
            m_scales[i] += m_means[i][c] * m_means[i][c];
        }
        m_ofOwn[i] = m_variance[i] = relativeVariance(seen[i], m_offset);
    }
    for (std::size_t i = 0; i < kAtomPixels; ++i) {
        for (Together* const to : {&m_all, &m_ofColour[colourOf(i)]}) {
            to->add(seen[i].samples, m_ofOwn[i]);
            if (isWithin(i)) to->addBend(m_ofOwn[i], bend(i), m_scales[i]);
        }
        if (seen[i].samples > 1) continue;
        SeenSamples about;
        visitAround(i, [&](std::size_t at) { addTo(about, seen[at]); });
        m_variance[i] = relativeVariance(about, m_offset);
    }
    for (Together* const together : {&m_all, &m_ofColour[0], &m_ofColour[1]}) together->finish();
    m_ofEdges = varianceOfEdges();
}

double AtomNoise::varianceOfEdges() const {
    double count = 0, samples = 0, sum = 0;
    for (std::size_t i = 0; i < kAtomPixels; ++i) {
        if (!(m_seen[i].edges > 0)) continue;
        ++count;
        samples += m_seen[i].samples;
        sum += m_seen[i].samples * m_ofOwn[i];
    }
    if (count == 0) return 0;
    const double share = std::min(1.0, kMostOfALine / count);
    const double before = kSamplesOfVariance * share * share;
    return (before * kVarianceOfEdge + sum) / (before + samples);
}

// Half of it what the pixels around show by themselves, half by what they differ from each other,
// since an edge between two pixels mostly cuts one of them.
double AtomNoise::around(std::size_t pixel, bool withIt) const {
    const Values& variances = withIt ? m_variance : m_ofOwn;
    SeenSamples together;
    double sum = 0, count = 0;
    visitAround(pixel, [&](std::size_t at) {
        if (at == pixel && !withIt) return;
        addTo(together, m_seen[at]);
        sum += variances[at];
        ++count;
    });
    return (sum / count + relativeVariance(together, m_offset)) / 2;
}

// The square of how much the pixel's mean differs from the middle of two others on either side,
// which knows no gradient: as the variance of one mean; of pixels within the atom. Both ways over
// corners, where the fields of a chessboard are of one colour.
double AtomNoise::bend(std::size_t pixel) const {
    double square = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto from = [&](std::size_t apart) {
            return m_means[pixel - apart][c] - 2 * m_means[pixel][c] + m_means[pixel + apart][c];
        };
        square += (from(kSide + 1) * from(kSide + 1) + from(kSide - 1) * from(kSide - 1)) / 2;
    }
    // Such a difference has six times the variance of one mean.
    return square / 6;
}

double AtomNoise::apart(std::size_t a, std::size_t b) const {
    double square = 0;
    for (std::size_t c = 0; c < 3; ++c)
        square += (m_means[a][c] - m_means[b][c]) * (m_means[a][c] - m_means[b][c]);
    return std::sqrt(square);
}

// An edge lies about where means of neighbours differ by more than they do from the next pixels on
// either side: less where a sample has met it, and not at all in a gradient.
double AtomNoise::contrast(std::size_t pixel) const {
    double most = 0;
    for (const std::size_t stride : {std::size_t{1}, kSide}) {
        // The pixel's place along the row, then along the column, and where that begins.
        const std::size_t place = pixel / stride % kSide, first = pixel - place * stride;
        const auto step = [&](std::size_t at) {
            return at + 1 < kSide ? apart(first + at * stride, first + (at + 1) * stride) : 0.0;
        };
        const auto beside = [&](std::size_t at) {  // an edge between that pixel and the next
            const double before = at > 0 ? step(at - 1) : 0;
            return step(at) - std::max(before, step(at + 1));
        };
        most = std::max(most, beside(place));
        if (place > 0) most = std::max(most, beside(place - 1));
    }
    return most;
}

double AtomNoise::missed(std::size_t pixel) const {
    double ofNeighbours = 0, count = 0;
    visitAround(pixel, [&](std::size_t at) {
        if (at == pixel) return;
        ofNeighbours += m_ofOwn[at] * m_scales[at];
        ++count;
    });
    const double step = contrast(pixel), square = step * step, scale = m_scales[pixel];
    const double ofEdge = square / (scale + kSquareOfEdge * square);
    return (kShareOfEdge * ofEdge + kShareOfNeighbours * ofNeighbours / count / scale) /
           m_seen[pixel].samples;
}

void AtomNoise::Together::add(double samples, double variance) {
    ++m_count;
    m_samples += samples;
    m_mean += variance;
    m_squares += variance * variance;
}

void AtomNoise::Together::addBend(double variance, double bend, double scale) {
    m_within += variance;
    m_bends += bend / scale;
    m_absoluteWithin += variance * scale;
    m_absoluteBends += bend;
}

void AtomNoise::Together::finish() {
    m_mean /= m_count;
    const double samples = m_samples / m_count, square = m_mean * m_mean;
    if (!(samples > 1 && m_mean > 0)) return;
    // Of n normal numbers the estimates of a variance v vary by 2 v^2 / (n - 1).
    const double ofNoise = 2 / (samples - 1) * square, apart = m_squares / m_count - square;
    m_believed = apart > ofNoise ? 1 - ofNoise / apart : 0;
    // Where all noise lies at the atom's border bends tell nothing.
    if (!(m_within > 0)) return;
    const double left = std::min(1.0, samples * m_bends / m_within);
    // Squared: of more samples it cures all the more.
    m_ofSequence = std::max(kLeastOfSequence, left * left);
    // Where means differ no more than samples of one mean would, nothing else says that pixels are
    // unlike: it may be light that few of them have met.
    m_believed *= std::clamp(samples * m_absoluteBends / m_absoluteWithin - 1, 0.0, 1.0);
}

double AtomNoise::ofPixel(std::size_t pixel, double neighbours) const {
    const double own = m_seen[pixel].samples, known = own + neighbours;
    const double variance = (own * m_variance[pixel] + neighbours * around(pixel, true)) / known;
    if (!(m_seen[pixel].edges > 0)) return variance;
    return (known * variance + kSamplesOfEdge * m_ofEdges) / (known + kSamplesOfEdge);
}

// One-way analysis of variance: within passes and between them. The standard error is that of
// normal samples, independent between pixels.
double AtomNoise::shared(double samplesOfPass) const {
    if (!(samplesOfPass > 1)) return 0;
    double sum = 0, errors = 0, count = 0;
    for (std::size_t i = 0; i < kAtomPixels; ++i) {
        const SeenSamples& seen = m_seen[i];
        const double passes = seen.samples / samplesOfPass;
        if (seen.edges > 0 || !(passes > 1)) continue;
        double ofMean = 0;
        for (const double s : seen.sums) ofMean += s * s / seen.samples;
        const double scale = samplesOfPass * m_scales[i];
        const double within = (seen.square - seen.ofPasses) / (seen.samples - passes) / scale;
        const double between = (seen.ofPasses - ofMean) / (passes - 1) / scale;
        sum += between - within;
        errors += 2 * within * within / (passes - 1);
        ++count;
    }
    return count > 0 ? std::max(0.0, (sum - std::sqrt(errors)) / count) : 0.0;
}

AtomNoise::Expected AtomNoise::evened(std::size_t pixel) const {
    const Together& others = m_ofColour[1 - colourOf(pixel)];
    if (m_all.isEven() && others.isEven()) return {m_all.expected(0), others.expected(0)};
    return {m_all.expected(m_variance[pixel] + missed(pixel)),
            others.expected(around(pixel, false))};
}

}  // namespace pm
