// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// Pieces of a page that is HTML and well-formed XML at once. Texts are UTF-8.

// As content or as the value of an attribute; by plainLines().
std::string escaped(std::string_view text);

// <section> with a heading. content is HTML.
std::string section(std::string_view id, std::string_view heading, const std::string& content);

// A paragraph of plain text.
std::string paragraph(std::string_view text);

// A table; cells are HTML. head may be empty. Words that a phone has no room for may break; what is
// wider than the page all the same scrolls within itself.
using Row = std::vector<std::string>;
std::string table(const Row& head, const std::vector<Row>& rows);

// A code block with a plain text, to be copied.
std::string codeBlock(std::string_view text);

// What folds away under a line of plain text. content is HTML.
std::string details(std::string_view summary, const std::string& content);

// A drawing that is not to be made smaller: it scrolls within itself where the page is narrower.
std::string wideBox(const std::string& content);

// The whole page. title is plain text, body HTML. refreshSeconds: after that a browser reads it
// again; 0: it does not.
std::string wholePage(std::string_view title, const std::string& body, int refreshSeconds = 0);

// Whether a file begins as pages do that wholePage() gave, also those of versions before.
bool isOwnPage(const std::filesystem::path& file);

}  // namespace pm::host
