// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <string_view>

namespace pm::host {

// A text of bytes as it would stand in the other of two encodings: what is no UTF-8 is taken for
// Windows-1252 (Latin-1 and its marks) and turned into UTF-8; UTF-8 of those letters is turned into
// Windows-1252. Empty where that changes nothing or can't be.
std::string inOtherEncoding(std::string_view text);

}  // namespace pm::host
