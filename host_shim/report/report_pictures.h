// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// One value a pixel, rows from the top.
struct Plane {
    std::int32_t width{}, height{};
    std::vector<float> values;
};

// A picture as it stands in a page.
struct EmbeddedPicture {
    std::string dataUri;  // empty: there is none
    // Of the whole picture, in its own pixels, and as the page shows it, in CSS pixels.
    std::int32_t width{}, height{};
    std::int32_t shownWidth{}, shownHeight{};
    int shrunk{1};  // each side, until the bytes fit
};

// Halves, thirds... the picture (mean of display values) until mostBytes hold its data URI.
// Errors: those of pngDataUri.
EmbeddedPicture embedded(const DisplayPicture& picture, std::size_t mostBytes);

// Colours from dark blue (least and below) over green to yellow (most and above); what is not
// finite is red.
DisplayPicture heatMap(const Plane& plane, float least, float most);

// Of each pixel what a picture is off by from a reference, as relMSE counts it: the root of the
// mean over the channels of (x - r)^2 / (r^2 + offset). offset: errorOffset().
Plane relativeDifference(std::int32_t width, std::int32_t height,
                         const std::array<const float*, 3>& reference,
                         const std::array<const float*, 3>& picture, double offset = 0.01);

// The value that a share of the finite ones, in [0,1], does not exceed; 0 without any.
float quantile(const Plane& plane, double share);

// <img> alone.
std::string imageHtml(const EmbeddedPicture& picture, const std::string& alternative);

// A picture with a caption of plain text; also where there is none.
std::string figureHtml(const EmbeddedPicture& picture, const std::string& alternative,
                       const std::string& caption);

// "0 [colours] 0.5", HTML, for the caption of a heat map. Texts are plain.
std::string scaleHtml(const std::string& least, const std::string& most);

struct Figure {
    EmbeddedPicture picture;
    std::string alternative, caption;  // plain
};
// Pictures of one size beside each other, where the page is wide enough, pixel for pixel or
// enlarged by a whole number; what is larger than its place scrolls there, and the others with it.
std::string besideHtml(const std::vector<Figure>& figures);

// Two pictures of one size, and a slider that moves the edge between them.
std::string sliderHtml(const EmbeddedPicture& left, const std::string& leftName,
                       const EmbeddedPicture& right, const std::string& rightName);

}  // namespace pm::host
