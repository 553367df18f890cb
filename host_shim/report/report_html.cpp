// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/report/report_html.h"

#include <fmt/format.h>

#include "host_shim/folders/own_folder.h"
#include "host_shim/process/plain_text.h"

namespace pm::host {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; color: #222; background: #fff;
       max-width: 1100px; margin: 0 auto; padding: 0 16px 48px; overflow-wrap: anywhere; }
h1 { font-size: 24px; margin: 24px 0 8px; }
h2 { font-size: 18px; margin: 32px 0 8px; border-bottom: 1px solid #ccc; }
p { margin: 6px 0; }
.status { padding: 8px 12px; border-left: 6px solid #2a7d3c; background: #eef7f0; }
.status.bad { border-color: #b3261e; background: #fbeceb; }
pre { background: #f3f3f3; padding: 8px; white-space: pre-wrap; }
/* What is wider than the page scrolls within itself. */
table, .wide { display: block; max-width: 100%; overflow-x: auto; }
.wide svg { max-width: none; }
table { border-collapse: collapse; margin: 6px 0; }
td, th { padding: 2px 14px 2px 0; text-align: left; vertical-align: top; overflow-wrap: normal;
         border-bottom: 1px solid #eee; font-variant-numeric: tabular-nums; }
td.long { overflow-wrap: anywhere; min-width: 160px; }
td code { white-space: nowrap; }
figure { margin: 8px 0; }
figcaption { color: #555; }
img, svg { display: block; max-width: 100%; height: auto; image-rendering: pixelated; }
.beside { display: flex; flex-wrap: wrap; gap: 12px; }
.beside figure { flex: 1 1 300px; min-width: 0; max-width: 100%; }
.window { overflow: auto; max-height: 80vh; } .window img { max-width: none; }
tr.bad td { background: #fbeceb; }
td img { max-width: none; }
.scale { display: inline-block; width: 160px; height: 10px; margin: 0 6px; }
.pair { position: relative; }
.pair img + img { position: absolute; left: 0; top: 0; clip-path: inset(0 0 0 50%); }
input[type=range] { max-width: 100%; margin: 0; }
.axis { stroke: #999; } .grid { stroke: #e4e4e4; } .label { font: 12px sans-serif; fill: #444; }
.key { display: inline-block; margin-right: 18px; color: #444; }
.key svg { display: inline; vertical-align: middle; margin-right: 6px; }
@media (max-width: 600px) { .label { font-size: 17px; } .wide .label { font-size: 12px; } }
)";

// Nothing is fetched from anywhere.
constexpr const char* kPolicy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

// Whether a cell's HTML has a word, such as a path, that alone would be wider than a phone.
bool hasLongWord(std::string_view html) {
    constexpr int kLongWord = 24;  // characters
    int length = 0;
    bool isTag = false;
    for (const char c : html) {
        if (c == '<' || c == '>')
            isTag = c == '<';
        else if (!isTag)
            length = c == ' ' || c == '\n' ? 0 : length + 1;
        if (length > kLongWord) return true;
    }
    return false;
}

std::string pageBeginning() {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\"/>\n",
        kPolicy);
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : plainLines(text)) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&#39;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

std::string section(std::string_view id, std::string_view heading, const std::string& content) {
    return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, escaped(heading),
                       content);
}

std::string paragraph(std::string_view text) {
    return fmt::format("<p>{}</p>\n", escaped(text));
}

std::string table(const Row& head, const std::vector<Row>& rows) {
    std::string text = "<table>\n";
    const auto add = [&](const Row& row, const char* cell) {
        text += "<tr>";
        for (const std::string& content : row)
            text += fmt::format("<{0}{1}>{2}</{0}>", cell,
                                hasLongWord(content) ? " class=\"long\"" : "", content);
        text += "</tr>\n";
    };
    if (!head.empty()) add(head, "th");
    for (const Row& row : rows) add(row, "td");
    return text + "</table>\n";
}

std::string codeBlock(std::string_view text) {
    return fmt::format("<pre><code>{}</code></pre>\n", escaped(text));
}

std::string details(std::string_view summary, const std::string& content) {
    return fmt::format("<details><summary>{}</summary>\n{}</details>\n", escaped(summary), content);
}

std::string wideBox(const std::string& content) {
    return fmt::format("<div class=\"wide\">\n{}</div>\n", content);
}

std::string wholePage(std::string_view title, const std::string& body, int refreshSeconds) {
    const std::string refresh =
        refreshSeconds > 0
            ? fmt::format("<meta http-equiv=\"refresh\" content=\"{}\"/>\n", refreshSeconds)
            : "";
    return pageBeginning() +
           fmt::format(
               "<meta name=\"generator\" content=\"pm_host\"/>\n"
               "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n{}"
               "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n{}</body>\n</html>\n",
               refresh, escaped(title), kStyle, body);
}

bool isOwnPage(const std::filesystem::path& file) {
    return beginsWith(file, pageBeginning());
}

}  // namespace pm::host
