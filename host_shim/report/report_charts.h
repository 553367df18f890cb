// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host_shim/pictures/picture.h"
#include "host_shim/report/bucket_times.h"
#include "host_shim/report/report_pictures.h"

namespace pm::host {

// Drawings of a page, as inline SVG.

// Relative error over seconds, both axes logarithmic and labelled; points whose coordinates are not
// above 0 are left out, and so are levels. Levels are level lines: a target, the error against a
// reference. Empty with fewer than two points.
struct Curve {
    std::string name;
    std::string colour;
    std::vector<std::pair<double, double>> points;  // seconds, relMSE
};
struct ErrorLevel {
    std::string name;
    std::string colour;
    double value{};  // relMSE
};
std::string errorChart(const std::vector<Curve>& curves, const std::vector<ErrorLevel>& levels);

// What a heat map shows of buckets, a pass.
struct BucketQuantity {
    std::string id;    // of the drawing, in the page
    std::string name;  // "time"
    std::string unit;  // "s"
    double (BucketTimes::Bucket::*of)() const;
};

// That of each bucket as a heat map, and a line through the buckets' centres in their order.
// window: what the picture shows. Empty without buckets, or where all have none of it.
std::string bucketMap(const std::vector<BucketTimes::Bucket>& buckets,
                      const BucketQuantity& quantity, const PixelRect& window,
                      std::size_t mostBytes);

}  // namespace pm::host
