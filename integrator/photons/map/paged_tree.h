// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>

#include "integrator/photons/map/photon_pages.h"
#include "integrator/photons/map/photon_spool.h"
#include "integrator/photons/map/photon_tree.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// The tree that buildPhotonTree makes of the same photons in the same order, with its leaves in
// pages: an external sort. What doesn't fit into the budget is divided in a file at the tree's own
// planes, found by two counts of the coordinates' bits; what fits is built in memory, in parallel
// in the calling TBB arena. Memory: at most paging's build budget, or kLeastBuildBytes where that
// is more, beside pages that are held. Disk: at most twice the photons' bytes at once, pages
// included. photons: finished; their file is given back on the way. Errors: those of paging's
// files; Error(kCancelled) soon after cancel is set.
PhotonTree buildPagedTree(std::unique_ptr<PhotonSpool> photons, PhotonPaging& paging,
                          const CancelCheck& cancel = {});

// Buffers, counts and one page's photons.
inline constexpr std::uint64_t kLeastBuildBytes = std::uint64_t{1} << 20;

}  // namespace pm
