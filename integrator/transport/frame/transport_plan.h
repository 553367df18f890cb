// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "integrator/transport/frame/render_settings.h"
#include "integrator/values/error_scale.h"
#include "integrator/values/notice.h"

namespace pm {

// What a scene needs: computed once from scene and settings, obeyed by everything after it. What is
// not planned is not built, not traced, not allocated. makePlan() and what counts its memory are in
// the room plan, which knows all that a plan decides on.
struct Plan {
    bool tracePhotons = false;
    bool globalMap = false;   // the scene has indirect diffuse light to gather
    bool causticMap = false;  // light can reach a diffuse surface by way of a specular one
    // Caustic photons are kept where glossy and broad lobes receive them, too: see ReceivedMap.
    bool receivedMap = false;
    std::uint64_t globalPhotons = 0;   // emitted a pass for the global map
    std::uint64_t causticPhotons = 0;  // emitted a pass for the caustic map alone
    // Share of the caustic photons that is followed on, as light descended from caustics, which
    // are lamps to gather points (VirtualLamps); 0: global photons bring that light, too.
    float descent = 0.0f;
    float gatherSpacing = 0.0f;  // of gather points on the screen, pixels
    // Of each gather point, or where a pilot finds how many pay: half, once, twice or four times
    // these (gather_pilot.h).
    std::uint32_t gatherRays = 0;
    bool gatherRaysByPilot = false;
    // Lamp samples of a camera sample, see PhotonIntegrator; 0: a pilot finds how many pay.
    std::uint32_t lampSamples = 0;
    ErrorScale errorScale;         // of all that weighs noise against brightness
    std::uint64_t mapBytes = 0;    // estimated peak of the maps of a pass at a time
    std::uint64_t patchBytes = 0;  // of that the patches of surfaces, kept for all passes
    // Landings that are stored, expected of a photon: of a global one; of a caustic one in the
    // caustic map, afterwards, and of these refocused.
    double landingsOfPhoton = 0, causticLandingsOfPhoton = 0, descendedOfPhoton = 0;
    double refocusedOfPhoton = 0;
    double receivedOfPhoton = 0;  // of a caustic one, by glossy and broad lobes
    // Where photons land very often, see PhotonTraceRequest; else 0.
    std::uint32_t oneInChains = 0;
    double processorSecondsPerPass = 0;  // estimated, to a factor of about two
    // The same of a camera sample, its share of the frame's photons and gather points included.
    double processorSecondsPerSample = 0;
    std::vector<std::string> reasons;  // one line each: what and why
    std::vector<Notice> notices;

    std::uint64_t photonsPerPass() const { return globalPhotons + causticPhotons; }
    // That those leave where they land, at most as a rule.
    std::uint64_t landingsPerPass() const {
        return globalLandings() + causticLandings() + descendedLandings() + receivedLandings();
    }
    std::uint64_t globalLandings() const;
    std::uint64_t causticLandings() const;
    std::uint64_t descendedLandings() const;  // refocused ones included
    std::uint64_t refocusedLandings() const;
    std::uint64_t receivedLandings() const;

    // All memory of maps where those of the first so many passes are held, with pointBytes of
    // gather points each.
    std::uint64_t memoryBytes(std::uint32_t passes, std::uint64_t pointBytes) const;
    // Of that the maps, pilots included; and what comes on top while a pass's maps are made.
    std::uint64_t heldMapBytes(std::uint32_t passes) const;
    std::uint64_t buildingMapBytes(std::uint32_t pass = 0) const;
    // Of pilots; and of one pass.
    std::uint64_t pilotMapBytes() const;
    std::uint64_t passMapBytes(std::uint32_t pass) const;

    // Where maps of global, caustic and refocused photons are in pages: those of one pass, ...
    std::uint64_t pagedBytes() const;
    // ... and of the pilots, which stay; ...
    std::uint64_t pagedPilotBytes() const;
    // ... what passes first to last have for sites in a share of the usual room; ...
    std::uint64_t siteBytes(std::uint32_t first, std::uint32_t last, float room) const;
    // ... what their maps take beside pages and sites, with pointBytes of gather points each;
    // without what they are built in, which is the pages' business.
    std::uint64_t bytesBesidePages(std::uint32_t first, std::uint32_t last,
                                   std::uint64_t pointBytes) const;

    // Emitted once a render, to find the radii of the estimates.
    std::uint64_t globalPilotPhotons() const;
    std::uint64_t causticPilotPhotons() const;
    // Emitted before those, to learn where to aim.
    std::uint64_t aimPilotPhotons() const;

    // The lines that --explain prints.
    std::string explain() const;
};

}  // namespace pm
