// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/host.h"
#include "host_shim/app/interrupt.h"

#include <csignal>

// pm_host: renders a scene file through libpm_plugin.so.
int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);
    pm::host::installInterruptHandlers();
    return pm::host::runHost({argv + 1, argv + argc});
}
