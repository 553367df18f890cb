// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a plan's maps take: of memory the one estimate there is.
#include "integrator/transport/plan/plan_memory.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/received_map.h"
#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/transport/frame/gather_count.h"
#include "integrator/transport/frame/pass_radius.h"
#include "integrator/transport/frame/transport_plan.h"
#include "integrator/transport/gather/gather_points.h"
#include "integrator/transport/gather/virtual_lamps.h"

namespace pm {

namespace {

// Patches of a disc that holds the photons of an estimate, by the areas of both, and the bytes of
// one, as a mean over those that are whole surface and those that have a grid.
constexpr double kPatchesOfDisc = 1.4, kBytesOfPatch = 350;

// Patches are made where irradiance is asked for: no more than there are places for them, of the
// radii of all passes, nor than there are questions.
std::uint64_t patchBytes(const RenderSettings& settings, const Plan& plan) {
    const auto landings = static_cast<double>(plan.landingsPerPass());
    const std::uint32_t last = std::max(settings.passes, 1u) - 1;
    const double steps = 1 + std::floor(-std::log2(static_cast<double>(radiusFactor(last))));
    const double places = kPatchesOfDisc * landings / settings.estimatePhotons * steps;
    const auto pixels = static_cast<double>(settings.window.area());
    double questions = 0;
    if (plan.globalMap) questions += gatherPointsOf(pixels, plan.gatherSpacing) * plan.gatherRays;
    if (plan.causticMap)
        questions += pixels * std::pow(4.0, static_cast<double>(settings.aaLevel) - 2.0);
    const double bytes = kBytesOfPatch * std::min(places, questions * settings.passes);
    return std::min(static_cast<std::uint64_t>(bytes), SurfacePatches::kMostBytes);
}

}  // namespace

void estimateMemory(const RenderSettings& settings, Plan& plan) {
    plan.patchBytes = patchBytes(settings, plan);
    // The last pass has the narrowest radii and the most places.
    const std::uint32_t last = std::max(settings.passes, 1u) - 1;
    plan.mapBytes = plan.pilotMapBytes() + plan.passMapBytes(last) + plan.buildingMapBytes(last) +
                    plan.patchBytes;
    if (plan.globalMap)
        plan.mapBytes += GatherPoints::memoryBytes(settings.width, settings.height,
                                                   plan.gatherSpacing, settings.window);
}

std::uint64_t Plan::globalLandings() const {
    return static_cast<std::uint64_t>(static_cast<double>(globalPhotons) * landingsOfPhoton);
}

std::uint64_t Plan::causticLandings() const {
    return static_cast<std::uint64_t>(static_cast<double>(causticPhotons) *
                                      causticLandingsOfPhoton);
}

std::uint64_t Plan::descendedLandings() const {
    return descent > 0.0f
               ? static_cast<std::uint64_t>(static_cast<double>(causticPhotons) * descendedOfPhoton)
               : 0;
}

std::uint64_t Plan::refocusedLandings() const {
    return descent > 0.0f
               ? static_cast<std::uint64_t>(static_cast<double>(causticPhotons) * refocusedOfPhoton)
               : 0;
}

std::uint64_t Plan::receivedLandings() const {
    return receivedMap
               ? static_cast<std::uint64_t>(static_cast<double>(causticPhotons) * receivedOfPhoton)
               : 0;
}

std::uint64_t Plan::pilotMapBytes() const {
    return (causticLandings() + refocusedLandings() + receivedLandings()) /
           PilotRadius::kPilotShare * PilotRadius::kHeldBytesPerPhoton;
}

std::uint64_t Plan::passMapBytes(std::uint32_t pass) const {
    const std::uint64_t gathered = globalLandings() + descendedLandings();
    const std::uint64_t caustics = causticLandings() + refocusedLandings();
    const float factor = radiusFactor(pass);
    std::uint64_t bytes = (gathered + caustics) * PhotonMap::kHeldBytesPerPhoton;
    bytes += receivedLandings() * ReceivedMap::kHeldBytesPerPhoton;
    if (globalMap) bytes += IrradianceSites::memoryBytes(gathered, factor);
    if (descent > 0.0f) bytes += VirtualLamps::memoryBytes(causticLandings(), factor);
    return bytes;
}

std::uint64_t Plan::heldMapBytes(std::uint32_t passes) const {
    std::uint64_t bytes = pilotMapBytes();
    for (std::uint32_t pass = 0; pass < passes; ++pass) bytes += passMapBytes(pass);
    return bytes;
}

std::uint64_t Plan::memoryBytes(std::uint32_t passes, std::uint64_t pointBytes) const {
    return heldMapBytes(passes) + pointBytes * passes + buildingMapBytes() + patchBytes;
}

std::uint64_t Plan::pagedBytes() const {
    return (globalLandings() + descendedLandings() + causticLandings() + refocusedLandings()) *
           PhotonMap::kHeldBytesPerPhoton;
}

std::uint64_t Plan::pagedPilotBytes() const {
    return (causticLandings() + refocusedLandings()) / PilotRadius::kPilotShare *
           PhotonMap::kHeldBytesPerPhoton;
}

std::uint64_t Plan::siteBytes(std::uint32_t first, std::uint32_t last, float room) const {
    const std::uint64_t gathered = globalLandings() + descendedLandings();
    std::uint64_t bytes = 0;
    for (std::uint32_t pass = first; pass <= last; ++pass) {
        const float factor = radiusFactor(pass);
        if (globalMap) bytes += IrradianceSites::memoryBytes(gathered, factor, room);
        if (descent > 0.0f) bytes += VirtualLamps::memoryBytes(causticLandings(), factor, room);
    }
    return bytes;
}

std::uint64_t Plan::bytesBesidePages(std::uint32_t first, std::uint32_t last,
                                     std::uint64_t pointBytes) const {
    const auto planes = [](std::uint64_t paged) {
        return paged / PhotonMap::kHeldBytesPerPhoton * PhotonMap::kPagedBytesPerPhoton;
    };
    std::uint64_t bytes =
        pilotMapBytes() - pagedPilotBytes() + planes(pagedPilotBytes()) + patchBytes +
        receivedLandings() * (ReceivedMap::kBytesPerPhoton - ReceivedMap::kHeldBytesPerPhoton +
                              sizeof(ReceivedPhoton));
    for (std::uint32_t pass = first; pass <= last; ++pass)
        bytes += passMapBytes(pass) - pagedBytes() + planes(pagedBytes()) + pointBytes;
    return bytes - siteBytes(first, last, 1.0f);
}

// In the order in which PhotonPass makes the maps; a map's photons go when it is built, before
// those maps are there that come after it.
std::uint64_t Plan::buildingMapBytes(std::uint32_t pass) const {
    constexpr std::uint64_t kHeld = PhotonMap::kHeldBytesPerPhoton;
    constexpr std::uint64_t kEach = PhotonMap::kBytesPerPhoton - kHeld;
    const auto beyond = [](std::uint64_t building, std::uint64_t after) {
        return building > after ? building - after : 0;
    };
    const float factor = radiusFactor(pass);
    const std::uint64_t descended = descendedLandings(), refocused = refocusedLandings();
    const std::uint64_t gathered = globalLandings() + descended;
    const std::uint64_t sites = globalMap ? IrradianceSites::memoryBytes(gathered, factor) : 0;
    const std::uint64_t lamps =
        descent > 0.0f ? VirtualLamps::memoryBytes(causticLandings(), factor) : 0;
    const std::uint64_t global = gathered * kHeld + sites;
    const std::uint64_t received = receivedLandings();
    const std::uint64_t receivedHeld = received * ReceivedMap::kHeldBytesPerPhoton;
    return std::max({beyond(causticLandings() * kEach + descended * sizeof(Photon) +
                                received * sizeof(ReceivedPhoton),
                            receivedHeld + lamps + refocused * kHeld + global),
                     beyond(received * (ReceivedMap::kBytesPerPhoton -
                                        ReceivedMap::kHeldBytesPerPhoton + sizeof(ReceivedPhoton)) +
                                descended * sizeof(Photon),
                            lamps + refocused * kHeld + global),
                     beyond(refocused * kEach + descended * sizeof(Photon), global),
                     beyond(2 * gathered * sizeof(Photon), global),
                     beyond(gathered * kEach, sites)});
}

}  // namespace pm
