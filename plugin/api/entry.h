// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What stands around every function of the interface: nothing throws through it, the host's
// floating-point modes don't reach our arithmetic and come back, every failure leaves its text.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "plugin/api/handle_table.h"
#include "plugin/api/status.h"
#include "plugin/include/pm_plugin.h"
#include "plugin/values/call_error.h"
#include "plugin/values/forks.h"
#include "scheduler/buckets/fp_environment.h"

namespace pm::plugin {

class Merge;
class Render;

// What kind of handle stands for an object.
template <typename Object>
inline constexpr ObjectKind kKindOf = Object::kKind;
template <>
inline constexpr ObjectKind kKindOf<Render> = ObjectKind::kRender;
template <>
inline constexpr ObjectKind kKindOf<Merge> = ObjectKind::kMerge;

// What every function that returns a status ends with: its text becomes the last error of this
// thread, none after PMR_OK.
PmrStatus endCall(PmrStatus status) noexcept;
// The same in a catch block.
PmrStatus endCallByException() noexcept;
// The same for a handle that `kind` has not.
PmrStatus endCallWithoutObject(std::uintptr_t handle, ObjectKind kind) noexcept;

template <typename Object, typename Handle>
std::shared_ptr<Object> findObject(Handle handle) {
    return std::static_pointer_cast<Object>(
        handleTable().find(reinterpret_cast<std::uintptr_t>(handle), kKindOf<Object>));
}

// Calls body(shared_ptr<Object>) for the object of a handle. body returns nothing (PMR_OK) or a
// status.
template <typename Object, typename Handle, typename Body>
PmrStatus onObject(Handle handle, Body&& body) noexcept {
    const FpEnvironment environment;
    const Activity activity;
    try {
        const std::shared_ptr<Object> object = findObject<Object>(handle);
        if (!object)
            return endCallWithoutObject(reinterpret_cast<std::uintptr_t>(handle), kKindOf<Object>);
        if constexpr (std::is_void_v<decltype(body(object))>) {
            body(object);
            return endCall(PMR_OK);
        } else {
            return endCall(body(object));
        }
    } catch (...) {
        return endCallByException();
    }
}

// The same for a call without an object.
template <typename Body>
PmrStatus onNothing(Body&& body) noexcept {
    const FpEnvironment environment;
    const Activity activity;
    try {
        body();
        return endCall(PMR_OK);
    } catch (...) {
        return endCallByException();
    }
}

// Whether a fork cut the object of a live handle off.
template <typename Object, typename Handle>
bool isHandleCutOff(Handle handle) {
    return handleTable().isCutOff(reinterpret_cast<std::uintptr_t>(handle), kKindOf<Object>);
}

// Where a new handle goes: must not be null, and is null until there is one.
template <typename Handle>
void clearResult(Handle* result, const char* name) {
    if (result == nullptr)
        throw argumentError(std::string(name) + ": the pointer for the result is null");
    *result = nullptr;
}

template <typename Handle, typename Object>
Handle publish(std::shared_ptr<Object> object) {
    return reinterpret_cast<Handle>(handleTable().insert(kKindOf<Object>, std::move(object)));
}

template <typename Object, typename Handle>
PmrStatus retainHandle(Handle handle) noexcept {
    const Activity activity;
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    const bool live = handleTable().retain(number, kKindOf<Object>);
    return live ? endCall(PMR_OK) : endCallWithoutObject(number, kKindOf<Object>);
}

template <typename Object, typename Handle>
PmrStatus releaseHandle(Handle handle) noexcept {
    const FpEnvironment environment;
    const Activity activity;
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    bool live = false;
    {
        std::shared_ptr<void> last;  // ends before the call does: it may wait, or call the host
        live = handleTable().release(number, kKindOf<Object>, last);
    }
    return live ? endCall(PMR_OK) : endCallWithoutObject(number, kKindOf<Object>);
}

// Writes a text by the interface's rule for buffers; throws CallError(ARGUMENT) when it did not
// fit.
void writeText(const std::string& text, char* buffer, std::uint64_t capacity,
               std::uint64_t* needed);

}  // namespace pm::plugin
