// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/session/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "host_shim/report/report_charts.h"
#include "host_shim/report/report_command.h"
#include "host_shim/report/report_html.h"

namespace pm::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMapBytes = 300'000;
constexpr std::size_t kMostSlowest = 10;
constexpr std::size_t kMostCell = 2'000;  // bytes of a text that a file may have made long

std::string text(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

double number(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number() ? found->get<double>() : 0.0;
}

const Json& part(const Json& json, const char* key) {
    static const Json kNone = Json::object();
    const auto found = json.find(key);
    return found != json.end() ? *found : kNone;
}

std::vector<std::string> arguments(const Json& json) {
    std::vector<std::string> words;
    for (const Json& word : part(json, "commandLine"))
        if (word.is_string()) words.push_back(word.get<std::string>());
    return words;
}

// Cut where no character is torn.
std::string shortened(std::string words) {
    if (words.size() <= kMostCell) return words;
    std::size_t end = kMostCell;
    while (end > 0 && (static_cast<unsigned char>(words[end]) & 0xC0u) == 0x80u) --end;
    return words.substr(0, end) + " ...";
}

// A value with the unit that its key ends in.
std::string shownValue(const std::string& key, const Json& value) {
    if (value.is_string()) return shortened(value.get<std::string>());
    if (value.is_number() && key.ends_with("Bytes"))
        return fmt::format("{:.1f} MiB", value.get<double>() / 1048576);
    if (value.is_number() && key.find("econds") != std::string::npos)
        return fmt::format("{:.3f} s", value.get<double>());
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    return shortened(value.dump());
}

// Key and value of each plain member.
std::string objectTable(const Json& object) {
    std::vector<Row> rows;
    if (!object.is_object()) return {};
    for (const auto& [key, value] : object.items())
        if (!value.is_structured()) rows.push_back({escaped(key), escaped(shownValue(key, value))});
    return rows.empty() ? paragraph("None.") : table({}, rows);
}

std::string statusHtml(const Json& json) {
    const int code = static_cast<int>(number(json, "exitCode"));
    const std::string reason = text(json, "stopReason"), error = text(json, "error");
    std::string words =
        fmt::format("{}: {}. Exit code {}. {:.2f} s in all.", code == 0 ? "Done" : "Not done",
                    reason, code, number(part(json, "phases"), "elapsedSeconds"));
    if (!error.empty() && error != reason) words += " " + error;
    std::string html = fmt::format("<p class=\"status{}\">{}</p>\n", code == 0 ? "" : " bad",
                                   escaped(shortened(words)));
    std::vector<Row> rows;
    const auto row = [&](const char* name, const std::string& value) {
        if (!value.empty()) rows.push_back({name, escaped(shortened(value))});
    };
    row("scene", text(json, "scene"));
    for (const Json& output : part(json, "outputs"))
        if (output.is_string()) row("written", output.get<std::string>());
    if (json.contains("passesDone"))
        row("passes", fmt::format("{:.0f}, at most {:.0f}", number(json, "passesDone"),
                                  number(json, "passesPlanned")));
    if (number(json, "relMseEstimate") > 0)
        row("estimated relMSE",
            fmt::format("{}{:.3e}",
                        json.value("relMseEstimateIsLowerBound", Json()) == true ? "at least " : "",
                        number(json, "relMseEstimate")));
    row("what that looks like", text(json, "errorWords"));
    if (json.contains("relMseReference"))
        row("relMSE against the reference", fmt::format("{:.3e}", number(json, "relMseReference")));
    row("machine", text(json, "machine"));
    return section("status", "Status", html + (rows.empty() ? "" : table({}, rows)));
}

std::string warningsHtml(const Json& json) {
    constexpr std::size_t kMostRows = 50;
    std::vector<Row> rows;
    for (const Json& warning : part(json, "warnings")) {
        std::string words;
        for (const Json& line : part(warning, "texts"))
            if (line.is_string()) words.append(line.get<std::string>()).push_back('\n');
        if (rows.size() < kMostRows)
            rows.push_back({fmt::format("{:.0f}", number(warning, "code")),
                            fmt::format("{:.0f}", number(warning, "count")),
                            escaped(shortened(words))});
    }
    return section("warnings", "Warnings",
                   rows.empty() ? paragraph("None.") : table({"code", "times", "text"}, rows));
}

// Where the error or the clock ended the render: the number of its passes.
std::optional<long long> passesOfEarlierStop(const Json& json) {
    const std::string reason = text(json, "stopReason");
    const auto passes = static_cast<long long>(number(json, "passesDone"));
    if ((reason != "error target" && reason != "time limit") || passes < 1) return std::nullopt;
    return passes;
}

// The start of a command for one pixel; empty for a merge, which has no scene.
std::string onePixelCommand(const Json& json) {
    Arguments words = arguments(json);
    if (words.size() > 1 && words[1] == "merge") return {};
    if (const auto passes = passesOfEarlierStop(json)) words = ofPasses(words, *passes);
    return shellCommand(ofOnePixel(words));
}

std::string commandHtml(const Json& json) {
    const auto words = arguments(json);
    std::string html = codeBlock(shellCommand(words));
    if (const auto passes = passesOfEarlierStop(json))
        html += paragraph("The same picture whatever the clock says:") +
                codeBlock(shellCommand(ofPasses(words, *passes)));
    return section("command", "Command", html);
}

// What x and r are where the picture is far from a middle grey.
std::string scaledValues(const Json& json) {
    const double stops = number(json, "errorScaleStops");
    if (stops == 0) return {};
    return fmt::format(" of values times 2^{:.0f}, which make it as bright as a middle grey",
                       stops);
}

std::string errorHtml(const Json& json) {
    std::vector<Curve> curves{{"noise in it", "#8a8a8a", {}}, {"estimate", "#1f4e9c", {}}};
    for (const Json& point : part(json, "errorCurve")) {
        const double seconds = number(point, "seconds");
        curves[0].points.emplace_back(seconds, number(point, "noise"));
        curves[1].points.emplace_back(seconds, number(point, "estimatedRelMse"));
    }
    const std::string chart =
        errorChart(curves, {{"target", "#2a7d3c", number(part(json, "settings"), "errorTarget")},
                            {"against the reference", "#b3261e", number(json, "relMseReference")}});
    if (chart.empty())
        return section("error", "Error over time",
                       paragraph("No two estimates: they begin with the third pass, and parts "
                                 "that were merged carry no times."));
    return section(
        "error", "Error over time",
        chart +
            paragraph("Lower is better: four times the time halve the noise and leave a quarter "
                      "of its error. The error is relMSE, the picture's mean of "
                      "(x - r)\u00B2 / (r\u00B2 + 0.01)" +
                      scaledValues(json) +
                      ", as the render estimated it after its passes. The estimate covers: " +
                      text(json, "relMseEstimateCovers")));
}

std::string figuresHtml(const Json& json) {
    std::string html = section("time", "Time", objectTable(part(json, "phases")));
    html += section("memory", "Memory", objectTable(part(json, "memory")));
    std::string lines;
    for (const Json& line : part(part(json, "plan"), "lines"))
        if (line.is_string()) lines += paragraph(line.get<std::string>());
    html += section("more", "More figures",
                    details("plan", lines + objectTable(part(json, "plan"))) +
                        details("counters", objectTable(part(json, "counters"))) +
                        details("settings", objectTable(part(json, "settings"))) +
                        details("colour", objectTable(part(json, "colour"))) +
                        details("versions", objectTable(part(json, "versions"))));
    return html;
}

std::string onlyPixel(std::int32_t x, std::int32_t y) {
    return fmt::format("<code>--only-pixel {},{}</code>", x, y);
}

// What the pixels of a table go to.
std::string commandNote(const std::string& command) {
    if (command.empty())
        return paragraph("A pixel alone: add its option to the command that rendered the parts.");
    return paragraph("A pixel alone, printed and written to no file: add its option to") +
           codeBlock(command);
}

// Empty where there is none.
PixelRect around(const std::vector<BucketTimes::Bucket>& buckets) {
    PixelRect all;
    for (const auto& bucket : buckets) {
        const PmrRectangle& r = bucket.rectangle;
        if (all.empty()) all = {r.x0, r.y0, r.x1, r.y1};
        all = {std::min(all.x0, r.x0), std::min(all.y0, r.y0), std::max(all.x1, r.x1),
               std::max(all.y1, r.y1)};
    }
    return all;
}

// allSeconds: of all buckets.
std::string slowestHtml(std::vector<BucketTimes::Bucket> buckets, double allSeconds,
                        const std::string& onePixelCommand) {
    const std::size_t count = std::min(buckets.size(), kMostSlowest);
    std::ranges::partial_sort(buckets, buckets.begin() + static_cast<std::ptrdiff_t>(count),
                              std::greater<>(), &BucketTimes::Bucket::secondsPerPass);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < count; ++i) {
        const auto& bucket = buckets[i];
        const PmrRectangle& r = bucket.rectangle;
        rows.push_back(
            {fmt::format("{}", bucket.index), fmt::format("{},{},{},{}", r.x0, r.y0, r.x1, r.y1),
             fmt::format("{:.4f}", bucket.secondsPerPass()),
             fmt::format("{:.1f} %", allSeconds > 0 ? 100 * bucket.seconds / allSeconds : 0),
             onlyPixel((r.x0 + r.x1) / 2, (r.y0 + r.y1) / 2)});
    }
    return section(
        "slowest", "Slowest buckets",
        table({"bucket", "pixels x0,y0,x1,y1", "seconds a pass", "of all time", "its middle"},
              rows) +
            commandNote(onePixelCommand));
}

}  // namespace

std::string Report::pictureHtml() const {
    if (m_picture.dataUri.empty())
        return section("picture", "Picture", paragraph("There is none: nothing was rendered."));
    const std::string caption =
        fmt::format("{} x {} pixels from {},{}, through display and view.", m_window.width(),
                    m_window.height(), m_window.x0, m_window.y0);
    if (m_reference.dataUri.empty())
        return section("picture", "Picture", figureHtml(m_picture, "the picture", caption));
    const std::string html = section(
        "picture", "Picture and reference",
        sliderHtml(m_picture, "the picture", m_reference, "the reference") + paragraph(caption));
    return html + section("difference", "Difference from the reference",
                          figureHtml(m_difference, "difference from the reference",
                                     "Root of the pixel's part of relMSE.") +
                              scaleHtml("0", fmt::format("{:.3g} (1 pixel in 100 has more)",
                                                         m_mostDifference)));
}

std::string Report::layersHtml() const {
    if (m_picture.dataUri.empty()) return {};
    std::string html = section(
        "stderr", "Standard error",
        figureHtml(m_standardError, "standard error",
                   "Noise only, from the spread between passes, over the value: root of the mean "
                   "over R, G, B of stderr\u00B2 / (value\u00B2 + offset), as in relMSE; 0 with "
                   "one pass.") +
            scaleHtml("0", fmt::format("{:.3g} (1 pixel in 100 has more)", m_mostStandardError)));
    return html + section("levels", "Levels of anti-aliasing",
                          figureHtml(m_levels, "levels of anti-aliasing",
                                     fmt::format("1 + log4(samples in four passes), {:.2f} in the "
                                                 "mean; lowest and highest:",
                                                 m_meanLevel)) +
                              scaleHtml(fmt::format("{:.2f}", m_leastLevel),
                                        fmt::format("{:.2f}", m_mostLevel)));
}

std::string Report::bucketsHtml(const std::string& onePixelCommand) const {
    auto buckets = m_bucketTimes.timed();
    PixelRect window = m_window;
    if (window.empty()) window = around(buckets);  // a render that failed: as far as it came
    using Bucket = BucketTimes::Bucket;
    const std::string map = bucketMap(
        buckets, {"bucket-curve", "time", "s", &Bucket::secondsPerPass}, window, kMapBytes);
    if (map.empty() && !m_bucketSamples.dataUri.empty())
        return section(
            "buckets", "Buckets",
            figureHtml(m_bucketSamples, "samples of the buckets",
                       "Samples a bucket. None was timed here; parts carry no times, so that they "
                       "are the same bytes however often they are made.") +
                scaleHtml("0", fmt::format("{:.0f} samples", m_mostBucketSamples)));
    if (map.empty()) return section("buckets", "Buckets", paragraph("No bucket was timed."));
    double all = 0;
    for (const auto& bucket : buckets) all += bucket.seconds;
    std::string html = section(
        "buckets", "Buckets",
        map + paragraph(fmt::format("{} buckets, {:.3g} thread seconds from their starts to their "
                                    "ends; the line joins them in their order.",
                                    buckets.size(), all)));
    const std::string missed =
        bucketMap(buckets, {"bucket-misses", "cache misses", "MiB", &Bucket::cacheMibPerPass},
                  window, kMapBytes);
    if (!missed.empty())
        html +=
            section("misses", "Misses",
                    missed + paragraph("What bounded caches of geometry and photons had to make "
                                       "or read for each bucket."));
    return html + slowestHtml(std::move(buckets), all, onePixelCommand);
}

std::string Report::brightestHtml(const std::string& onePixelCommand) const {
    std::vector<Row> rows;
    for (const Pixel& pixel : m_brightest)
        rows.push_back({fmt::format("{},{}", pixel.x, pixel.y),
                        fmt::format("{:.4g}", pixel.luminance),
                        fmt::format("{:.4g}, {:.4g}, {:.4g}", pixel.colour[0], pixel.colour[1],
                                    pixel.colour[2]),
                        onlyPixel(pixel.x, pixel.y)});
    if (rows.empty()) return section("brightest", "Brightest pixels", paragraph("None."));
    return section("brightest", "Brightest pixels",
                   paragraph("Those that nothing near outshines.") +
                       table({"pixel", "luminance", "R, G, B", "alone"}, rows) +
                       commandNote(onePixelCommand));
}

std::string Report::page(const std::string& statistics) const {
    const Json json = Json::parse(statistics, nullptr, false);
    const std::string onePixel = onePixelCommand(json);
    const std::string title = "pm_host " + (onePixel.empty() ? "merge" : text(json, "scene"));
    std::string body = fmt::format("<h1>{}</h1>\n", escaped(shortened(title)));
    body += statusHtml(json) + warningsHtml(json) + commandHtml(json) + pictureHtml();
    body += errorHtml(json) + bucketsHtml(onePixel) + layersHtml() + brightestHtml(onePixel);
    body += figuresHtml(json);
    return wholePage(title, body);
}

}  // namespace pm::host
