// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The texts of -h, by the tables of options.
#include <CLI/CLI.hpp>

#include "host_shim/cli/command_line.h"
#include "host_shim/cli/option_table.h"

namespace pm::host {

std::string helpText(const SettingHelp& settingHelp) {
    Options options;
    Typed typed;
    CLI::App app("pm: a photon-mapping bucket renderer", "pm_host");
    addAll(app, typed, options, settingHelp);
    return app.help() + "\n" + mergeHelpText() + "\n" + cacheHelpText() + "\n" + checkHelpText() +
           "\n" + farmHelpText() + "\n" + packHelpText() + "\n" + watchHelpText();
}

std::string mergeHelpText() {
    Options options;
    Typed typed;
    CLI::App merge("pm_host merge: puts parts of one picture together", "pm_host merge");
    addAllOfMerge(merge, typed, options);
    return merge.help();
}

std::string farmHelpText() {
    Options options;
    options.farm.emplace();
    Typed typed;
    CLI::App farm(
        "pm_host farm SCENE [options of a render]: a picture by several machines; and besides",
        "pm_host farm");
    addFarmOptions(farm, typed, options);
    return farm.help();
}

std::string watchHelpText() {
    Options options;
    options.watch.emplace();
    Typed typed;
    CLI::App watch(
        "pm_host watch PART|FOLDER... -o FILE [options of merge]: collects parts while they come, "
        "until the picture is whole; and besides",
        "pm_host watch");
    addWatchOptions(watch, typed);
    return watch.help();
}

std::string packHelpText() {
    Options options;
    Typed typed;
    CLI::App pack(
        "pm_host pack SCENE [options of a render] -o FOLDER: a folder for a static server, of "
        "which pm_host http://.../FOLDER/manifest.json [options] renders",
        "pm_host pack");
    addPackOptions(pack, typed);
    return pack.help();
}

std::string cacheHelpText() {
    Options options;
    Typed typed;
    CLI::App cache("pm_host cache: the folder of prepared textures", "pm_host cache");
    addAllOfCache(cache, typed, options);
    return cache.help();
}

std::string checkHelpText() {
    Options options;
    options.check.emplace();
    Typed typed;
    CLI::App check("pm_host check: a suite of scenes against its references", "pm_host check");
    addAllOfCheck(check, typed, options);
    return check.help();
}

}  // namespace pm::host
