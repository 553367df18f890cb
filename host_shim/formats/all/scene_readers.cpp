// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/all/scene_readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "host_shim/formats/obj/obj_reader.h"
#include "host_shim/formats/pov/pov_reader.h"
#include "host_shim/pictures/file_ending.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

// A new format adds itself here, and its files to host_shim/CMakeLists.txt.
std::span<const SceneReader* const> sceneReaders() {
    static const ObjReader kObj;
    static const PovReader kPov;
    static const std::array<const SceneReader*, 2> kReaders{&kObj, &kPov};
    return kReaders;
}

const SceneReader& sceneReaderFor(const std::filesystem::path& file) {
    const std::string ending = lowerCaseExtension(file);
    std::vector<std::string_view> allowed;
    for (const SceneReader* reader : sceneReaders()) {
        const auto endings = reader->endings();
        if (std::ranges::find(endings, ending) != endings.end()) return *reader;
        allowed.insert(allowed.end(), endings.begin(), endings.end());
    }
    throw HostError(ExitCode::kBadInput,
                    fmt::format("{}: '{}' is no scene format that can be read; allowed {} {}",
                                file.string(), file.extension().string(),
                                allowed.size() == 1 ? "is" : "are", fmt::join(allowed, ", ")));
}

std::string sceneKinds() {
    std::string kinds;
    for (const SceneReader* reader : sceneReaders()) {
        if (!kinds.empty()) kinds += " or ";
        kinds += reader->name();
    }
    return kinds;
}

}  // namespace pm::host
