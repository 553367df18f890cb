// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cstdint>

#include "integrator/materials/lobes/lobe.h"

namespace pm {

// What paths have been through, in the letters of light path expressions: L a lamp, E the eye, D
// the diffuse lobe, B a broad one, S any other but going straight on, which is none; W is a lobe
// that is broad, or glossy and wide, G the wide one of frosted glass.
//
//   class      read from the eye                                a photon of it is, where it lands
//   emission   E S* L, every S delta                            -
//   direct     E S* (D|B) L; E S+ L where one is glossy, but    kStraight
//              for caustics
//   caustic    E S* D (B|S)* S L; E S* W (B|S)* S L, but not    kSpecular
//              E S* G (B|S)* G L
//   indirect   all others, with two D or B or more              kDiffuse to kLater

// Which part of the picture a light path belongs to. Each path is in exactly one.
enum class PathClass : std::uint8_t { kEmission, kDirect, kCaustic, kIndirect };

// How far a path from the camera has come.
struct PathState {
    // The first D or B, if any: what came after it, and whether it was a D.
    enum class Since : std::uint8_t { kNone, kNothing, kOthers, kDiffuse };
    Since since = Since::kNone;
    bool firstIsDiffuse = false;
    bool lastIsSpecular = false;
    bool anyGlossy = false, anyDiffuse = false;
    bool isPastWide = false;       // it has met a W, and no D
    bool isPastFrosted = false;    // and the first W was a G
    bool isCausticOnWide = false;  // what light is found next the first W receives as a caustic

    // isFrosted: see Bsdf.
    void scatter(Lobe lobe, bool isFrosted) {
        if (lobe == Lobe::kStraight) return;
        const bool diffuse = lobe == Lobe::kDiffuse;
        lastIsSpecular = !diffuse && lobe != Lobe::kBroad;
        anyDiffuse = anyDiffuse || diffuse;
        // What shines through frosted glass next-event estimation finds well, where it goes in.
        isCausticOnWide =
            isPastWide && lastIsSpecular && !(isPastFrosted && isFrosted && lobe == Lobe::kWide);
        if (!isPastWide) isPastFrosted = isFrosted && lobe == Lobe::kWide;
        isPastWide = !anyDiffuse && (isPastWide || isWide(lobe));
        anyGlossy = anyGlossy || lobe == Lobe::kGlossy || lobe == Lobe::kWide;
        if (since != Since::kNone)
            since = diffuse ? Since::kDiffuse : std::max(since, Since::kOthers);
        else if (!lastIsSpecular) {
            since = Since::kNothing;
            firstIsDiffuse = diffuse;
        }
    }
    PathState after(Lobe lobe, bool isFrosted) const {
        PathState state = *this;
        state.scatter(lobe, isFrosted);
        return state;
    }
    bool hasMetNoDiffuse() const { return since == Since::kNone; }
    PathClass classify() const {
        if (isCausticOnWide) return PathClass::kCaustic;
        if (since == Since::kNone) return anyGlossy ? PathClass::kDirect : PathClass::kEmission;
        if (since == Since::kNothing) return PathClass::kDirect;
        return since == Since::kOthers && firstIsDiffuse && lastIsSpecular ? PathClass::kCaustic
                                                                           : PathClass::kIndirect;
    }
};

// How far a photon has come, which is scattered in the other order.
enum class PhotonStage : std::uint8_t {
    kStraight,   // L: by no lobe yet, or straight on, which is as if nothing were there
    kSpecular,   // L S (B|S)*: no diffuse surface yet, but other lobes, the first one not broad
    kDiffuse,    // L (D|B) ...: scattered diffusely, or broadly, where it came straight from a lamp
    kDescended,  // L S (B|S)* D: diffusely where it came by way of other lobes
    kBroadened,  // L S (B|S)* D B+: and on by broad lobes
    kRefocused,  // L S (B|S)* D B* S (B|S)*: descended, and on by other lobes before it met another
                 // diffuse surface
    kLater,      // descended, and has met another since
};

constexpr PhotonStage stageAfter(PhotonStage stage, Lobe lobe) {
    using enum PhotonStage;
    if (lobe == Lobe::kStraight) return stage;
    if (lobe == Lobe::kDiffuse) {
        if (stage == kStraight) return kDiffuse;
        if (stage == kSpecular) return kDescended;
        return stage == kDiffuse ? kDiffuse : kLater;
    }
    if (lobe == Lobe::kBroad) {
        if (stage == kStraight) return kDiffuse;
        return stage == kDescended ? kBroadened : stage;
    }
    if (stage == kStraight) return kSpecular;
    return stage == kDescended || stage == kBroadened ? kRefocused : stage;
}

}  // namespace pm
