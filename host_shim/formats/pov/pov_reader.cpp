// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/pov_reader.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "host_shim/formats/pov/animation.h"
#include "host_shim/formats/pov/evaluation/parser.h"
#include "host_shim/formats/pov/objects/scene_of.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/formats/text_lines.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// Where Debian's povray-includes puts POV-Ray's own include files.
constexpr std::string_view kInstalledLibrary = "/usr/share/povray-3.7/include";

SceneFileRules filesOf(const ReadRules& rules) {
    SceneFileRules files = rules.files;
    const fs::path library =
        rules.pov.library.empty() ? fs::path(kInstalledLibrary) : fs::path(rules.pov.library);
    std::error_code ignored;
    if (fs::is_directory(library, ignored)) {
        files.searchPaths.push_back(library);
        files.alsoAllowed.push_back(library);
    }
    return files;
}

PovIni iniBeside(const ReadRequest& request) {
    fs::path file = request.file;
    file.replace_extension(".ini");
    std::error_code ignored;
    constexpr std::uint64_t kMostBytes = 1 << 20;
    if (!fs::is_regular_file(file, ignored)) return {};
    return readPovIni(readWholeFile(file, request.goOn, kMostBytes));
}

// A number, else a text.
pov::Value declaredValue(const std::string& text) {
    double value = 0;
    if (parseNumber(text, value)) return pov::Numbers::of(value);
    const bool isQuoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return isQuoted ? text.substr(1, text.size() - 2) : text;
}

// What the scene hears of its surroundings. The request and files have to outlive it.
pov::Surroundings surroundingsOf(const ReadRequest& request, SceneFiles& files,
                                 std::vector<std::string>& read) {
    const PovRules& rules = request.rules.pov;
    pov::Surroundings around;
    const fs::path folder = request.file.parent_path();
    around.find = [&files, folder](const std::string& name) -> std::optional<std::string> {
        const auto found = files.find(folder, name);
        return found ? std::optional<std::string>(found->string()) : std::nullopt;
    };
    const std::uint64_t most = around.limits.bytesOfFile;
    around.read = [&request, &read, most](const std::string& file) {
        read.push_back(file);
        return readWholeFile(file, request.goOn, most);
    };
    const bool isTrusted = request.rules.files.isTrusted;
    around.writable = [folder, &rules,
                       isTrusted](const std::string& name) -> std::optional<std::string> {
        const fs::path inside = fs::path(name).lexically_normal();
        const bool leaves = inside.is_absolute() || *inside.begin() == "..";
        if (!rules.mayWrite || inside.empty() || (leaves && !isTrusted)) return std::nullopt;
        return (folder / inside).string();
    };
    around.debug = [&rules](const std::string& text) {
        if (rules.say) rules.say(text);
    };
    around.warn = [&request](const pov::Place& place, const std::string& text) {
        request.warn(Warning::kSceneLanguage, fmt::format("{}: {}", place.text(), text));
    };
    around.goOn = request.goOn;
    around.inputFileName = request.file.filename().string();
    const auto set = [&around](const char* name, double value) {
        around.variables[name] = pov::Numbers::of(value);
    };
    const PovIni ini = iniBeside(request);
    for (const auto& [name, value] : clockOf(ini, rules.frame)) set(name.c_str(), value);
    for (const auto& [name, value] : ini.declared) around.declared[name] = declaredValue(value);
    set("image_width", request.rules.size[0]);
    set("image_height", request.rules.size[1]);
    return around;
}

// "box: waits for shapes" and the like, each with its count and its first place.
std::string explanationOf(const pov::SceneOf& scene) {
    std::string text = fmt::format("scene: {} objects, {} lights, {} cameras\n", scene.objects,
                                   scene.lights, scene.cameras);
    for (const auto& [what, entry] : scene.leftOut)
        text += fmt::format("left out: {} {}, the first at {}\n", entry.count, what,
                            entry.first.text());
    return text;
}

void tellLeftOut(const pov::SceneOf& scene, const WarningSink& warn) {
    for (const auto& [what, entry] : scene.leftOut)
        warn(Warning::kGeometry,
             fmt::format("{}: {} (of these there are {})", entry.first.text(), what, entry.count));
}

}  // namespace

std::span<const std::string_view> PovReader::endings() const {
    static constexpr std::string_view kEndings[] = {".pov"};
    return kEndings;
}

SceneData PovReader::read(const ReadRequest& request) const {
    checkSceneFile(request.file, name());
    SceneFiles files(request.file.parent_path(), filesOf(request.rules));
    pov::Names names;
    std::vector<std::string> read;
    pov::Surroundings around = surroundingsOf(request, files, read);
    const std::string text = readWholeFile(request.file, request.goOn, around.limits.bytesOfFile);
    pov::Parser parser(std::move(around), names);
    pov::SceneOf scene = pov::sceneOf(parser.run(text, request.file.string()), request.rules.size);
    tellLeftOut(scene, request.warn);
    if (scene.data.instances.empty())
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: nothing that can be rendered: of {} objects none is a "
                                    "sphere, triangle, mesh, polygon or patch",
                                    request.file.string(), scene.objects));
    scene.data.explanation = explanationOf(scene);
    scene.data.files = std::move(read);
    return std::move(scene.data);
}

}  // namespace pm::host
