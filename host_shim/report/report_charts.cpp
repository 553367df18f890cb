// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/report/report_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_shim/report/report_html.h"

namespace pm::host {
namespace {

constexpr double kWidth = 600, kHeight = 320;  // of a chart, CSS pixels
// A phone shows the texts larger, for the chart is smaller there.
constexpr double kLeft = 94, kRight = 24, kTop = 12, kBottom = 54;

// One axis: from a value to a place, over whole decades.
struct LogAxis {
    int leastDecade{}, mostDecade{};
    double from{}, to{};

    LogAxis(double least, double most, double from_, double to_) : from(from_), to(to_) {
        leastDecade = static_cast<int>(std::floor(std::log10(least)));
        mostDecade = std::max(static_cast<int>(std::ceil(std::log10(most))), leastDecade + 1);
    }
    double place(double value) const {
        const double share = (std::log10(value) - leastDecade) / (mostDecade - leastDecade);
        return from + share * (to - from);
    }
    // Where a value stands: each decade, of few decades at 2 and 5 too.
    std::vector<double> marks() const {
        std::vector<double> values;
        for (int decade = leastDecade; decade <= mostDecade; ++decade)
            for (const double factor : {1.0, 2.0, 5.0})
                if (factor == 1 || (decade < mostDecade && mostDecade - leastDecade <= 2))
                    values.push_back(factor * std::pow(10.0, decade));
        return values;
    }
};

struct Range {
    double least{std::numeric_limits<double>::infinity()}, most{0};
    void add(double value) {
        least = std::min(least, value);
        most = std::max(most, value);
    }
};

std::string line(double x0, double y0, double x1, double y1, const char* style) {
    return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x0,
                       y0, x1, y1, style);
}

std::string label(double x, double y, const char* anchor, const std::string& text) {
    return fmt::format(
        "<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y,
        anchor, escaped(text));
}

std::string axes(const LogAxis& x, const LogAxis& y) {
    std::string text;
    for (const double value : x.marks()) {
        const double at = x.place(value);
        text += line(at, y.to, at, y.from, "class=\"grid\"");
        text += label(at, y.from + 18, "middle", fmt::format("{:g}", value));
    }
    for (const double value : y.marks()) {
        const double at = y.place(value);
        text += line(x.from, at, x.to, at, "class=\"grid\"");
        text += label(x.from - 6, at + 4, "end", fmt::format("{:g}", value));
    }
    text += line(x.from, y.from, x.to, y.from, "class=\"axis\"");
    text += line(x.from, y.from, x.from, y.to, "class=\"axis\"");
    text += label((x.from + x.to) / 2, kHeight - 10, "middle", "time, s");
    const double middle = (y.from + y.to) / 2;
    return text + fmt::format("<g transform=\"rotate(-90 18 {0:.1f})\">\n{1}</g>\n", middle,
                              label(18, middle, "middle", "error (relMSE), lower is better"));
}

bool isOnAxis(double value) {
    return value > 0 && std::isfinite(value);
}

bool canBeDrawn(const std::pair<double, double>& point) {
    return isOnAxis(point.first) && isOnAxis(point.second);
}

std::string polyline(const Curve& curve, const LogAxis& x, const LogAxis& y) {
    std::string points, dots;
    for (const auto& point : curve.points) {
        if (!canBeDrawn(point)) continue;
        const double px = x.place(point.first), py = y.place(point.second);
        points += fmt::format("{:.1f},{:.1f} ", px, py);
        dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\" fill=\"{}\"/>\n", px, py,
                            curve.colour);
    }
    return fmt::format(
               "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" points=\"{}\"/>\n",
               curve.colour, points) +
           dots;
}

// What a line of a chart stands for; under the drawing, where it can wrap.
std::string key(const std::string& colour, const char* dashes, const std::string& words) {
    return fmt::format(
        "<span class=\"key\"><svg width=\"18\" height=\"4\" "
        "aria-hidden=\"true\">{}</svg>{}</span>\n",
        line(0, 2, 18, 2,
             fmt::format("stroke=\"{}\" stroke-width=\"2\"{}", colour, dashes).c_str()),
        escaped(words));
}

// Each bucket's quantity, at 1/shrink of the window.
Plane bucketPlane(const std::vector<BucketTimes::Bucket>& buckets, const BucketQuantity& quantity,
                  const PixelRect& window, int shrink) {
    Plane plane{
        (window.width() + shrink - 1) / shrink, (window.height() + shrink - 1) / shrink, {}};
    plane.values.assign(static_cast<std::size_t>(plane.width) * plane.height, 0.0f);
    for (const auto& bucket : buckets) {
        const PmrRectangle& r = bucket.rectangle;
        const auto within = [shrink](std::int32_t v, std::int32_t first, std::int32_t most) {
            return std::clamp((v - first + shrink - 1) / shrink, 0, most);
        };
        for (int y = within(r.y0, window.y0, plane.height);
             y < within(r.y1, window.y0, plane.height); ++y)
            for (int x = within(r.x0, window.x0, plane.width);
                 x < within(r.x1, window.x0, plane.width); ++x)
                plane.values[static_cast<std::size_t>(y) * plane.width + x] =
                    static_cast<float>((bucket.*quantity.of)());
    }
    return plane;
}

}  // namespace

std::string errorChart(const std::vector<Curve>& curves, const std::vector<ErrorLevel>& levels) {
    constexpr const char* kDashes = " stroke-dasharray=\"5 4\"";
    Range seconds, errors;
    std::size_t count = 0;
    for (const Curve& curve : curves) {
        for (const auto& point : curve.points) {
            if (!canBeDrawn(point)) continue;
            seconds.add(point.first);
            errors.add(point.second);
            ++count;
        }
    }
    if (count < 2) return {};
    for (const ErrorLevel& level : levels)
        if (isOnAxis(level.value)) errors.add(level.value);
    const LogAxis x(seconds.least, seconds.most, kLeft, kWidth - kRight);
    const LogAxis y(errors.least, errors.most, kHeight - kBottom, kTop);
    std::string keys,
        text = fmt::format(
            "<svg width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" role=\"img\" "
            "aria-label=\"error over time; lower is better\">\n",
            kWidth, kHeight);
    text += axes(x, y);
    for (const Curve& curve : curves) {
        text += polyline(curve, x, y);
        keys += key(curve.colour, "", curve.name);
    }
    for (const ErrorLevel& level : levels) {
        if (!isOnAxis(level.value)) continue;
        const double at = y.place(level.value);
        text += line(
            x.from, at, x.to, at,
            fmt::format("stroke=\"{}\" stroke-width=\"1.5\"{}", level.colour, kDashes).c_str());
        keys += key(level.colour, kDashes, fmt::format("{}: {:.2e}", level.name, level.value));
    }
    return text + "</svg>\n<p>" + keys + "</p>\n";
}

std::string bucketMap(const std::vector<BucketTimes::Bucket>& buckets,
                      const BucketQuantity& quantity, const PixelRect& window,
                      std::size_t mostBytes) {
    constexpr double kMostPixels = 1e6;
    constexpr std::size_t kMostPoints = 20'000;
    if (buckets.empty() || window.empty()) return {};
    const int shrink = std::max(
        1,
        static_cast<int>(std::ceil(std::sqrt(static_cast<double>(window.area()) / kMostPixels))));
    double most = 0;
    for (const auto& bucket : buckets) most = std::max(most, (bucket.*quantity.of)());
    if (!(most > 0)) return {};
    const EmbeddedPicture heat = embedded(
        heatMap(bucketPlane(buckets, quantity, window, shrink), 0, static_cast<float>(most)),
        mostBytes);
    const std::size_t step = (buckets.size() + kMostPoints - 1) / kMostPoints;
    std::string points;
    for (std::size_t i = 0; i < buckets.size(); i += step) {
        const PmrRectangle& r = buckets[i].rectangle;
        points += fmt::format("{:g},{:g} ", (r.x0 + r.x1) / 2.0 - window.x0,
                              (r.y0 + r.y1) / 2.0 - window.y0);
    }
    std::string text = fmt::format(
        "<svg id=\"{}\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\" role=\"img\" "
        "aria-label=\"{} of the buckets and their order\">\n",
        quantity.id, heat.shownWidth, heat.shownHeight, window.width(), window.height(),
        quantity.name);
    text += fmt::format(
        "<image width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" href=\"{}\"/>\n",
        window.width(), window.height(), heat.dataUri);
    text += fmt::format(
        "<polyline fill=\"none\" stroke=\"#fff\" stroke-width=\"1.5\" stroke-opacity=\"0.8\" "
        "vector-effect=\"non-scaling-stroke\" points=\"{}\"/>\n</svg>\n",
        points);
    text += scaleHtml(fmt::format("0 {} a pass", quantity.unit),
                      fmt::format("{:.3g} {}", most, quantity.unit));
    if (step > 1) text += paragraph(fmt::format("The line joins every {}th bucket.", step));
    return text;
}

}  // namespace pm::host
