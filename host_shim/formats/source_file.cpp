// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/source_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

// What is no file may never end; opening a pipe would wait, deaf to Ctrl-C, for somebody to write
// into it.
void refuseWhatIsNoFile(const fs::path& file) {
    std::error_code ignored;
    const fs::file_status status = fs::status(file, ignored);
    if (!fs::exists(status) || fs::is_regular_file(status)) return;
    throw HostError(ExitCode::kFile,
                    fmt::format("{}: can't be read: it is a {}; a file is wanted", file.string(),
                                fs::is_directory(status) ? "folder"
                                : fs::is_fifo(status)    ? "pipe"
                                : fs::is_socket(status)  ? "socket"
                                                         : "device"));
}

std::ifstream openFile(const fs::path& file) {
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw HostError(ExitCode::kFile,
                        fmt::format("{}: can't be read: {}", file.string(), std::strerror(errno)));
    }
    return stream;
}

}  // namespace

void checkSceneFile(const fs::path& file, std::string_view wanted) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) {
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("{}: no geometry: this is a folder; {} is wanted", file.string(), wanted));
    }
    refuseWhatIsNoFile(file);
    openFile(file);
}

std::string readWholeFile(const fs::path& file) {
    refuseWhatIsNoFile(file);
    std::ifstream stream = openFile(file);
    std::ostringstream text;
    text << stream.rdbuf();
    if (stream.bad() || (text.fail() && !text.str().empty())) {
        throw HostError(ExitCode::kFile, fmt::format("{}: can't be read", file.string()));
    }
    return std::move(text).str();
}

}  // namespace pm::host
