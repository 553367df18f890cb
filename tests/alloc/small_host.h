// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A host of few words: it goes one of several ways through the interface, looks at every status,
// and lets go of all it made.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plugin/include/pm_plugin.h"

namespace pm::test {

// What became of a walk. Memory for it is taken before the walk, and none within.
struct WalkResult {
    PmrStatus firstFailure = PMR_OK;  // of a call that should have been PMR_OK
    const char* failedCall = "";
    bool hasText = true;       // lastError had one for it
    bool isRefused = true;     // calls that have to fail did
    std::uint64_t pixels = 0;  // a checksum of what was read, 0 where none was
};

// One way through the interface, from createContext to releaseContext.
struct Walk {
    const char* name;
    void (*go)(const PmrApi& api, const char* folder, WalkResult& result);
};

// render: a triangle, a camera, one pass of 8 x 8 pixels. objects: cage, sphere, texture, lights,
// environment, and a commit. errors: what is refused. pieces: checkpoint, parts, photon map.
const std::vector<Walk>& walks();

}  // namespace pm::test
