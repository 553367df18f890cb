// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/src/version.h"

#include <OpenImageIO/oiioversion.h>
#include <fmt/format.h>
#include <oneapi/tbb/version.h>

namespace pm::plugin {

namespace {

std::string openImageIoVersion() {
    return fmt::format("{}.{}.{}", OIIO_VERSION_MAJOR, OIIO_VERSION_MINOR, OIIO_VERSION_PATCH);
}

std::string tbbVersion() {
    return fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR);
}

}  // namespace

const std::string& versionText() {
    // Never destroyed: a host may keep the pointer to its very end.
    static const std::string& text = *new std::string(
        fmt::format("{} (embree {}, OpenImageIO {}, TBB {}, {})", PM_VERSION_TEXT,
                    PM_EMBREE_VERSION_TEXT, openImageIoVersion(), tbbVersion(), PM_BUILD_TEXT));
    return text;
}

nlohmann::ordered_json versionsJson() {
    return {{"pm", PM_VERSION_TEXT},
            {"build", PM_BUILD_TEXT},
            {"embree", PM_EMBREE_VERSION_TEXT},
            {"openImageIo", openImageIoVersion()},
            {"tbb", tbbVersion()}};
}

}  // namespace pm::plugin
