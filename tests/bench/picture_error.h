// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>

namespace pm::bench {

// Mean over pixels and channels of (a - r)(b - r)/(r^2 + 0.01), without the share `dropped` of the
// pixels where it is largest. With a = b it is relMSE; with a and b that share no noise the noise
// cancels, and what stays is the energy of the error they have in common: bias, and the reference's
// own noise.
double relativeError(std::span<const double> a, std::span<const double> b,
                     std::span<const double> reference, double dropped);

}  // namespace pm::bench
