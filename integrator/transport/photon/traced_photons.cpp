// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/traced_photons.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "integrator/transport/photon/photon_lists.h"

namespace pm {

TracedPhotons::TracedPhotons(PhotonPaging* paging)
    : m_paging(paging),
      m_spool(paging ? std::make_unique<PhotonSpool>(paging->makeFile()) : nullptr) {}

std::size_t TracedPhotons::size() const {
    return m_spool ? m_spool->size() : m_photons.size();
}

void TracedPhotons::append(BigVector<Photon> photons) {
    if (m_spool)
        m_spool->append(photons);
    else if (m_photons.empty())
        m_photons = std::move(photons);
    else if (!photons.empty())
        m_photons = join(m_photons, photons);
}

void TracedPhotons::append(TracedPhotons others) {
    if (!m_spool) return append(std::move(others.m_photons));
    others.m_spool->finish();
    others.m_spool->visit([&](const Photon& photon) { m_spool->append(photon); });
}

TracedPhotons TracedPhotons::those(const std::function<bool(const Photon&)>& isMeant) {
    TracedPhotons found(m_paging);
    if (!m_spool) {
        std::ranges::copy_if(m_photons, std::back_inserter(found.m_photons), isMeant);
        return found;
    }
    m_spool->finish();
    m_spool->visit([&](const Photon& photon) {
        if (isMeant(photon)) found.m_spool->append(photon);
    });
    return found;
}

PhotonMap TracedPhotons::intoMap(const CancelCheck& cancel, float coreRadius) {
    if (!m_spool) return PhotonMap(std::exchange(m_photons, {}), cancel, coreRadius);
    m_spool->finish();
    return PhotonMap(std::move(m_spool), *m_paging, cancel, coreRadius);
}

}  // namespace pm
