// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "host_shim/values/go_on.h"

namespace pm::host {

// Codes of the host's own warnings; the library's are below 1000. Texts may change, codes don't.
enum class Warning : int {
    kMaterialFile = 1001,   // a material library is missing
    kMaterialName = 1002,   // usemtl of a name that no library has
    kMaterialValue = 1003,  // a value was clamped, scaled or not understood
    kMaterialPart = 1004,   // a part of a material that is not rendered yet
    kTexture = 1005,        // a picture can't be read, or an option of it is not rendered
    kGeometry = 1006,       // statements of the scene that were left out
    kSubdivision = 1007,    // a subdivision tag that is not obeyed
    kDefaultLight = 1008,   // the scene has no light: one was added
    kCamera = 1009,         // the camera was changed
    kOutput = 1010,         // something of an output could not be had
    kBlackPicture = 1011,   // surfaces are seen, and no light on them
    kBadSamples = 1012,     // some are NaN, infinite or negative and count as black
    kFarm = 1013,           // machines that differ, or tasks that had to be started again
    kCopies = 1014,         // a local copy that was not what it should be
    kSceneLanguage = 1015,  // what a scene in POV-Ray's language says, or does without
};

using WarningSink = std::function<void(Warning code, const std::string& text)>;

// Told before so many bytes are taken beside what is known of; may throw. Empty: nobody asks.
using MemoryNote = std::function<void(std::uint64_t bytes)>;

}  // namespace pm::host
