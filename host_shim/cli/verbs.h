// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::host {

// What a command line asks for: its first word says so, without such a word a scene is rendered.
enum class Command { kRender, kMerge, kCache, kCheck, kFarm, kPack, kWatch };

Command commandOf(const std::vector<std::string>& arguments);

// What to say where the first word seems to be meant as a verb and is none, or a verb stands behind
// options: which verbs there are and which is likely; else "". hasMoreWords: of those that belong
// to no option; a word alone may be a scene's name, and is taken for a slip of the hand for a verb
// only where it is near to one. A file of that name is no verb. Reads the working folder.
std::string aboutVerbs(const std::vector<std::string>& arguments, bool hasMoreWords);

}  // namespace pm::host
