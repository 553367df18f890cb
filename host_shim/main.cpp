// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/host.h"
#include "host_shim/app/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace {

// Of the environment pm_host reads $OCIO and what its config names, and a few of its own. Its
// libraries would read more, and the same command line would then give another picture.
void forgetForeignVariables() {
    for (const char* name :
         {"OCIO_ACTIVE_DISPLAYS", "OCIO_ACTIVE_VIEWS", "OCIO_INACTIVE_COLORSPACES",
          "OCIO_OPTIMIZATION_FLAGS", "OPENIMAGEIO_OPTIONS", "OPENIMAGEIO_IMAGECACHE_OPTIONS",
          "OPENIMAGEIO_TEXTURE_OPTIONS"})
        unsetenv(name);
}

}  // namespace

// pm_host: renders a scene file through libpm_plugin.so.
int main(int argc, char** argv) {
    forgetForeignVariables();
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit then fails like on a full disk
    pm::host::installInterruptHandlers();
    const int code = pm::host::runHost({argv + 1, argv + argc});
    std::fflush(nullptr);
    // All is written; what libraries still have in work nobody wants any more.
    if (pm::host::interruptSignal() != 0) _exit(code);
    return code;
}
