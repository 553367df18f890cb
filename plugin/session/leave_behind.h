// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Work that may take seconds inside a library which can't be told to stop: whoever cancels leaves
// it behind, and it ends by itself.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "integrator/values/cancel_check.h"

namespace pm::plugin {

// Calls `work` on a thread of its own and waits for it; what it throws comes through. When `cancel`
// is set, the check that work got is set too, for good; where work goes on nevertheless, its thread
// is left behind and Error(kCancelled) thrown: within 0.1 s in all. So work must own all that it
// uses, but for objects that live as long as the process. Its thread frees what it held.
//
// Before anything new is begun here, what was left behind must have ended, or the memory of many
// such could add up; `cancel` ends this wait, too. The end of the process waits for it, since
// libraries crash whose statics are destroyed under them; a child that the host forks has none.
// what: "cancelled while " and this. Threads: any. Errors: std::system_error where no thread can be
// made.
void callLeavable(const CancelCheck& cancel, const char* what,
                  std::function<void(const CancelCheck&)> work);

// The same with a result.
template <typename Work>
auto runLeavable(const CancelCheck& cancel, const char* what, Work work) {
    using Result = std::invoke_result_t<Work&, const CancelCheck&>;
    const auto result = std::make_shared<std::optional<Result>>();
    callLeavable(cancel, what, [result, work = std::move(work)](const CancelCheck& own) mutable {
        result->emplace(work(own));
    });
    return std::move(**result);
}

}  // namespace pm::plugin
