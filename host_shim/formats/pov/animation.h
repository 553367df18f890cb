// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// What the .ini beside a scene says of its frames, their clock and what is declared before it.
// Other settings of POV-Ray's are not looked at.
struct PovIni {
    std::optional<double> clock;
    std::int64_t firstFrame{1}, lastFrame{1};
    double firstClock{0}, lastClock{1};
    bool isCyclic{};  // the clock of a frame after the last is lastClock
    std::map<std::string, std::string> declared;  // numbers, or texts in quotes

    bool isAnimation() const { return lastFrame > firstFrame; }
};

// "KEY = value" lines, in any case of letters, and +kNUMBER and the like; ; begins a comment.
PovIni readPovIni(std::string_view text);

// clock, frame_number and the others of a frame; none: the first one, and clock where it is given.
// POV-Ray's manual, 3.3.1.5.6 and 3.2.1.1.
std::map<std::string, double> clockOf(const PovIni& ini, std::optional<std::int64_t> frame);

}  // namespace pm::host
