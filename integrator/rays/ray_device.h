// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <embree3/rtcore.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "integrator/values/cancel_check.h"

namespace pm {

// Embree's device for one instruction set: all scenes that are alive share it, so that a mesh built
// for one of them serves the next. Threads: any.
class RayDevice {
  public:
    // isa: see RayTracer, errors too.
    static std::shared_ptr<RayDevice> of(const std::string& isa);
    explicit RayDevice(const std::string& resolvedIsa);
    ~RayDevice();
    RayDevice(const RayDevice&) = delete;
    RayDevice& operator=(const RayDevice&) = delete;

    RTCDevice handle() const { return m_device; }
    const std::string& isa() const { return m_isa; }

    // An empty scene. Throws Error(kOutOfMemory, kInternal).
    RTCScene newScene() const;
    // Builds what was attached to a scene, in parallel in the calling TBB arena, one scene at a
    // time, and returns the bytes that it took, less what other scenes released meanwhile. Throws
    // Error(kOutOfMemory, kInternal, kCancelled).
    std::uint64_t commit(RTCScene scene, const CancelCheck& cancel);
    // Throws where Embree has told this thread of an error.
    void check(const std::string& doing) const;

  private:
    RTCDevice m_device = nullptr;
    std::string m_isa;
    std::timed_mutex m_building;
    std::atomic<std::int64_t> m_bytes{0};
};

}  // namespace pm
