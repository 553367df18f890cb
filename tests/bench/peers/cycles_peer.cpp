// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Blender's Cycles: cycles_scene.py builds the scene and renders it in one process of Blender.
#include <fmt/format.h>

#include <charconv>
#include <fstream>
#include <sstream>

#include "integrator/values/error.h"
#include "tests/bench/peers/peers.h"
#include "tests/bench/run/child_process.h"

namespace pm::bench {

namespace {

double numberIn(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        throw Error(Status::kInternal, "cycles_scene.py printed '" + text + "' for a number");
    return value;
}

}  // namespace

std::vector<PeerPicture> renderWithCycles(const NeutralScene& scene, const PeerRequest& request) {
    if (!findProgram("blender")) return {};
    const std::filesystem::path log = request.folder / ("cycles_" + scene.key + ".log");
    const std::string script = PM_BENCH_FOLDER "/cycles_scene.py";
    const ChildResult done =
        runChild({"blender", "-b", "--factory-startup", "-noaudio", "--python-exit-code", "1", "-P",
                  script, "--", std::filesystem::absolute(request.scenesFile).string(), scene.key,
                  request.folder.string(), std::to_string(request.threads),
                  fmt::format("{}", request.seconds), "1"},
                 request.folder, log);
    std::vector<PeerPicture> pictures;
    std::ifstream in(log);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string name, samples, seconds, processorSeconds, file;
        if (!(words >> name >> samples >> seconds >> processorSeconds) || name != "cycles")
            continue;
        std::getline(words >> std::ws, file);
        pictures.push_back(
            {samples + " samples", numberIn(seconds), numberIn(processorSeconds), file});
    }
    if (done.exitCode != 0 || pictures.empty())
        throw Error(Status::kInternal,
                    fmt::format("blender ended with {}: {}", done.exitCode, lastLineOf(log)));
    return pictures;
}

}  // namespace pm::bench
