// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/source_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::streamsize kPieceBytes = 1 << 20;

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

std::string readWholeFile(const fs::path& file, const GoOn& goOn, std::uint64_t mostBytes) {
    refuseWhatIsNoFile(file);
    std::error_code unknown;
    const auto size = fs::file_size(file, unknown);
    std::ifstream stream = openFile(file);
    std::string text;
    if (!unknown) text.reserve(std::min<std::uint64_t>(size, mostBytes));
    // What it holds may be more or less by now than what it was said to hold.
    do {
        if (goOn) goOn();
        const std::size_t before = text.size();
        text.resize(before + kPieceBytes);
        stream.read(text.data() + before, kPieceBytes);
        text.resize(before + static_cast<std::size_t>(stream.gcount()));
        if (text.size() > mostBytes)
            throw HostError(ExitCode::kBadInput,
                            fmt::format("{}: has {} bytes; at most {} are read", file.string(),
                                        std::max<std::uint64_t>(size, text.size()), mostBytes));
    } while (stream);
    if (stream.bad())
        throw HostError(ExitCode::kFile, fmt::format("{}: can't be read", file.string()));
    return text;
}

}  // namespace pm::host
