// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <string_view>

namespace pm::host {

// What here does what an option does that other renderers have (Cycles, PBRT, Mitsuba, Arnold,
// LuxCore, POV-Ray, Blender's command line): "--size WxH is meant" or "pm has none: ..."; "" for a
// word that none of them is known for. word: as typed, without "=VALUE"; -, _ and letter case don't
// matter but for words of one letter, which may have their value behind it ("+W640", "-t8").
std::string_view aboutForeignWord(std::string_view word);

}  // namespace pm::host
