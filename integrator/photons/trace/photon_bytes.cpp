// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/trace/photon_bytes.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pm {

namespace {

// Rounding may put photons a little outside the sphere around the scene.
constexpr double kRoom = 1.01;

bool isPossible(const Photon& photon, float farthest) {
    const Vec3f& p = photon.position;
    // False for NaN as well.
    return std::abs(p.x) <= farthest && std::abs(p.y) <= farthest && std::abs(p.z) <= farthest &&
           isFinite(photon.flux) && !photon.normal.isNull();
}

bool isPossible(const Focus& focus) {
    return isFinite(focus.centre) && std::isfinite(focus.inverseRadiusSquared) &&
           focus.inverseRadiusSquared >= 0.0f;
}

bool isPossible(const PhotonBalance& balance) {
    return std::isfinite(balance.fluxEmitted) && std::isfinite(balance.fluxAbsorbed) &&
           std::isfinite(balance.fluxEscaped) && std::isfinite(balance.fluxLost);
}

}  // namespace

TracedHead tracedHead(PhotonKind kind, std::uint32_t pass, const PhotonTraceResult& traced) {
    return {static_cast<std::uint32_t>(kind),
            pass,
            traced.focus,
            traced.balance,
            traced.photons.size(),
            traced.descended.size(),
            traced.received.size()};
}

std::array<std::span<const std::byte>, 4> tracedBytes(const TracedHead& head,
                                                      const PhotonTraceResult& traced) {
    return {std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(traced.photons)),
            std::as_bytes(std::span(traced.descended)), std::as_bytes(std::span(traced.received))};
}

bool fillsExactly(const TracedHead& head, std::uint64_t bytesLeft) {
    if (head.received > bytesLeft / sizeof(ReceivedPhoton)) return false;
    bytesLeft -= head.received * sizeof(ReceivedPhoton);
    const std::uint64_t all = bytesLeft / sizeof(Photon);
    return bytesLeft % sizeof(Photon) == 0 && head.photons <= all &&
           head.descended == all - head.photons;
}

std::array<std::span<std::byte>, 3> tracedRoom(const TracedHead& head, PhotonTraceResult& traced) {
    traced.balance = head.balance;
    traced.photons.resize(head.photons);
    traced.descended.resize(head.descended);
    traced.received.resize(head.received);
    return {std::as_writable_bytes(std::span(traced.photons)),
            std::as_writable_bytes(std::span(traced.descended)),
            std::as_writable_bytes(std::span(traced.received))};
}

const char* faultOf(const TracedHead& head, const PhotonTraceResult& traced, double sceneRadius) {
    if (!isPossible(head.balance)) return "its flux is not finite";
    if (!isPossible(head.focus)) return "its focus is not finite";
    if (head.balance.stored != head.photons + head.descended + head.received)
        return "its photons are miscounted";
    if (head.descended + head.received > 0 && !isCaustic(static_cast<PhotonKind>(head.kind)))
        return "it has photons of another kind";
    const auto farthest = static_cast<float>(kRoom * sceneRadius);
    const auto arePossible = [&](std::span<const Photon> photons) {
        return std::ranges::all_of(
            photons, [&](const Photon& photon) { return isPossible(photon, farthest); });
    };
    const bool areReceivedPossible =
        std::ranges::all_of(traced.received, [&](const ReceivedPhoton& received) {
            return isPossible(received.photon, farthest) && isFinite(received.from.unpack());
        });
    if (!arePossible(traced.photons) || !arePossible(traced.descended) || !areReceivedPossible)
        return "a photon is out of the scene, of no finite flux or on no side of a surface";
    return nullptr;
}

}  // namespace pm
