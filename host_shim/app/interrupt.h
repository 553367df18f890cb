// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <stdexcept>

namespace pm::host {

// Installs handlers for SIGINT and SIGTERM: the first is noted, a second ends the process at once
// with 128 + signal. Only main calls this.
void installInterruptHandlers();

// The signal that came, 0 when none did.
int interruptSignal();

// Thrown between the steps of the work when a signal has come.
struct Interrupted : std::runtime_error {
    explicit Interrupted(int signal)
        : std::runtime_error(signal == 2 ? "interrupted" : "terminated"), exitCode(128 + signal) {}
    int exitCode;
};
void throwIfInterrupted();

}  // namespace pm::host
