// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/tessellated.h"

#include <fmt/format.h>

#include "integrator/values/error.h"
#include "tests/bench/run/child_process.h"
#include "tests/bench/run/pictures.h"

namespace pm::bench {

namespace {

constexpr const char* kIcosphereLevels = "6";  // 20 * 4^6 triangles a sphere

void runOrThrow(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
    const std::filesystem::path log = folder / "log";
    const ChildResult done = runChild(arguments, folder, log);
    if (done.exitCode != 0)
        throw Error(Status::kInternal, fmt::format("{} ended with {}: {}", arguments[0],
                                                   done.exitCode, lastLineOf(log)));
}

std::string triple(Vec3d v) {
    return fmt::format("{},{},{}", v.x, v.y, v.z);
}

std::vector<double> renderObj(const NeutralScene& scene, const std::filesystem::path& folder,
                              const Settings& settings) {
    const NeutralCamera& camera = scene.camera;
    runOrThrow({PM_HOST_FILE,   scene.name + ".obj",
                "-o",           "out.exr",
                "--size",       fmt::format("{0}x{0}", scene.size),
                "--eye",        triple(camera.position),
                "--look-at",    triple(camera.lookAt),
                "--up",         triple(camera.up),
                "--fov",        fmt::format("{}", camera.verticalDegrees),
                "--integrator", settings.at("integrator"),
                "--aa",         settings.at("aaLevel") + ":" + settings.at("aaLevelMost"),
                "--threads",    settings.at("threads"),
                "--passes",     settings.at("passes"),
                "--seed",       settings.at("seed"),
                "--plugin",     PM_PLUGIN_FILE},
               folder);
    return readPicture(folder / "out.exr").rgb;
}

}  // namespace

std::optional<TessellatedFloor> tessellatedFloor(const NeutralScene& scene,
                                                 const std::filesystem::path& scenesFile,
                                                 const Yardstick& yardstick,
                                                 const LadderRequest& request,
                                                 const LadderStep& step) {
    const std::filesystem::path script =
        std::filesystem::absolute(scenesFile.parent_path() / "neutral_to_obj.py");
    if (!std::filesystem::exists(script) || !findProgram("python3")) return std::nullopt;
    const TemporaryFolder folder;
    runOrThrow({"python3", "-B", script.string(), std::filesystem::absolute(scenesFile).string(),
                folder.path().string(), kIcosphereLevels},
               folder.path());
    std::array<std::vector<double>, 2> pictures;
    for (int i = 0; i < 2; ++i)
        pictures[static_cast<std::size_t>(i)] =
            renderObj(scene, folder.path(), settingsFor(request, step.passes, i + 1));
    return TessellatedFloor{
        yardstick.commonError(pictures[0], pictures[1]),
        yardstick.commonDifference(pictures[0], step.pictures[0], pictures[1], step.pictures[1])};
}

}  // namespace pm::bench
