// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>

#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/photons/map/photon_pages.h"
#include "integrator/photons/map/photon_spool.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Photons on their way from tracing into a map: in memory, or in a file where maps are in pages.
// Errors of all functions, of those in a file: the file's.
class TracedPhotons {
  public:
    // paging: null where they are in memory; it must outlive this.
    explicit TracedPhotons(PhotonPaging* paging);

    void append(BigVector<Photon> photons);
    void append(TracedPhotons others);
    std::size_t size() const;
    // Those which are meant, in their order.
    TracedPhotons those(const std::function<bool(const Photon&)>& isMeant);
    // Of such as are descended from caustics those that have been refocused.
    TracedPhotons refocused() {
        return those([](const Photon& photon) { return photon.normal.isMarked(); });
    }
    // Their map; they are given back. Builds in parallel in the calling TBB arena. Throws
    // Error(kCancelled) soon after cancel is set.
    PhotonMap intoMap(const CancelCheck& cancel,
                      float coreRadius = std::numeric_limits<float>::infinity());

  private:
    PhotonPaging* m_paging;
    BigVector<Photon> m_photons;
    std::unique_ptr<PhotonSpool> m_spool;
};

}  // namespace pm
