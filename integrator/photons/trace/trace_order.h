// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "integrator/photons/trace/photon_walk.h"
#include "integrator/scene/scene.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// The order in which the photons of a request are traced. By their numbers, which are spread over
// all that lights reach: each next photon goes somewhere else. Where surfaces are cut on demand,
// sorted in windows of fixed size by where they would leave the scene's box if nothing were in
// their way: then photons that follow each other meet the same groups. It goes by the scene alone,
// so that what is traced is the same bits for any cache, rounds and threads.
// Threads: index() from any, at once.
class TraceOrder {
  public:
    static constexpr std::uint64_t kWindow = std::uint64_t{1} << 18;  // photons, 8 bytes each

    // Both must outlive this.
    TraceOrder(const Scene& scene, const PhotonWalk& walk, std::uint64_t count)
        : m_scene(scene), m_walk(walk), m_count(count) {}

    // Returns the end of the window that a position is in, whose indices can be asked for from here
    // on. In parallel in the calling TBB arena. Throws Error(kCancelled) soon after cancel is set.
    std::uint64_t enter(std::uint64_t position, const CancelCheck& cancel);
    // Of the photon at a position of that window.
    std::uint64_t index(std::uint64_t position) const {
        return m_window.empty() ? position : m_window[position - m_begin].index;
    }

  private:
    struct Entry {
        std::uint32_t key, index;
        friend auto operator<=>(const Entry&, const Entry&) = default;
    };
    std::uint32_t keyOf(std::uint64_t index) const;

    const Scene& m_scene;
    const PhotonWalk& m_walk;
    const std::uint64_t m_count;
    std::uint64_t m_begin = 0, m_end = 0;
    std::vector<Entry> m_window;  // empty: by number
};

}  // namespace pm
