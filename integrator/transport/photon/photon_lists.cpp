// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/photon_lists.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace pm {

BigVector<Photon> refocusedOf(std::span<const Photon> descended) {
    BigVector<Photon> found;
    std::ranges::copy_if(descended, std::back_inserter(found),
                         [](const Photon& photon) { return photon.normal.isMarked(); });
    return found;
}

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

PhotonTraceResult joinHalves(PhotonTraceResult first, PhotonTraceResult second) {
    for (Photon& photon : second.photons) photon.normal.mark();
    PhotonTraceResult both;
    both.photons = join(first.photons, second.photons);
    both.descended = join(first.descended, second.descended);
    for (BigVector<Photon>* const photons : {&both.photons, &both.descended})
        for (Photon& photon : *photons) photon.flux *= 0.5f;
    both.received = std::move(first.received);
    for (ReceivedPhoton& received : both.received) received.photon.normal.unmark();
    for (ReceivedPhoton& received : second.received) {
        received.photon.normal.mark();
        both.received.push_back(received);
    }
    for (ReceivedPhoton& received : both.received) received.photon.flux *= 0.5f;
    both.balance = first.balance;
    both.balance += second.balance;
    for (double* const flux : {&both.balance.fluxEmitted, &both.balance.fluxAbsorbed,
                               &both.balance.fluxEscaped, &both.balance.fluxLost})
        *flux *= 0.5;
    both.focus = first.focus;
    return both;
}

}  // namespace pm
