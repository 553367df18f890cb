// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/texture_index.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <new>

#include "host_shim/folders/own_folder.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::string_view kCheckKey = "check ", kUnique = "tmp-";
constexpr std::size_t kUniqueDigits = 16;
constexpr std::size_t kLargestRecord = 1 << 16;

std::int64_t nanoseconds(const timespec& time) {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

struct Descriptor {
    explicit Descriptor(int opened) : value(opened) {}
    ~Descriptor() {
        if (value >= 0) ::close(value);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int value;
};

struct FreeHash {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

std::string digits(const XXH128_hash_t& hash) {
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

bool writeAll(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

template <typename Number>
bool parse(std::string_view text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string FileStamp::text() const {
    return fmt::format("{} {} {} {} {}", device, inode, size, modified, changed);
}

std::optional<FileStamp> FileStamp::fromText(const std::string& text) {
    std::array<std::string, 5> parts;
    std::size_t part = 0;
    for (const char c : text) {
        if (c == ' ' && ++part == parts.size()) return std::nullopt;
        if (c != ' ') parts[part] += c;
    }
    FileStamp stamp;
    const bool good = parse(parts[0], stamp.device) && parse(parts[1], stamp.inode) &&
                      parse(parts[2], stamp.size) && parse(parts[3], stamp.modified) &&
                      parse(parts[4], stamp.changed);
    return good ? std::optional(stamp) : std::nullopt;
}

std::optional<FileStamp> stampOf(const std::filesystem::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
    return FileStamp{static_cast<std::uint64_t>(status.st_dev),
                     static_cast<std::uint64_t>(status.st_ino),
                     static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim),
                     nanoseconds(status.st_ctim)};
}

std::string hashText(const std::string& text) {
    return digits(XXH3_128bits(text.data(), text.size()));
}

std::string hashFile(const std::filesystem::path& file, const std::function<void()>& goOn) {
    const Descriptor open(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    const auto fail = [&] {
        throw HostError(ExitCode::kFile, fmt::format("texture {} can't be read: {}", file.string(),
                                                     std::strerror(errno)));
    };
    if (open.value < 0) fail();
    const std::unique_ptr<XXH3_state_t, FreeHash> state(XXH3_createState());
    if (!state) throw std::bad_alloc();
    XXH3_128bits_reset(state.get());
    std::vector<char> bytes(std::size_t{1} << 20);
    while (true) {
        if (goOn) goOn();
        const ssize_t got = ::read(open.value, bytes.data(), bytes.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail();
        if (got == 0) return digits(XXH3_128bits_digest(state.get()));
        XXH3_128bits_update(state.get(), bytes.data(), static_cast<std::size_t>(got));
    }
}

void Record::set(const std::string& key, const std::string& value) {
    std::string line = value;
    std::ranges::replace(line, '\n', ' ');
    m_values[key] = line;
}

void Record::setNumber(const std::string& key, std::int64_t value) {
    m_values[key] = fmt::format("{}", value);
}

std::string Record::get(const std::string& key) const {
    const auto found = m_values.find(key);
    return found == m_values.end() ? std::string() : found->second;
}

std::int64_t Record::number(const std::string& key) const {
    std::int64_t value = 0;
    return parse(get(key), value) ? value : 0;
}

bool Record::write(const std::filesystem::path& file) const {
    std::string text;
    for (const auto& [key, value] : m_values) text += key + " " + value + "\n";
    text += std::string(kCheckKey) + hashText(text) + "\n";
    const std::filesystem::path temporary = makeTemporaryBeside(file);
    if (temporary.empty()) return false;
    bool good = false;
    {
        const Descriptor open(::open(temporary.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW));
        good = open.value >= 0 && writeAll(open.value, text);
    }
    good = good && ::rename(temporary.c_str(), file.c_str()) == 0;
    if (!good) ::unlink(temporary.c_str());
    return good;
}

std::optional<Record> Record::read(const std::filesystem::path& file) {
    const Descriptor open(
        ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | O_NOFOLLOW));
    if (open.value < 0) return std::nullopt;
    std::string text(kLargestRecord, '\0');
    const ssize_t got = ::read(open.value, text.data(), text.size());
    if (got <= 0) return std::nullopt;
    text.resize(static_cast<std::size_t>(got));
    const auto check = text.rfind(kCheckKey);
    if (check == std::string::npos || (check > 0 && text[check - 1] != '\n') ||
        text.substr(check) != std::string(kCheckKey) + hashText(text.substr(0, check)) + "\n")
        return std::nullopt;
    Record record;
    for (std::size_t at = 0; at < check;) {
        const std::size_t end = text.find('\n', at);
        const std::string line = text.substr(at, end - at);
        const std::size_t space = line.find(' ');
        if (space != std::string::npos)
            record.m_values[line.substr(0, space)] = line.substr(space + 1);
        at = end + 1;
    }
    return record;
}

std::string uniqueName() {
    std::uint64_t number = 0;
    if (::getrandom(&number, sizeof number, 0) != sizeof number)
        number = static_cast<std::uint64_t>(::getpid());
    return fmt::format("{}{:0{}x}", kUnique, number, kUniqueDigits);
}

bool isUniqueName(std::string_view name) {
    return name.starts_with(kUnique) && isHex(name.substr(kUnique.size()), kUniqueDigits);
}

std::filesystem::path makeTemporaryBeside(const std::filesystem::path& file) {
    constexpr int kMostTries = 16;
    for (int i = 0; i < kMostTries; ++i) {
        const std::filesystem::path name =
            file.parent_path() / (uniqueName() + file.extension().string());
        const int made =
            ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (made >= 0) {
            ::close(made);
            return name;
        }
        if (errno != EEXIST) return {};
    }
    return {};
}

}  // namespace pm::host
