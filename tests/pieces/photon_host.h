// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders of the box with photon-map files.
#pragma once

#include <atomic>
#include <string>

#include "tests/pieces/piece_host.h"

namespace pm::test {

class PhotonHost : public PieceHost {
  protected:
    // What the host of a render without pixels was told.
    struct Seen {
        std::atomic<int> buckets{0}, finished{0};
        std::atomic<double> progress{0};
        double cancelAt = 2;  // progress at which it is cancelled
        std::uint32_t layers = 99;
        PmrStatus readStatus = PMR_OK;
    };

    // Traces photons into a file, with settings on top of the small ones.
    Outcome tracePhotons(const std::string& name, const Settings& more, double cancelAt = 2);
    void makePhotons(const std::string& name, const Settings& more = {});
    // Renders with them.
    Outcome renderWith(const std::string& name, const Settings& more);
    std::string explain(const Settings& more);

    Seen m_seen;

  private:
    PmrRender makeRender(const Settings& more, const PmrRenderDesc& desc) const;
};

}  // namespace pm::test
