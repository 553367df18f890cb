// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host_shim/colour/display_transform.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/render/picture_source.h"
#include "host_shim/report/bucket_times.h"
#include "host_shim/report/report_pictures.h"

namespace pm::host {

// What --report FILE.html writes: one page that needs no other file, of less than 5 MB, for a
// render or a merge that ended in whatever way. It is gathered while there is something to gather.
class Report {
  public:
    // Filled by the render; see there.
    BucketTimes& bucketTimes() { return m_bucketTimes; }

    // The picture with what lies beside it; reference may be null. luminance: weights of R, G and
    // B. Errors: those of the plugin and of pngDataUri.
    void takePicture(const PictureSource& source, const Picture& picture, const Picture* reference,
                     const DisplayTransform& display, const std::array<double, 3>& luminance);

    // statistics: what --stats writes.
    std::string page(const std::string& statistics) const;

  private:
    struct Pixel {
        std::int32_t x{}, y{};
        double luminance{};
        std::array<float, 3> colour{};
    };

    void takeReference(const Picture& picture, const Picture& reference,
                       const DisplayTransform& display);
    void takeStandardError(const PictureSource& source, const Picture& picture);
    void takeLevels(const PictureSource& source);
    void takeBucketSamples(const PictureSource& source);
    void takeBrightest(const Picture& picture, const std::array<double, 3>& luminance);

    std::string pictureHtml() const;
    std::string bucketsHtml(const std::string& onePixelCommand) const;
    std::string brightestHtml(const std::string& onePixelCommand) const;
    std::string layersHtml() const;

    BucketTimes m_bucketTimes;
    PixelRect m_window;
    double m_offset = 0;  // of relMSE's denominator, by the picture's error scale
    EmbeddedPicture m_picture, m_reference, m_difference, m_standardError, m_levels;
    EmbeddedPicture m_bucketSamples;  // only where no bucket was timed
    float m_mostDifference{}, m_mostStandardError{}, m_leastLevel{}, m_mostLevel{};
    double m_meanLevel{};
    float m_mostBucketSamples{};
    std::vector<Pixel> m_brightest;
};

}  // namespace pm::host
