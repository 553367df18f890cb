// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/check/scene_check.h"

namespace pm::host {

// The outcomes as the XML that JUnit writes and continuous integration reads: a test suite of the
// suite's name, a test case a scene.
std::string junitXml(const Suite& suite, const std::vector<SceneOutcome>& outcomes);

// The scenes that were not right, of a file that junitXml() gave. Errors: HostError kFile where it
// can't be read, kBadInput where it is no such file.
std::vector<std::string> failedScenes(const std::filesystem::path& junit);

}  // namespace pm::host
