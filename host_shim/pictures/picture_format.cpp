// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/picture_io.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

namespace pm::host {
namespace {

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

std::string lowerCaseExtension(const std::filesystem::path& path) {
    std::string text = path.extension().string();
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return text;
}

PictureFormat pictureFormat(const std::filesystem::path& path) {
    const std::string extension = lowerCaseExtension(path);
    if (extension == ".exr") return PictureFormat::kExr;
    if (extension == ".png") return PictureFormat::kPng;
    if (extension == ".jpg" || extension == ".jpeg") return PictureFormat::kJpeg;
    if (extension == ".tif" || extension == ".tiff") return PictureFormat::kTiff;
    const std::string ending = path.has_extension()
                                   ? fmt::format("'{}' is no picture format that can be written",
                                                 path.extension().string())
                                   : "its name has no ending, which tells the format";
    throw HostError(ExitCode::kUsage,
                    fmt::format("{}: {}; allowed are .exr, .png, .jpg, .jpeg, .tif and .tiff",
                                path.string(), ending));
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
