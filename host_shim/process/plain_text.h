// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <string_view>

namespace pm::host {

// Text that may hold names from files, so that a terminal or a page shows it and obeys nothing of
// it: control characters (C0, DEL, C1), separators of lines and paragraphs, marks that turn the
// direction of writing, and what XML can't hold, become "\x9b" or "\u202e", as do bytes that are no
// UTF-8. All else stays. Everything that leaves the program for people goes through here.
std::string plainText(std::string_view text);      // in one line: "\n" and "\t" become blanks
std::string plainLines(std::string_view text);     // "\n" and "\t" stay
std::string plainJson(std::string_view document);  // JSON stays the same JSON, by its own "\u202e"

// The text with what stands before '@' in the addresses in it, user and password, left out.
std::string withoutPasswords(std::string_view text);

}  // namespace pm::host
