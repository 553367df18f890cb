// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the plots of the documents are drawn with.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace pm::bench {

// Colours that stay apart for colour-blind eyes (Okabe and Ito); they begin anew after eight.
const char* plotColour(std::size_t index);

// Elements of an SVG, each a line. more, style: attributes.
std::string textAt(double x, double y, const std::string& anchor, const std::string& text,
                   const std::string& more = "");
std::string straight(double x0, double y0, double x1, double y1, const std::string& style);

// Writes the file: these elements on white. Throws Error(kIo).
void writeSvgFile(const std::filesystem::path& file, double width, double height,
                  const std::string& elements);

}  // namespace pm::bench
