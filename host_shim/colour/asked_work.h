// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace pm::host {

// Calls `work` on a thread of its own and goOn (may be empty) on this one, before and again and
// again until work has ended; what work throws comes through. What goOn throws comes through at
// once: then the thread is left behind to end by itself, so `work` must own all that it uses. The
// next call waits for it, and so does the end of the process, unless that is by _exit. Threads:
// any. Errors: std::system_error where no thread can be made.
void callAsking(const std::function<void()>& goOn, std::function<void()> work);

// The same with a result.
template <typename Work>
auto runAsking(const std::function<void()>& goOn, Work work) {
    using Result = std::invoke_result_t<Work&>;
    const auto result = std::make_shared<std::optional<Result>>();
    callAsking(goOn, [result, work = std::move(work)]() mutable { result->emplace(work()); });
    return std::move(**result);
}

}  // namespace pm::host
