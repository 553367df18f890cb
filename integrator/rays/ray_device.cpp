// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/rays/ray_device.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>

#include "integrator/values/error.h"

namespace pm {

namespace {

bool processorHas(const std::string& isa) {
    if (isa == "sse2") return true;
    if (isa == "sse4.2") return __builtin_cpu_supports("sse4.2");
    if (isa == "avx") return __builtin_cpu_supports("avx");
    if (isa == "avx2") return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512cd");
}

std::string resolveIsa(const std::string& wanted) {
    static constexpr std::array kKnown = {"avx512", "avx2", "avx", "sse4.2", "sse2"};
    __builtin_cpu_init();
    if (wanted.empty() || wanted == "best") {
        for (const char* isa : kKnown)
            if (processorHas(isa)) return isa;
    }
    for (const char* isa : kKnown) {
        if (wanted != isa) continue;
        if (!processorHas(wanted))
            throw Error(
                Status::kInvalidArgument,
                "instruction set " + wanted + " is not offered by this processor; use best");
        return wanted;
    }
    throw Error(
        Status::kInvalidArgument,
        "instruction set is '" + wanted + "'; it must be best, sse2, sse4.2, avx, avx2 or avx512");
}

}  // namespace

std::shared_ptr<RayDevice> RayDevice::of(const std::string& isa) {
    static std::mutex mutex;
    static std::map<std::string, std::weak_ptr<RayDevice>> alive;
    const std::string resolved = resolveIsa(isa);
    const std::lock_guard lock(mutex);
    std::weak_ptr<RayDevice>& slot = alive[resolved];
    std::shared_ptr<RayDevice> device = slot.lock();
    if (!device) slot = device = std::make_shared<RayDevice>(resolved);
    return device;
}

RayDevice::RayDevice(const std::string& resolvedIsa) : m_isa(resolvedIsa) {
    // "threads=" is left out on purpose: it would set TBB's parallelism for the whole process.
    const std::string config = "isa=" + m_isa;
    m_device = rtcNewDevice(config.c_str());
    if (!m_device) {
        check("making a device for " + config);
        throw Error(Status::kOutOfMemory, "out of memory: Embree makes no device for " + config);
    }
    rtcSetDeviceMemoryMonitorFunction(
        m_device,
        [](void* user, ssize_t bytes, bool) {
            static_cast<RayDevice*>(user)->m_bytes += bytes;
            return true;
        },
        this);
}

RayDevice::~RayDevice() {
    if (m_device) rtcReleaseDevice(m_device);
}

// Without a device too: Embree then tells this thread why there is none.
void RayDevice::check(const std::string& doing) const {
    const RTCError error = rtcGetDeviceError(m_device);
    if (error == RTC_ERROR_NONE) return;
    // Unknown is what becomes of an error that it has no memory to keep.
    if (error == RTC_ERROR_OUT_OF_MEMORY || error == RTC_ERROR_UNKNOWN)
        throw Error(Status::kOutOfMemory, "out of memory: Embree failed " + doing);
    throw Error(Status::kInternal, "Embree failed " + doing + ", error " + std::to_string(error));
}

RTCScene RayDevice::newScene() const {
    RTCScene scene = rtcNewScene(m_device);
    if (!scene) {
        check("making a scene");
        throw Error(Status::kOutOfMemory, "out of memory: Embree makes no scene");
    }
    // A filter only comes with rays that look for all their hits; others pay nothing for it.
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    return scene;
}

std::uint64_t RayDevice::commit(RTCScene scene, const CancelCheck& cancel) {
    constexpr std::chrono::milliseconds kBetweenLooks(20);
    std::unique_lock lock(m_building, std::defer_lock);
    while (!lock.try_lock_for(kBetweenLooks))
        cancel.throwIfSet("waiting for another scene's ray-tracing structure");
    const std::int64_t before = m_bytes;
    // Embree asks now and then whether to go on.
    CancelCheck check = cancel;
    rtcSetSceneProgressMonitorFunction(
        scene, [](void* user, double) { return !static_cast<const CancelCheck*>(user)->isSet(); },
        &check);
    rtcCommitScene(scene);
    rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
    const std::int64_t taken = m_bytes - before;
    cancel.throwIfSet("building the ray-tracing structure");
    this->check("building the ray-tracing structure");
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, taken));
}

}  // namespace pm
