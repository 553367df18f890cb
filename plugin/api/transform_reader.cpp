// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/transform_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plugin/values/call_error.h"

namespace pm::plugin {

double determinant(const Transform& m) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

namespace {

// Whether the 3 x 3 part flattens space, at any scale of its rows.
bool isSingular(const Transform& m) {
    Transform scaled = m;
    for (std::size_t row = 0; row < 3; ++row) {
        const std::size_t first = 4 * row;
        const double size =
            std::max({std::abs(m[first]), std::abs(m[first + 1]), std::abs(m[first + 2])});
        if (size == 0.0) return true;
        for (std::size_t i = first; i < first + 3; ++i) scaled[i] /= size;
    }
    constexpr double kFlat = 1e-14;
    return std::abs(determinant(scaled)) < kFlat;
}

}  // namespace

Transform readTransform(const double* transforms, std::uint64_t count, const char* what) {
    if (count > 1)
        throw CallError(
            CallStatus::kUnsupported,
            fmt::format("{}: transformCount is {}; this version renders one time sample "
                        "only (no motion blur)",
                        what, count));
    if (transforms == nullptr && count == 0) return kIdentityTransform;
    if (transforms == nullptr)
        throw argumentError(fmt::format("{}: transforms is null, but transformCount is 1", what));
    if (count == 0)
        throw argumentError(fmt::format("{}: transforms is given, but transformCount is 0", what));
    Transform transform{};
    std::copy_n(transforms, transform.size(), transform.begin());
    for (std::size_t i = 0; i < transform.size(); ++i) {
        if (!std::isfinite(transform[i]))
            throw argumentError(
                fmt::format("{}: row {}, column {} of its transform is {}; it must "
                            "be finite",
                            what, i / 4, i % 4, transform[i]));
    }
    if (isSingular(transform))
        throw argumentError(fmt::format("{}: its transform has no inverse", what));
    return transform;
}

}  // namespace pm::plugin
