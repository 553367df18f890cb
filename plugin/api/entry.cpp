// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "plugin/api/api_functions.h"
#include "plugin/api/last_error.h"
#include "plugin/values/call_error.h"
#include "plugin/values/failure.h"

namespace pm::plugin {

namespace {

const char* handleType(ObjectKind kind) {
    switch (kind) {
        case ObjectKind::kContext:
            return "PmrContext";
        case ObjectKind::kMesh:
            return "PmrMesh";
        case ObjectKind::kTexture:
            return "PmrTexture";
        case ObjectKind::kMaterial:
            return "PmrMaterial";
        case ObjectKind::kScene:
            return "PmrScene";
        case ObjectKind::kRender:
            return "PmrRender";
        case ObjectKind::kMerge:
            return "PmrMerge";
    }
    return "handle";
}

}  // namespace

PmrStatus endCall(PmrStatus status) noexcept {
    if (status == PMR_OK)
        clearLastError();
    else
        setLastError(api::statusText(status));
    return status;
}

PmrStatus endCallByException() noexcept {
    std::string text;
    const PmrStatus status = toPmr(statusOfException(text));
    setLastError(text.empty() ? api::statusText(status) : text.c_str());
    return status;
}

PmrStatus endCallWithoutObject(std::uintptr_t handle, ObjectKind kind) noexcept {
    try {
        throw CallError(CallStatus::kHandle,
                        fmt::format("{:#x} is not a live {}", handle, handleType(kind)));
    } catch (...) {
        return endCallByException();
    }
}

void writeText(const std::string& text, char* buffer, std::uint64_t capacity,
               std::uint64_t* needed) {
    const std::uint64_t wanted = text.size() + 1;
    if (needed != nullptr) *needed = wanted;
    if (buffer == nullptr) {
        if (needed == nullptr) throw argumentError("buffer and needed are both null");
        return;
    }
    if (capacity == 0) throw argumentError("capacity is 0, but buffer is not null");
    const std::uint64_t copied = std::min<std::uint64_t>(text.size(), capacity - 1);
    std::memcpy(buffer, text.data(), copied);
    buffer[copied] = 0;
    if (capacity < wanted)
        throw argumentError(
            fmt::format("capacity is {} bytes; the text needs {}", capacity, wanted));
}

}  // namespace pm::plugin
