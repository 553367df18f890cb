// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/host.h"

#include "host_shim/app/cache_command.h"
#include "host_shim/app/guarded.h"
#include "host_shim/app/listings.h"
#include "host_shim/app/session.h"
#include "host_shim/cli/command_line.h"
#include "host_shim/pictures/host_error.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace pm::host {
namespace {

void print(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
}

Log::Settings logSettings(const Options& options) {
    const char* noColour = std::getenv("NO_COLOR");
    const bool colours = (noColour == nullptr || *noColour == '\0') && isatty(STDERR_FILENO) != 0;
    const Level least = options.quiet     ? Level::kWarning
                        : options.verbose ? Level::kDebug
                                          : Level::kInfo;
    return {least, colours};
}

// The help of settings comes from the plugin; without one the rest is still of use.
int printHelp(const Options& options) {
    if (options.helpOfMerge) {
        print(mergeHelpText());
        return 0;
    }
    if (options.helpOfCache) {
        print(cacheHelpText());
        return 0;
    }
    try {
        const Plugin plugin(options.plugin);
        print(helpText(
            [&plugin](const std::string& name) { return settingHelp(plugin.api(), name); }));
    } catch (const HostError&) {
        print(helpText([](const std::string& name) { return "setting " + name; }));
    }
    return 0;
}

int printVersion(const Options& options) {
    std::string plugin = "no plugin";
    try {
        plugin = Plugin(options.plugin).api().versionText();
    } catch (const HostError& error) {
        plugin = error.what();
    }
    print(fmt::format("pm_host {}\npm_plugin {}\n", PM_VERSION, plugin));
    return 0;
}

int printList(const Options& options) {
    if (options.list == "views") {
        print(listViews(ColourPipeline(options.colour)));
    } else if (options.list == "spaces") {
        print(listSpaces(ColourPipeline(options.colour)));
    } else {
        const Plugin plugin(options.plugin);
        print(options.list == "aovs"     ? listLayers(plugin.api())
              : options.list == "orders" ? listOrders(plugin.api())
                                         : listSettings(plugin.api()));
    }
    return 0;
}

int runOptions(const Options& options, Log& log) {
    log.configure(logSettings(options));
    if (options.help) return printHelp(options);
    if (options.version) return printVersion(options);
    if (!options.list.empty()) return printList(options);
    if (options.cacheList || options.cacheClear || options.cacheVerify)
        return runCacheCommand(options);
    return Session(options, log).run();
}

}  // namespace

int runHost(const std::vector<std::string>& arguments) {
    Log log({});
    const int code = guarded(log, [&] {
        Options options = parseCommandLine(arguments);
        options.commandLine = arguments;
        return runOptions(options, log);
    });
    // A result that did not get out is no result.
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    log.message(Level::kError, "standard output can't be written");
    return code != 0 ? code : static_cast<int>(ExitCode::kFile);
}

}  // namespace pm::host
