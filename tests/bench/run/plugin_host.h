// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A small host of the library: what the benchmark of pictures measures goes through the C
// interface, as it would for anybody.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "plugin/include/pm_plugin.h"
#include "tests/bench/run/neutral_scene.h"

namespace pm::bench {

using Settings = std::map<std::string, std::string>;  // names and values of setSettingText

// A finished picture and what it took, from an empty context to the pixels in the host's memory.
struct HostedRender {
    std::vector<double> rgb;  // linear Rec.709, row by row
    double seconds = 0, processorSeconds = 0;
    std::string statistics;  // JSON
};

// The library, loaded at run time. Errors: everything throws Error(kInternal) with the library's
// own text, or Error(kIo) when the library can't be loaded.
class PluginHost {
  public:
    explicit PluginHost(const std::filesystem::path& library);

    // Whether a setting of that name exists, with this among its choices.
    bool offers(const std::string& setting, const std::string& choice) const;

    // The least value that a numeric setting takes.
    double least(const std::string& setting) const;

    // One render of a neutral scene with analytic spheres. Threads: one call at a time, so that the
    // seconds are its own.
    HostedRender render(const NeutralScene& scene, const Settings& settings) const;

  private:
    const PmrApi* m_api = nullptr;
};

}  // namespace pm::bench
