// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scenes whose data are larger than the caches that they are read or made through.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "integrator/photons/map/photon_pages.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"

namespace pm::bench {

struct CacheScene {
    std::string name;
    std::string unit;  // what is missed
    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    std::function<void()> empty;  // the cache
    std::function<void(std::uint64_t bytes)> setBudget;
    std::function<std::uint64_t()> misses;  // so far
    // A cache, as CacheWatch numbers it, that tells its misses alone: no trace has them.
    std::optional<std::uint32_t> untraced;
    std::uint64_t leastBudget = 0;          // bytes, below which setBudget changes nothing
    const GroupCache* groups = nullptr;     // null: not geometry
    std::shared_ptr<PhotonPaging> photons;  // null: photon maps are in memory
    // The same scene with less to miss, or empty.
    std::string remedy;
    std::function<CacheScene()> remedied;
};

// Hills of some millions of triangles, displaced, cut on demand, from a man's height above ground,
// under a sun and a sky. side: pixels of the picture.
CacheScene landscape(std::int32_t side);

// A room of 24 panels, each with a picture of 2048 x 2048 texels of its own, tiled. Its remedy:
// with levels. folder: for the pictures, 700 MB.
CacheScene texturedRoom(std::int32_t side, const std::filesystem::path& folder);

// A box with a glass and a mirror sphere, and millions of photons in pages. folder: for their
// files.
CacheScene pagedCaustic(std::int32_t side, const std::filesystem::path& folder);

}  // namespace pm::bench
