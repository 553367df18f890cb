// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame/render_counters.h"

#include <algorithm>

namespace pm {

namespace {

double shareOf(double part, double whole) {
    return whole > 0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
}

}  // namespace

double RenderCounters::shareCut() const {
    const double ofPaths = shareOf(throughputCut, static_cast<double>(cameraSamples));
    return std::min(1.0, ofPaths + std::max(shareOf(fluxLost, fluxEmitted),
                                            shareOf(causticFluxLost, causticFluxEmitted)));
}

}  // namespace pm
