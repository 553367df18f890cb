// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

#include "integrator/scene/scene.h"
#include "integrator/transport/plan/plan.h"
#include "plugin/session/setting_values.h"
#include "scheduler/buckets/bucket_grid.h"

namespace pm::plugin {

// What a render needs, in bytes.
struct MemoryNeed {
    std::uint64_t scene = 0, frame = 0, maps = 0, buckets = 0;
    std::uint64_t process = 0;   // program and libraries, and a host's copy of the layers
    std::uint64_t textures = 0;  // of their texels, those that are held at once
    std::uint64_t groups = 0;    // likewise of the triangles that are cut on demand
    std::uint64_t total() const {
        return scene + frame + maps + buckets + process + textures + groups;
    }
};

// How a render holds its pixels: the whole frame, one pass after the other over all buckets; or
// bucket by bucket, each with all passes, their maps held all along, and its pixels given to the
// host and forgotten. Follows from settings, scene and memory limit; the picture is the same.
struct MemoryPlan {
    bool byBuckets = false;
    std::uint64_t limit = 0;
    MemoryNeed need;                // as it is to be done
    MemoryNeed whole;               // with the whole frame
    std::uint32_t bucketsHeld = 0;  // by buckets: in work or waiting for the host, at most
    std::uint64_t smallest = 0;     // the smallest limit by which it can be done
    std::uint64_t hostPeak = 0;     // what the process took before, by the setting
    std::uint64_t pages = 0;  // bytes that pages of photon maps take at once; 0: maps are in memory
    std::uint64_t pagedBytes = 0;  // of all pages of the maps that there are at once
    float roomForSites = 1.0f;     // with pages: see IrradianceSites
    std::string whyWhole;  // why it can't be done by buckets; empty where it can or isn't asked for

    // Of the photon maps, what is held of their pages.
    double pagedShare() const {
        return pagedBytes == 0 ? 0.0 : static_cast<double>(pages) / static_cast<double>(pagedBytes);
    }
    // For --explain; ends with a line break.
    std::string explain() const;
    // CallError MEMORY with all figures where the need is above the limit.
    void check() const;
};

// Bytes below which a cache is of no use: some pages or groups for each of many threads.
inline constexpr std::uint64_t kLeastGroups = std::uint64_t{8} << 20,
                               kLeastPages = std::uint64_t{8} << 20;

// The most passes whose maps are held at once.
inline constexpr std::uint32_t kMostPassesByBuckets = 8;

// Caches of what can be read or made again are planned as large as the limit leaves room for, and
// as small as they may be before the render is refused.
// grid: of the window's whole atoms. texelBytes: of all textures of the scene. Errors: CallError
// ARGUMENT where delivery by buckets is demanded and can't be.
MemoryPlan planMemory(const Scene& scene, const Plan& plan, const SettingValues& values,
                      const BucketGrid& grid, std::uint64_t texelBytes);

// The buckets of a render with these settings: of whole atoms.
BucketGrid bucketsOf(const SettingValues& values);

}  // namespace pm::plugin
