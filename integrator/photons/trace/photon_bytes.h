// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Traced photons as bytes: a head, the photons, those that descended from caustics, those that
// glossy lobes received. Photons and not
// the maps made of them: whatever a map becomes one day, it is made of these.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "integrator/photons/trace/photon_tracer.h"

namespace pm {

struct TracedHead {
    std::uint32_t kind = 0;  // PhotonKind
    std::uint32_t pass = 0;
    Focus focus;
    PhotonBalance balance;
    std::uint64_t photons = 0, descended = 0, received = 0;  // how many follow

    friend bool operator==(const TracedHead&, const TracedHead&) = default;
};
static_assert(sizeof(PhotonBalance) == 64 && sizeof(TracedHead) == 112);
static_assert(std::is_trivially_copyable_v<TracedHead> && std::is_trivially_copyable_v<Photon> &&
              std::is_trivially_copyable_v<ReceivedPhoton>);

TracedHead tracedHead(PhotonKind kind, std::uint32_t pass, const PhotonTraceResult& traced);

// The bytes of both, in the order of writing; valid as long as both.
std::array<std::span<const std::byte>, 4> tracedBytes(const TracedHead& head,
                                                      const PhotonTraceResult& traced);

// Bytes of photons that may follow a head where so many bytes are left. Nothing is computed that
// could overflow: false for a head that claims others.
bool fillsExactly(const TracedHead& head, std::uint64_t bytesLeft);

// Makes room for what the head tells of, and gives where it goes.
std::array<std::span<std::byte>, 3> tracedRoom(const TracedHead& head, PhotonTraceResult& traced);

// Whether tracing in a scene of this radius (around the origin, scene units) could have given
// these: all that maps take for granted. Null, or in a word what is wrong.
const char* faultOf(const TracedHead& head, const PhotonTraceResult& traced, double sceneRadius);

}  // namespace pm
