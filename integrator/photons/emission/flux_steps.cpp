// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/flux_steps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pm {

namespace {

// Fixed, so that sums are the same for any number of threads.
constexpr std::size_t kChunk = 8192;

// use(photon) for those of a chunk.
template <typename Use>
void visitChunk(const PhotonMap& photons, std::size_t chunk, const Use& use) {
    const std::size_t end = std::min((chunk + 1) * kChunk, photons.size());
    for (std::size_t i = chunk * kChunk; i < end; ++i)
        use(photons.photon(static_cast<std::uint32_t>(i)));
}

}  // namespace

DrawnByFlux drawBySteps(const PhotonMap& photons, std::size_t count, float u,
                        const CancelCheck& cancel) {
    DrawnByFlux drawn;
    const std::size_t chunks = (photons.size() + kChunk - 1) / kChunk;
    // Of what lies before each chunk, and before its end.
    std::vector<double> before(chunks + 1, 0.0);
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
        cancel.throwIfSet("drawing photons");
        double sum = 0;
        visitChunk(photons, chunk, [&](const Photon& photon) { sum += channelSum(photon.flux); });
        before[chunk + 1] = sum;
    });
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) before[chunk + 1] += before[chunk];
    drawn.flux = before.back();
    if (!(drawn.flux > 0)) return drawn;
    const double step = drawn.flux / static_cast<double>(count);
    drawn.photons.resize(count);
    const auto placeOf = [&](std::size_t i) { return (static_cast<double>(i) + u) * step; };
    // How many places are below.
    const auto placesBelow = [&](double flux) {
        auto places = static_cast<std::size_t>(std::max(0.0, std::ceil(flux / step - u)));
        while (places > 0 && placeOf(places - 1) >= flux) --places;
        while (places < count && placeOf(places) < flux) ++places;
        return std::min(places, count);
    };
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
        std::size_t i = placesBelow(before[chunk]);
        const std::size_t end = placesBelow(before[chunk + 1]);
        double upTo = before[chunk];
        Photon last{};
        visitChunk(photons, chunk, [&](const Photon& photon) {
            const double own = channelSum(photon.flux);
            upTo += own;
            if (own > 0) last = photon;
            for (; i < end && placeOf(i) < upTo; ++i) drawn.photons[i] = {photon, own / drawn.flux};
        });
        // What rounding has left between the last and the end.
        for (; i < end; ++i) drawn.photons[i] = {last, channelSum(last.flux) / drawn.flux};
    });
    return drawn;
}

}  // namespace pm
