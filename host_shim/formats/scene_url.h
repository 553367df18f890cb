// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <string_view>

namespace pm::host {

// Whether a SCENE is the address of a packed scene: http://, https:// or file://.
bool isSceneUrl(std::string_view scene);

// What the address of a manifest is called by: the last folder of its path, "picture" where it has
// none. "http://server/shots/table/manifest.json" is "table".
std::string nameOfSceneUrl(std::string_view url);

}  // namespace pm::host
