// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/report/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host_shim/pictures/picture_io.h"
#include "host_shim/report/report_html.h"

namespace pm::host {
namespace {

constexpr int kMostPixels = 9'000'000;  // more are not even tried
constexpr int kBesideWidth = 340;       // of each of three in a row
constexpr int kLeastShownWidth = 640;   // small pictures are shown enlarged
constexpr int kMostShownWidth = 1068;   // of a page's column

using Rgb = std::array<float, 3>;

constexpr const char* kScrollTogether = R"(
for (const group of document.querySelectorAll('.beside')) {
  const windows = [...group.querySelectorAll('.window')];
  for (const one of windows) one.onscroll = () => {
    for (const other of windows)
      if (other !== one) other.scrollTo(one.scrollLeft, one.scrollTop);
  };
})";

// Stops of viridis (Nathaniel Smith and Stefan van der Walt, 2015; CC0).
constexpr std::array<std::uint32_t, 9> kStops{0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c,
                                              0x28ae80, 0x5ec962, 0xaddc30, 0xfde725};
constexpr Rgb kNotFinite{0.9f, 0.1f, 0.1f};

Rgb stop(std::size_t i) {
    const std::uint32_t code = kStops[i];
    const auto channel = [code](int shift) {
        return static_cast<float>((code >> shift) & 255u) / 255.0f;
    };
    return {channel(16), channel(8), channel(0)};
}

Rgb heatColour(float fraction) {
    const float place = std::clamp(fraction, 0.0f, 1.0f) * (kStops.size() - 1);
    const auto first = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
    const float t = place - static_cast<float>(first);
    const Rgb a = stop(first), b = stop(first + 1);
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

DisplayPicture shrunk(const DisplayPicture& picture, int factor) {
    if (factor == 1) return picture;
    const auto pieces = [factor](std::int32_t length) { return (length + factor - 1) / factor; };
    DisplayPicture small{pieces(picture.width), pieces(picture.height), picture.channels, {}};
    const auto channels = static_cast<std::size_t>(picture.channels);
    small.values.reserve(static_cast<std::size_t>(small.width) * small.height * channels);
    for (std::int32_t y = 0; y < picture.height; y += factor) {
        for (std::int32_t x = 0; x < picture.width; x += factor) {
            const std::int32_t x1 = std::min(x + factor, picture.width);
            const std::int32_t y1 = std::min(y + factor, picture.height);
            for (std::size_t c = 0; c < channels; ++c) {
                double sum = 0;
                for (std::int32_t v = y; v < y1; ++v)
                    for (std::int32_t u = x; u < x1; ++u)
                        sum += picture.values[(static_cast<std::size_t>(v) * picture.width + u) *
                                                  channels +
                                              c];
                small.values.push_back(static_cast<float>(sum / ((x1 - x) * (y1 - y))));
            }
        }
    }
    return small;
}

}  // namespace

EmbeddedPicture embedded(const DisplayPicture& picture, std::size_t mostBytes) {
    EmbeddedPicture result;
    result.width = picture.width;
    result.height = picture.height;
    const int enlarged = std::max(1, kLeastShownWidth / std::max(picture.width, 1));
    const double scale =
        std::min<double>(enlarged, static_cast<double>(kMostShownWidth) / picture.width);
    result.shownWidth = std::max(1, static_cast<int>(std::lround(picture.width * scale)));
    result.shownHeight = std::max(1, static_cast<int>(std::lround(picture.height * scale)));
    const double pixels = static_cast<double>(picture.width) * picture.height;
    result.shrunk = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMostPixels))));
    while (true) {
        result.dataUri = pngDataUri(shrunk(picture, result.shrunk));
        const bool isOnePixel = result.shrunk >= std::max(picture.width, picture.height);
        if (result.dataUri.size() <= mostBytes || isOnePixel) return result;
        ++result.shrunk;
    }
}

DisplayPicture heatMap(const Plane& plane, float least, float most) {
    DisplayPicture picture{plane.width, plane.height, 3, {}};
    picture.values.reserve(plane.values.size() * 3);
    const float span = most > least ? most - least : 1.0f;
    for (const float value : plane.values) {
        const Rgb colour = std::isfinite(value) ? heatColour((value - least) / span) : kNotFinite;
        picture.values.insert(picture.values.end(), colour.begin(), colour.end());
    }
    return picture;
}

Plane relativeDifference(std::int32_t width, std::int32_t height,
                         const std::array<const float*, 3>& reference,
                         const std::array<const float*, 3>& picture, double offset) {
    Plane plane{width, height, {}};
    plane.values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t i = 0; i < plane.values.size(); ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double r = reference[c][i], x = picture[c][i];
            sum += (x - r) * (x - r) / (r * r + offset);
        }
        plane.values[i] = static_cast<float>(std::sqrt(sum / 3));
    }
    return plane;
}

float quantile(const Plane& plane, double share) {
    std::vector<float> finite;
    std::ranges::copy_if(plane.values, std::back_inserter(finite),
                         [](float value) { return std::isfinite(value); });
    if (finite.empty()) return 0.0f;
    const auto rank = static_cast<std::ptrdiff_t>(std::clamp(share, 0.0, 1.0) *
                                                  static_cast<double>(finite.size() - 1));
    std::ranges::nth_element(finite, finite.begin() + rank);
    return finite[static_cast<std::size_t>(rank)];
}

std::string imageHtml(const EmbeddedPicture& picture, const std::string& alternative) {
    return fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\"/>\n",
                       picture.shownWidth, picture.shownHeight, escaped(alternative),
                       picture.dataUri);
}

std::string figureHtml(const EmbeddedPicture& picture, const std::string& alternative,
                       const std::string& caption) {
    if (picture.dataUri.empty()) return paragraph("There is none.");
    const std::string size = picture.shrunk == 1
                                 ? ""
                                 : fmt::format(" Shown at 1/{} of {} x {} pixels.", picture.shrunk,
                                               picture.width, picture.height);
    return fmt::format("<figure>{}<figcaption>{}{}</figcaption></figure>\n",
                       imageHtml(picture, alternative), escaped(caption), size);
}

std::string scaleHtml(const std::string& least, const std::string& most) {
    std::string colours;
    for (const std::uint32_t code : kStops) colours += fmt::format(",#{:06x}", code);
    return fmt::format(
        "<p>{}<span class=\"scale\" style=\"background:linear-gradient(to "
        "right{})\"></span>{}</p>\n",
        escaped(least), colours, escaped(most));
}

std::string besideHtml(const std::vector<Figure>& figures) {
    std::string content;
    for (const Figure& figure : figures) {
        EmbeddedPicture picture = figure.picture;
        const int enlarged = std::max(1, kBesideWidth / std::max(picture.width, 1));
        picture.shownWidth = picture.width * enlarged;
        picture.shownHeight = picture.height * enlarged;
        content += fmt::format(
            "<figure><div class=\"window\">{}</div><figcaption>{}</figcaption>"
            "</figure>\n",
            imageHtml(picture, figure.alternative), escaped(figure.caption));
    }
    return fmt::format("<div class=\"beside\">{}</div>\n<script>{}</script>\n", content,
                       kScrollTogether);
}

std::string sliderHtml(const EmbeddedPicture& left, const std::string& leftName,
                       const EmbeddedPicture& right, const std::string& rightName) {
    return fmt::format(
        "<figure><div class=\"pair\">{}{}</div>\n"
        "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" style=\"width:{}px\" "
        "aria-label=\"edge between the two\" "
        "oninput=\"document.querySelectorAll('.pair img')[1].style.clipPath="
        "'inset(0 0 0 ' + this.value + '%)'\"/>\n"
        "<figcaption>Left of the slider: {}; right of it: {}.</figcaption></figure>\n",
        imageHtml(left, leftName), imageHtml(right, rightName), left.shownWidth, escaped(leftName),
        escaped(rightName));
}

}  // namespace pm::host
