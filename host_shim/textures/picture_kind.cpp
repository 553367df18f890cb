// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/picture_kind.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "host_shim/pictures/file_ending.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using namespace std::string_view_literals;

struct Mark {
    std::string_view bytes;
    const char* reader;
    std::size_t at{0};
};

constexpr std::array kMarks{
    Mark{"\x89PNG\r\n\x1a\n"sv, "png"},
    Mark{"\xff\xd8\xff"sv, "jpeg"},
    Mark{"II*\0"sv, "tiff"},
    Mark{"MM\0*"sv, "tiff"},
    Mark{"II+\0"sv, "tiff"},
    Mark{"MM\0+"sv, "tiff"},
    Mark{"\x76\x2f\x31\x01"sv, "openexr"},
    Mark{"#?RADIANCE"sv, "hdr"},
    Mark{"#?RGBE"sv, "hdr"},
    Mark{"GIF8"sv, "gif"},
    Mark{"BM"sv, "bmp"},
    Mark{"DDS "sv, "dds"},
    Mark{"8BPS"sv, "psd"},
    Mark{"SDPX"sv, "dpx"},
    Mark{"XPDS"sv, "dpx"},
    Mark{"\x80\x2a\x5f\xd7"sv, "cineon"},
    Mark{"\xd7\x5f\x2a\x80"sv, "cineon"},
    Mark{"WEBP"sv, "webp", 8},
    Mark{"\0\0\0\x0cjP  "sv, "jpeg2000"},
    Mark{"\xff\x4f\xff\x51"sv, "jpeg2000"},
    Mark{"\x01\xda"sv, "sgi"},
    Mark{"SIMPLE"sv, "fits"},
    Mark{"FOR4"sv, "iff"},
    Mark{"\x53\x80\xf6\x34"sv, "softimage"},
    Mark{"P1"sv, "pnm"},
    Mark{"P2"sv, "pnm"},
    Mark{"P3"sv, "pnm"},
    Mark{"P4"sv, "pnm"},
    Mark{"P5"sv, "pnm"},
    Mark{"P6"sv, "pnm"},
    Mark{"PF"sv, "pnm"},
    Mark{"Pf"sv, "pnm"},
    Mark{"ftyp"sv, "heif", 4},
    Mark{"\0\0\x01\0"sv, "ico"},
};

constexpr std::string_view kTargaFooter = "TRUEVISION-XFILE.";
constexpr std::size_t kTargaFooterSize = 26;

// A file of the system, closed with this.
struct OpenFile {
    explicit OpenFile(const std::filesystem::path& file)
        // A pipe or a device that nobody writes to would hold the open for ever.
        : descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
    ~OpenFile() {
        if (descriptor >= 0) ::close(descriptor);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    int descriptor;
};

template <std::size_t Size>
std::string_view readAt(const OpenFile& file, off_t offset, std::array<char, Size>& bytes) {
    const ssize_t got = ::pread(file.descriptor, bytes.data(), bytes.size(), offset);
    return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))};
}

// Colour map type, image type and depth that exist.
bool isTargaHeader(std::string_view head) {
    if (head.size() < 18) return false;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(head[i]); };
    const unsigned type = byte(2) & ~8u;
    const unsigned depth = byte(16);
    return byte(1) <= 1 && type >= 1 && type <= 3 &&
           (depth == 8 || depth == 15 || depth == 16 || depth == 24 || depth == 32);
}

bool isTarga(const std::filesystem::path& name, const OpenFile& file, off_t size,
             std::string_view head) {
    std::array<char, kTargaFooterSize> foot{};
    if (size >= static_cast<off_t>(foot.size()) &&
        readAt(file, size - static_cast<off_t>(foot.size()), foot)
            .substr(8)
            .starts_with(kTargaFooter))
        return true;
    const std::string extension = lowerCaseExtension(name);
    return (extension == ".tga" || extension == ".tpic") && isTargaHeader(head);
}

}  // namespace

std::string pictureReader(const std::filesystem::path& file) {
    const OpenFile open(file);
    struct stat status {};
    if (open.descriptor < 0 || ::fstat(open.descriptor, &status) != 0) {
        const std::string why =
            errno == ENOENT ? "does not exist" : fmt::format("can't be read: {}", strerror(errno));
        throw HostError(ExitCode::kFile, fmt::format("texture {} {}", file.string(), why));
    }
    if (!S_ISREG(status.st_mode))
        throw HostError(ExitCode::kFile, fmt::format("texture {} is not a file", file.string()));
    std::array<char, 32> bytes{};
    const std::string_view head = readAt(open, 0, bytes);
    for (const Mark& mark : kMarks)
        if (head.size() > mark.at && head.substr(mark.at).starts_with(mark.bytes))
            return mark.reader;
    return isTarga(file, open, status.st_size, head) ? "targa" : "";
}

}  // namespace pm::host
