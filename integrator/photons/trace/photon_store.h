// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

#include "integrator/photons/trace/photon_tracer.h"

namespace pm {

// Where traced photons are kept for other renders of the same lights and surfaces: those of the
// pilots, which are of pass 0, and those of each pass.

class PhotonSink {
  public:
    virtual ~PhotonSink() = default;
    // Takes what was traced: first that of the pilots, then pass by pass, in the same order of
    // kinds for any render. Errors: its own; Error(kCancelled) soon after `cancelled` is set.
    virtual void write(PhotonKind kind, std::uint32_t pass, const PhotonTraceResult& traced,
                       const std::atomic<bool>& cancelled) = 0;
};

class PhotonSource {
  public:
    virtual ~PhotonSource() = default;
    // What tracing gave, records left out. Errors: its own; Error(kCancelled) soon after
    // `cancelled` is set. Threads: any, at once.
    virtual PhotonTraceResult read(PhotonKind kind, std::uint32_t pass,
                                   const std::atomic<bool>& cancelled) const = 0;
    // The same in rounds, as traceInRounds.
    virtual PhotonTraceResult readInRounds(PhotonKind kind, std::uint32_t pass,
                                           const std::atomic<bool>& cancelled,
                                           const TraceRounds& rounds) const {
        PhotonTraceResult all = read(kind, pass, cancelled), rest;
        rest.balance = all.balance;
        rest.focus = all.focus;
        rounds.take(std::move(all));
        return rest;
    }
};

}  // namespace pm
