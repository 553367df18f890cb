// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/scene_url.h"

#include <algorithm>
#include <array>

namespace pm::host {
namespace {

constexpr std::array<std::string_view, 3> kSchemes{"http://", "https://", "file://"};

}  // namespace

bool isSceneUrl(std::string_view scene) {
    return std::ranges::any_of(
        kSchemes, [scene](std::string_view scheme) { return scene.starts_with(scheme); });
}

std::string nameOfSceneUrl(std::string_view url) {
    url.remove_prefix(std::min(url.find("://") + 3, url.size()));
    url = url.substr(0, url.find_first_of("?#"));
    const std::size_t server = std::min(url.find('/'), url.size());
    std::string_view folder = url.substr(server, url.rfind('/') - server);
    folder.remove_prefix(std::min(folder.rfind('/') + 1, folder.size()));
    return folder.empty() ? "picture" : std::string(folder);
}

}  // namespace pm::host
