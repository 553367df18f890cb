// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/log/guarded.h"

#include <exception>
#include <new>
#include <system_error>

#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

int guarded(Log& log, const std::function<int()>& work, std::string* errorText) {
    constexpr int kOutOfMemory = static_cast<int>(ExitCode::kMemory);
    std::string text;
    int code = static_cast<int>(ExitCode::kInternal);
    try {
        return work();
    } catch (const HostError& error) {
        code = error.exitCode();
        text = error.what();
    } catch (const Interrupted& interrupted) {
        code = interrupted.exitCode;
        text = interrupted.what();
    } catch (const std::bad_alloc&) {
        code = kOutOfMemory;
        text = "out of memory";
    } catch (const std::system_error& error) {
        // Threads need memory, too, and their number may be limited.
        const bool isThread = error.code() == std::errc::resource_unavailable_try_again;
        if (isThread) code = kOutOfMemory;
        text = isThread ? "no thread can be started: out of memory or of processes"
                        : std::string("internal error: ") + error.what();
    } catch (const std::exception& error) {
        text = std::string("internal error: ") + error.what();
    } catch (...) {
        text = "internal error";
    }
    log.message(Level::kError, text);
    if (errorText != nullptr) *errorText = text;
    return code;
}

}  // namespace pm::host
