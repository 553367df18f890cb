// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/values/failure.h"

#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

#include "integrator/values/error.h"

namespace pm::plugin {

namespace {

CallStatus statusOf(Status status) noexcept {
    switch (status) {
        case Status::kInvalidArgument:
            return CallStatus::kArgument;
        case Status::kInvalidScene:
            return CallStatus::kScene;
        case Status::kUnsupported:
            return CallStatus::kUnsupported;
        case Status::kOutOfMemory:
            return CallStatus::kMemory;
        case Status::kCancelled:
            return CallStatus::kCancelled;
        case Status::kIo:
            return CallStatus::kIo;
        case Status::kInternal:
            break;
    }
    return CallStatus::kInternal;
}

}  // namespace

CallStatus statusOfException(std::string& text) noexcept {
    const auto end = [&text](CallStatus status, const char* what) {
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
        return end(statusOf(error.status()), error.what());
    } catch (const std::bad_alloc&) {
        return end(CallStatus::kMemory, "out of memory");
    } catch (const std::length_error&) {
        return end(CallStatus::kMemory, "out of memory: an array would be longer than any can be");
    } catch (const std::system_error& error) {
        // Threads need memory, too, and their number may be limited.
        if (error.code() == std::errc::resource_unavailable_try_again)
            return end(CallStatus::kMemory,
                       "no thread can be started: out of memory or of processes");
        return end(CallStatus::kInternal, error.what());
    } catch (const std::exception& error) {
        return end(CallStatus::kInternal, error.what());
    } catch (...) {
        return end(CallStatus::kInternal, "an exception of unknown type");
    }
}

}  // namespace pm::plugin
