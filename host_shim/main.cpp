// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/host.h"

// pm_host: renders a scene file through libpm_plugin.so.
int main(int argc, char** argv) {
    return pm::host::runProcess(argc, argv);
}
