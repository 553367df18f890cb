// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <future>
#include <system_error>
#include <utility>

namespace pm::host {

// The result of work that is done beside the caller's own: in a thread, or, where there is none to
// be had or is not asked for, when the result is taken. What it throws comes out there. What the
// work refers to has to outlive the future, which waits for it.
template <typename Work>
auto doBeside(bool inThread, Work work) -> std::future<decltype(work())> {
    if (inThread) {
        try {
            return std::async(std::launch::async, work);
        } catch (const std::system_error&) {  // as many threads as there may be
        }
    }
    return std::async(std::launch::deferred, std::move(work));
}

}  // namespace pm::host
