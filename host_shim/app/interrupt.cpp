// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/interrupt.h"

#include <signal.h>
#include <unistd.h>

namespace pm::host {
namespace {

// What a signal handler may touch; there is no other way for it to say anything.
volatile sig_atomic_t s_signal = 0;

void handleSignal(int number) {
    if (s_signal != 0) _exit(128 + number);
    s_signal = number;
}

}  // namespace

void installInterruptHandlers() {
    struct sigaction action {};
    action.sa_handler = handleSignal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

int interruptSignal() {
    return s_signal;
}

void throwIfInterrupted() {
    if (s_signal != 0) throw Interrupted(s_signal);
}

}  // namespace pm::host
