// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>

#include "integrator/values/error_scale.h"
#include "scheduler/film/atom_noise.h"

namespace pm {

// Dynamic anti-aliasing: how many samples a pixel gets in each pass, by how much its samples
// differed so far. Levels as in the paper of Yavuz et al. 2010, section 4 (P12, P13): level l is
// 4^(l-1) samples in every four passes.
//
// A pixel that decides by the samples it then keeps loses rare light. So even passes decide for odd
// ones and the reverse: the two share no random number, and the weight of a half in the mean is its
// number of passes, whatever its samples (FrameStore; but see the last points). Of the half that
// decides only those samples count that it has in any case, at the least level: how many more it
// has was decided by the half that it decides for. It does so after every pass for the next.
//
// The rule: of N samples in four passes whose relative spread is s, one more lowers the squared
// relative error by s^2 / N^2. A pixel gets samples until that is less than threshold^2, so
// N = s / threshold: the allotment for which the sum of the squared errors is least for the same
// number of samples, were s known and noise like 1/N. But few samples tell badly which pixels are
// noisy, and a low-discrepancy sequence cures edges: so in a pass the root of 6 N / 4, up to a
// spread of 0.7; light that few samples meet has more than that, and there N goes on with s. From
// the third pass on, where samples have met an edge, it does so from a spread of 0.25 on: beside
// edges such light is common.
//
// Relative means: to sqrt(r^2 + offset), r the mean, as in relMSE (ErrorScale). The first passes
// show little: after two passes the threshold is halved, after four divided by sqrt(8). Samples are
// rounded to a power of two: low-discrepancy sequences are at their best there, and a pixel that
// needs no more samples than another is not to have some more.
//
// Where passes differ by more than their samples explain, by photons, more samples of a pass don't
// help. With r^2 the relative variance of that, t the time of a pass without samples, u that of one
// sample and s / q samples a pass, error times time, (r^2 + q s)(t + u s / q), is least at
// q = r sqrt(u / t); so q, four of the thresholds, is r at least. What r is the other half tells,
// once it has two passes.
//
// A pixel whose samples met unlike surfaces holds an edge, and few samples tell little of how much
// light differs there: it is taken to differ much until those of the atom's edges have shown more.
//
// That is so where the samples of a pass share noise, such as that of its photons: more samples
// don't lower it, more passes do. Where they share none (isAlone) a pixel's passes are as good as
// one, and all that counts is how many samples a pixel has beside others. So there
// - samples are allotted anew after passes 1, 2, 4, 8, ... only: more often gains nothing;
// - the threshold T falls: a third of it for the second pass, an eleventh for the third and fourth,
//   a 24th after; N = 16 (s / (16 T))^(3/4), as the squared error falls like N^(-5/3), not like
//   1/N; a second pass has at most 16 samples;
// - noise that is even gets samples that are even: few samples tell little of one pixel's spread,
//   but much of the spread of an atom's 64. What a pixel differs by from them counts only as far as
//   the pixels differ more than normal noise would make them, and as their means differ more than
//   their samples explain (AtomNoise);
// - where neighbours' means step an edge may lie that the samples have missed: the pixel's variance
//   is taken to be larger;
// - s^2 is lowered by how much less than s^2 / N the means of N samples vary between pixels: a
//   low-discrepancy sequence cures smooth light by itself;
// - there are steps between the powers of two, 3/2 of them, and the passes of a half make up for
//   what earlier ones lacked (madeUp);
// - passes weigh in a pixel's mean by what the rule allots by other pixels alone: the pixel's own
//   samples have no part in it, and those of others are independent, so there is no bias.
struct SampleRule {
    std::uint32_t least = 1;  // samples of a pixel in a pass, up to 65535
    std::uint32_t most = 1;   // as well, at least `least`; of a half's passes in the mean
    double threshold = 0.01;  // > 0
    // At first, pixels are taken together in groups of 2 x 2, on even coordinates.
    bool groups = false;
    // The samples of a pass share noise.
    bool sharesNoise = true;
    ErrorScale errorScale{};  // of what spreads are relative to

    // Pixels have samples of their own in each pass, which share no noise.
    bool isAlone() const { return !sharesNoise && least > 0; }
};

// The rule for levels from least to most, 0 to 6. Of levels 0, where it begins with groups, and 1,
// less than a sample a pass, the rule has none: who renders knows in which passes they come.
SampleRule sampleRule(std::uint32_t leastLevel, std::uint32_t mostLevel, double threshold,
                      bool sharesNoise = true);

// Errors: kInvalidArgument for numbers that are not allowed.
void checkSampleRule(const SampleRule& rule);

// Whether the samples of a group differ so much that it is divided: by their spread, a pixel would
// get the 16 samples of level 3. A group blurs what is even, and noise alone is not to divide it.
bool isDivided(const SampleRule& rule, const SeenSamples& even, const SeenSamples& odd);

// Whether samples are allotted anew after so many passes: if isAlone() after 1, 2, 4, 8, ... for
// all that follow, else after each for the next.
bool allotsAfter(const SampleRule& rule, std::uint32_t passes);

// What is known of a pixel's noise, relative to the root of relMSE's denominator.
struct PixelSpread {
    double ofSamples = 0;  // standard deviation of one
    double shared = 0;     // that of a pass's mean by what its samples share
    bool hasEdge = false;  // samples have met unlike surfaces
};

// Samples a pass of a pixel after so many passes.
std::uint16_t samplesOfSpread(const SampleRule& rule, std::uint32_t passes,
                              const PixelSpread& spread);

// What a pixel gets in a pass, where it is allotted so much for each pass of that half and has had
// `had` in those before: if isAlone(), what is lacking to that, at least the least, at most twice
// what is allotted. Of samples, and of the weights of passes.
double madeUp(const SampleRule& rule, std::uint32_t pass, double had, double allotted);

// Samples a pass of the pixels of one atom of 8 x 8, row by row, after so many passes, by what the
// other half of them has seen. A pixel's neighbours count where they are in the atom: so a picture
// does not depend on crop or buckets. weights, if isAlone(): what such a pass weighs in the mean of
// a pixel, by the same rule but without what that pixel itself has seen.
void allotSamples(const SampleRule& rule, std::uint32_t passes,
                  std::span<const SeenSamples, kAtomPixels> seen, std::span<std::uint16_t> samples,
                  std::span<std::uint16_t> weights = {});

}  // namespace pm
