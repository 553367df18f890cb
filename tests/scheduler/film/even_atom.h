// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

#include "scheduler/film/atom_noise.h"

namespace pm {

// An atom all of whose pixels have seen so many samples of this mean and (unbiased) deviation.
inline std::array<SeenSamples, kAtomPixels> evenAtom(double samples, double mean,
                                                     double deviation) {
    std::array<SeenSamples, kAtomPixels> atom;
    const double unbiased = deviation * deviation * (samples - 1) / samples;
    const double sum = samples * mean;
    atom.fill({samples, {sum, sum, sum}, samples * 3 * (mean * mean + unbiased)});
    return atom;
}

}  // namespace pm
