// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/host.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "host_shim/app/cache_command.h"
#include "host_shim/app/check_command.h"
#include "host_shim/app/frames_command.h"
#include "host_shim/app/listings.h"
#include "host_shim/cli/command_line.h"
#include "host_shim/copies/pack_run.h"
#include "host_shim/farm/farm_run.h"
#include "host_shim/log/guarded.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/process/plain_text.h"
#include "host_shim/render/plugin.h"
#include "host_shim/values/host_error.h"
#include "host_shim/watch/watch_run.h"

namespace pm::host {
namespace {

constexpr const char* kSceneLinearRole = "scene_linear";  // OpenColorIO's

void print(const std::string& given) {
    const std::string text = plainLines(given);
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
    constexpr std::array<std::pair<bool Options::*, std::string (*)()>, 6> kOfCommands{
        {{&Options::helpOfMerge, mergeHelpText},
         {&Options::helpOfCache, cacheHelpText},
         {&Options::helpOfFarm, farmHelpText},
         {&Options::helpOfWatch, watchHelpText},
         {&Options::helpOfPack, packHelpText},
         {&Options::helpOfCheck, checkHelpText}}};
    for (const auto& [isAsked, text] : kOfCommands) {
        if (!(options.*isAsked)) continue;
        print(text());
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

// No colour is converted for a listing: so the space that materials are in unless the user says
// otherwise, which may be out of the config's reach, isn't asked for.
ColourOptions listedColour(const Options& options) {
    ColourOptions colour = options.colour;
    if (colour.materialSpace.empty())
        colour.materialSpace =
            colour.renderingSpace.empty() ? std::string(kSceneLinearRole) : colour.renderingSpace;
    return colour;
}

int printList(const Options& options) {
    if (options.list == "views") {
        print(listViews(ColourPipeline(listedColour(options))));
    } else if (options.list == "looks") {
        print(listLooks(ColourPipeline(listedColour(options))));
    } else if (options.list == "spaces") {
        print(listSpaces(ColourPipeline(listedColour(options))));
    } else {
        const Plugin plugin(options.plugin);
        print(options.list == "aovs"         ? listLayers(plugin.api())
              : options.list == "orders"     ? listOrders(plugin.api())
              : options.list == "parameters" ? listParameters(plugin.api())
                                             : listSettings(plugin.api()));
    }
    return 0;
}

// Where memory is short all threads share one heap: with one each, what one thread gives back the
// others can't use, which took 30 MiB with two threads. And what is large, as photon maps, goes
// back to the system: in the heap it left gaps, 80 MiB after 32 passes.
void shareHeap(const Options& options) {
    const bool isShort = std::ranges::any_of(
        options.settings, [](const auto& given) { return given.name == "memoryLimitGib"; });
    if (!isShort) return;
    constexpr int kMib = 1 << 20;
    ::mallopt(M_ARENA_MAX, 1);
    ::mallopt(M_MMAP_THRESHOLD, kMib);
    ::mallopt(M_TRIM_THRESHOLD, 4 * kMib);
}

int runOptions(const Options& options, Log& log) {
    log.configure(logSettings(options));
    shareHeap(options);
    if (options.help) return printHelp(options);
    if (options.version) return printVersion(options);
    if (!options.list.empty()) return printList(options);
    if (options.cacheList || options.cacheClear || options.cacheVerify)
        return runCacheCommand(options);
    if (options.check) return runCheckCommand(*options.check);
    if (options.pack) return runPack(options, log);
    if (options.watch) return runWatch(options, log);
    if (options.farm) return runFarm(options, log);
    if (!options.frames.empty()) return runFrames(options, log);
    return runScene(options, log);
}

// Of the environment pm_host reads $OCIO and what its config names, and a few of its own. Its
// libraries would read more, and the same command line would then give another picture.
void forgetForeignVariables() {
    for (const char* name :
         {"OCIO_ACTIVE_DISPLAYS", "OCIO_ACTIVE_VIEWS", "OCIO_INACTIVE_COLORSPACES",
          "OCIO_OPTIMIZATION_FLAGS", "OPENIMAGEIO_OPTIONS", "OPENIMAGEIO_IMAGECACHE_OPTIONS",
          "OPENIMAGEIO_TEXTURE_OPTIONS"})
        unsetenv(name);
}

// A file that is opened while one of these is closed would take its number, and what is printed
// would go into it. Standard output is opened the wrong way, so that results that go nowhere are
// an error; messages may go nowhere.
void fillStandardDescriptors() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(descriptor, F_GETFD) < 0)
            static_cast<void>(open("/dev/null", descriptor == STDERR_FILENO ? O_WRONLY : O_RDONLY));
}

}  // namespace

int runProcess(int argc, char** argv) {
    fillStandardDescriptors();
    forgetForeignVariables();
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit then fails like on a full disk
    installInterruptHandlers();
    const int code = runHost({argv + 1, argv + argc});
    std::fflush(nullptr);
    // All is written; what libraries still have in work nobody wants any more.
    if (interruptSignal() != 0) _exit(code);
    return code;
}

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
