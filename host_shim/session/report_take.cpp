// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Report: what it gathers of a picture.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_shim/colour/display_picture.h"
#include "host_shim/pictures/compare.h"
#include "host_shim/session/report.h"

namespace pm::host {
namespace {

// Of data URIs; together with the rest they stay below 5 MB.
constexpr std::size_t kPictureBytes = 1'000'000;
constexpr std::size_t kDifferenceBytes = 700'000;
constexpr std::size_t kLayerBytes = 400'000;

constexpr std::int32_t kAtom = 8;  // pixels; see docs/orders.md
constexpr std::size_t kMostBrightest = 10;
constexpr std::int32_t kNearShare = 32;  // of the shorter side
// What lies above is shown like it: a few fireflies would leave the rest dark.
constexpr double kShareOfScale = 0.99;

constexpr std::array<const char*, 3> kColours{"R", "G", "B"};

const std::vector<float>& values(const Picture& picture, const char* name) {
    static const std::vector<float> kNone;
    const Channel* channel = picture.find(name);
    return channel != nullptr ? channel->values : kNone;
}

// Of R, G and B; the picture lives longer.
std::array<const float*, 3> beauty(const Picture& picture) {
    return {values(picture, "R").data(), values(picture, "G").data(), values(picture, "B").data()};
}

// R, G and B of a picture in a window that its data window holds.
Picture cropped(const Picture& picture, const PixelRect& window) {
    Picture result;
    result.width = picture.width;
    result.height = picture.height;
    result.dataWindow = window;
    const PixelRect& from = picture.dataWindow;
    for (const char* name : kColours) {
        Channel& channel = result.channels.emplace_back();
        channel.name = name;
        channel.values.reserve(static_cast<std::size_t>(window.area()));
        const float* all = values(picture, name).data();
        for (std::int32_t y = window.y0; y < window.y1; ++y) {
            const float* row = all + static_cast<std::ptrdiff_t>(y - from.y0) * from.width() +
                               (window.x0 - from.x0);
            channel.values.insert(channel.values.end(), row, row + window.width());
        }
    }
    return result;
}

// A layer of the window, its channels side by side.
std::vector<float> layer(const PictureSource& source, const PixelRect& window, const char* name,
                         std::size_t channels) {
    std::vector<float> pixels(static_cast<std::size_t>(window.area()) * channels);
    const PmrRectangle rectangle{window.x0, window.y0, window.x1, window.y1};
    source.readPixels(rectangle, name, pixels.data());
    return pixels;
}

// Of relMSE's kind: difference squared over value squared, with the same offset.
double relative(double difference, double value, double offset) {
    return difference * difference / (value * value + offset);
}

}  // namespace

void Report::takePicture(const PictureSource& source, const Picture& picture,
                         const Picture* reference, const DisplayTransform& display,
                         const std::array<double, 3>& luminance) {
    m_window = picture.dataWindow;
    m_picture = embedded(makeDisplayPicture(picture, display).picture, kPictureBytes);
    m_offset = errorOffset(errorScaleOf(picture).value_or(0));
    if (reference != nullptr) takeReference(picture, *reference, display);
    takeStandardError(source, picture);
    takeLevels(source);
    if (m_bucketTimes.timed().empty()) takeBucketSamples(source);
    takeBrightest(picture, luminance);
}

void Report::takeReference(const Picture& picture, const Picture& reference,
                           const DisplayTransform& display) {
    const Picture same = cropped(reference, m_window);
    m_reference = embedded(makeDisplayPicture(same, display).picture, kPictureBytes);
    const auto scale = errorScaleOf(reference);
    const Plane plane = relativeDifference(m_window.width(), m_window.height(), beauty(same),
                                           beauty(picture), scale ? errorOffset(*scale) : m_offset);
    m_mostDifference = quantile(plane, kShareOfScale);
    m_difference = embedded(heatMap(plane, 0, m_mostDifference), kDifferenceBytes);
}

void Report::takeStandardError(const PictureSource& source, const Picture& picture) {
    const auto errors = layer(source, m_window, "stderr", 3);
    Plane plane{m_window.width(), m_window.height(), {}};
    plane.values.resize(static_cast<std::size_t>(m_window.area()));
    const auto colours = beauty(picture);
    for (std::size_t i = 0; i < plane.values.size(); ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c)
            sum += relative(errors[3 * i + c], colours[c][i], m_offset);
        plane.values[i] = static_cast<float>(std::sqrt(sum / 3));
    }
    m_mostStandardError = quantile(plane, kShareOfScale);
    m_standardError = embedded(heatMap(plane, 0, m_mostStandardError), kLayerBytes);
}

void Report::takeLevels(const PictureSource& source) {
    Plane plane{m_window.width(), m_window.height(), layer(source, m_window, "aalevel", 1)};
    m_leastLevel = quantile(plane, 0);
    m_mostLevel = quantile(plane, 1);
    double sum = 0;
    for (const float level : plane.values) sum += level;
    m_meanLevel = plane.values.empty() ? 0 : sum / static_cast<double>(plane.values.size());
    m_levels = embedded(heatMap(plane, m_leastLevel, m_mostLevel), kLayerBytes);
}

// In place of their times, which parts don't carry: they must be the same bytes however often made.
void Report::takeBucketSamples(const PictureSource& source) {
    const auto json = nlohmann::json::parse(source.statistics());
    const std::int32_t size = json.at("buckets").at("sizePixels").get<std::int32_t>();
    // Buckets are of whole atoms, also where the window is not.
    const auto atom = [](std::int32_t v) { return v - ((v % kAtom) + kAtom) % kAtom; };
    const std::int32_t x0 = atom(m_window.x0), y0 = atom(m_window.y0);
    const std::int32_t columns = (m_window.x1 - x0 + size - 1) / size;
    const std::int32_t rows = (m_window.y1 - y0 + size - 1) / size;
    Plane plane{m_window.width(), m_window.height(), layer(source, m_window, "samples", 1)};
    std::vector<double> sums(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const auto sumOf = [&](std::size_t pixel) -> double& {
        const auto width = static_cast<std::size_t>(plane.width);
        const auto x = static_cast<std::int32_t>(pixel % width) + m_window.x0 - x0;
        const auto y = static_cast<std::int32_t>(pixel / width) + m_window.y0 - y0;
        return sums[static_cast<std::size_t>(y / size * columns + x / size)];
    };
    for (std::size_t i = 0; i < plane.values.size(); ++i)
        sumOf(i) += static_cast<double>(plane.values[i]);
    for (std::size_t i = 0; i < plane.values.size(); ++i)
        plane.values[i] = static_cast<float>(sumOf(i));
    m_mostBucketSamples = quantile(plane, 1);
    m_bucketSamples = embedded(heatMap(plane, 0, m_mostBucketSamples), kLayerBytes);
}

// Those that nothing near outshines, so that one lamp does not fill the list.
void Report::takeBrightest(const Picture& picture, const std::array<double, 3>& luminance) {
    const std::int32_t width = m_window.width(), height = m_window.height();
    std::vector<double> light(static_cast<std::size_t>(m_window.area()));
    const auto colours = beauty(picture);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < light.size(); ++i)
            light[i] += luminance[c] * static_cast<double>(colours[c][i]);
    const auto at = [&](std::int32_t x, std::int32_t y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    };
    const std::int32_t reach = std::max(1, std::min(width, height) / kNearShare);
    const auto outshone = [&](std::int32_t x, std::int32_t y) {
        const std::size_t me = at(x, y);
        for (std::int32_t v = std::max(y - reach, 0); v <= std::min(y + reach, height - 1); ++v)
            for (std::int32_t u = std::max(x - reach, 0); u <= std::min(x + reach, width - 1);
                 ++u) {
                const std::size_t other = at(u, v);
                // Of equal ones the first counts.
                if (light[other] > light[me] || (other < me && light[other] == light[me]))
                    return true;
            }
        return false;
    };
    const auto brighter = [](const Pixel& a, const Pixel& b) { return a.luminance > b.luminance; };
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) {
            const std::size_t i = at(x, y);
            const bool full = m_brightest.size() == kMostBrightest;
            if (!std::isfinite(light[i]) || light[i] <= 0) continue;
            if ((full && light[i] <= m_brightest.back().luminance) || outshone(x, y)) continue;
            Pixel pixel{m_window.x0 + x, m_window.y0 + y, light[i], {}};
            for (std::size_t c = 0; c < 3; ++c) pixel.colour[c] = colours[c][i];
            m_brightest.insert(std::ranges::upper_bound(m_brightest, pixel, brighter), pixel);
            if (m_brightest.size() > kMostBrightest) m_brightest.pop_back();
        }
}

}  // namespace pm::host
