// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plot/svg_parts.h"

#include <fmt/format.h>

#include <array>
#include <fstream>

#include "integrator/values/error.h"

namespace pm::bench {

namespace {

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else
            result += c;
    }
    return result;
}

}  // namespace

const char* plotColour(std::size_t index) {
    static constexpr std::array<const char*, 8> kColours = {
        "#0072b2", "#56b4e9", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#f0e442", "#404040"};
    return kColours[index % kColours.size()];
}

std::string textAt(double x, double y, const std::string& anchor, const std::string& text,
                   const std::string& more) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" {}>{}</text>\n", x, y,
                       anchor, more, escaped(text));
}

std::string straight(double x0, double y0, double x1, double y1, const std::string& style) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0,
                       y0, x1, y1, style);
}

void writeSvgFile(const std::filesystem::path& file, double width, double height,
                  const std::string& elements) {
    std::ofstream out(file);
    out << fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
               "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
               "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
               width, height)
        << elements << "</svg>\n";
    if (!out.flush()) throw Error(Status::kIo, file.string() + ": can't be written");
}

}  // namespace pm::bench
