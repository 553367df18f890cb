// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace pm::host {

// Text up to a comment behind a blank: "wood.png # oak" is "wood.png". "Material #25" is
// "Material", so it is only for names that are not found as they stand.
std::string_view withoutComment(std::string_view text);

// The file in folder that a scene file means by name: as it stands; else with the slashes of
// another system, without quotes or a comment; else with letters a to z of the other case, as other
// systems find it. None where there is no such file.
std::optional<std::filesystem::path> findFile(const std::filesystem::path& folder,
                                              std::string_view name);

}  // namespace pm::host
