// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "plugin/src/api_functions.h"
#include "plugin/src/last_error.h"

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

PmrStatus toPmrStatus(Status status) noexcept {
    switch (status) {
        case Status::kInvalidArgument:
            return PMR_ERROR_ARGUMENT;
        case Status::kInvalidScene:
            return PMR_ERROR_SCENE;
        case Status::kUnsupported:
            return PMR_ERROR_UNSUPPORTED;
        case Status::kOutOfMemory:
            return PMR_ERROR_MEMORY;
        case Status::kCancelled:
            return PMR_ERROR_CANCELLED;
        case Status::kIo:
            return PMR_ERROR_IO;
        case Status::kInternal:
            break;
    }
    return PMR_ERROR_INTERNAL;
}

PmrStatus translateException(std::string& text) noexcept {
    const auto end = [&text](PmrStatus status, const char* what) {
        try {
            text = what;
        } catch (...) {
            text.clear();  // without memory for the text the status alone has to do
        }
        return status;
    };
    try {
        throw;
    } catch (const CallError& error) {
        return end(error.status(), error.what());
    } catch (const Error& error) {
        return end(toPmrStatus(error.status()), error.what());
    } catch (const std::bad_alloc&) {
        return end(PMR_ERROR_MEMORY, "out of memory");
    } catch (const std::length_error&) {
        return end(PMR_ERROR_MEMORY, "out of memory: an array would be longer than any can be");
    } catch (const std::system_error& error) {
        // Threads need memory, too, and their number may be limited.
        if (error.code() == std::errc::resource_unavailable_try_again)
            return end(PMR_ERROR_MEMORY, "no thread can be started: out of memory or of processes");
        return end(PMR_ERROR_INTERNAL, error.what());
    } catch (const std::exception& error) {
        return end(PMR_ERROR_INTERNAL, error.what());
    } catch (...) {
        return end(PMR_ERROR_INTERNAL, "an exception of unknown type");
    }
}

PmrStatus endCall(PmrStatus status) noexcept {
    if (status == PMR_OK)
        clearLastError();
    else
        setLastError(api::statusText(status));
    return status;
}

PmrStatus endCallByException() noexcept {
    std::string text;
    const PmrStatus status = translateException(text);
    setLastError(text.empty() ? api::statusText(status) : text.c_str());
    return status;
}

PmrStatus endCallWithoutObject(std::uintptr_t handle, ObjectKind kind) noexcept {
    try {
        throw CallError(PMR_ERROR_HANDLE,
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
