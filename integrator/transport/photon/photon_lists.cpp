// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/photon_lists.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace pm {

std::vector<Photon> photonsOf(std::span<const ReceivedPhoton> received) {
    std::vector<Photon> photons(received.size());
    std::ranges::transform(received, photons.begin(), &ReceivedPhoton::photon);
    return photons;
}

BigVector<Photon> join(std::span<const Photon> first, std::span<const Photon> second) {
    BigVector<Photon> all(first.size() + second.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, all.size()), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            all[i] = i < first.size() ? first[i] : second[i - first.size()];
    });
    return all;
}

void halve(PhotonTraceResult& part, bool isSecond) {
    if (isSecond)
        for (Photon& photon : part.photons) photon.normal.mark();
    for (BigVector<Photon>* const photons : {&part.photons, &part.descended})
        for (Photon& photon : *photons) photon.flux *= 0.5f;
    for (ReceivedPhoton& received : part.received) {
        if (isSecond)
            received.photon.normal.mark();
        else
            received.photon.normal.unmark();
        received.photon.flux *= 0.5f;
    }
}

PhotonBalance ofHalves(PhotonBalance first, const PhotonBalance& second) {
    first += second;
    for (double* const flux :
         {&first.fluxEmitted, &first.fluxAbsorbed, &first.fluxEscaped, &first.fluxLost})
        *flux *= 0.5;
    return first;
}

void append(PhotonTraceResult& all, PhotonTraceResult part) {
    const auto add = [](BigVector<Photon>& photons, BigVector<Photon>& more) {
        photons = photons.empty() ? std::move(more) : join(photons, more);
    };
    add(all.photons, part.photons);
    add(all.descended, part.descended);
    all.received.insert(all.received.end(), part.received.begin(), part.received.end());
}

}  // namespace pm
