// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "host_shim/pictures/file_ending.h"
#include "host_shim/pictures/picture_io.h"
#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

// In the order of messages.
std::span<const PictureFormat* const> allFormats() {
    static const std::array<const PictureFormat*, 4> kFormats{&exrFormat(), &pngFormat(),
                                                              &jpegFormat(), &tiffFormat()};
    return kFormats;
}

// Null where no format has that ending.
const PictureFormat* formatOf(const std::string& ending) {
    for (const PictureFormat* format : allFormats()) {
        const auto endings = format->endings();
        if (std::ranges::find(endings, ending) != endings.end()) return format;
    }
    return nullptr;
}

void checkName(const std::filesystem::path& path) {
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (!std::filesystem::exists(status)) return;
    if (std::filesystem::is_directory(status)) {
        throw HostError(ExitCode::kFile,
                        fmt::format("{}: is a folder; an output is a file", path.string()));
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw HostError(ExitCode::kFile, fmt::format("{}: is not a regular file, so it can't be "
                                                     "replaced by a finished picture",
                                                     path.string()));
    }
    if (::access(path.c_str(), W_OK) != 0) {
        throw HostError(ExitCode::kFile, fmt::format("{}: exists and may not be written: {}",
                                                     path.string(), std::strerror(errno)));
    }
}

void checkFolder(const std::filesystem::path& path) {
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::error_code ignored;
    if (!std::filesystem::exists(folder, ignored)) {
        throw HostError(
            ExitCode::kFile,
            fmt::format("{}: the folder {} does not exist (--make-output-path makes it)",
                        path.string(), folder.string()));
    }
    if (!std::filesystem::is_directory(folder, ignored)) {
        throw HostError(ExitCode::kFile,
                        fmt::format("{}: {} is not a folder", path.string(), folder.string()));
    }
}

}  // namespace

const PictureFormat& pictureFormat(const std::filesystem::path& path) {
    if (const PictureFormat* format = formatOf(lowerCaseExtension(path))) return *format;
    const std::string ending = path.has_extension()
                                   ? fmt::format("'{}' is no picture format that can be written",
                                                 path.extension().string())
                                   : "its name has no ending, which tells the format";
    const std::vector<std::string_view> endings = pictureEndings();
    throw HostError(
        ExitCode::kUsage,
        fmt::format("{}: {}; allowed are {} and {}", path.string(), ending,
                    fmt::join(endings.begin(), endings.end() - 1, ", "), endings.back()));
}

std::vector<std::string_view> pictureEndings() {
    std::vector<std::string_view> all;
    for (const PictureFormat* format : allFormats()) {
        const auto endings = format->endings();
        all.insert(all.end(), endings.begin(), endings.end());
    }
    return all;
}

std::string usualEndings(bool displayReferred) {
    std::vector<std::string_view> endings;
    for (const PictureFormat* format : allFormats())
        if (format->isDisplayReferred() == displayReferred)
            endings.push_back(format->endings().front());
    return fmt::format("{}", fmt::join(endings, " "));
}

bool isDisplayReferred(const PictureFormat& format) {
    return format.isDisplayReferred();
}

bool isDisplayPictureName(const std::filesystem::path& path) {
    const PictureFormat* format = formatOf(lowerCaseExtension(path));
    return format != nullptr && format->isDisplayReferred();
}

ExrReport writeLinearPicture(const std::filesystem::path& path, const Picture& picture,
                             const ExrOptions& options) {
    const auto* format = dynamic_cast<const LinearFormat*>(&pictureFormat(path));
    if (format == nullptr)
        throw HostError(ExitCode::kInternal,
                        path.string() + ": scene-linear values are never written as codes");
    return format->write(path, picture, options);
}

void checkWritable(const std::filesystem::path& path) {
    pictureFormat(path);
    checkFolder(path);
    checkName(path);
    // Permissions, read-only file systems, quotas and full inode tables all tell themselves by
    // making a file; permission bits alone say nothing to root.
    const FinishedFile probe(path);
}

}  // namespace pm::host
