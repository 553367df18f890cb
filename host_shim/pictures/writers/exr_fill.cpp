// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/writers/exr_fill.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <map>
#include <string>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

// Numbers in the file are little-endian.
static_assert(std::endian::native == std::endian::little);

// A file that is read and written in place; any failure throws.
class InPlace {
  public:
    explicit InPlace(const std::filesystem::path& path)
        : m_path(path), m_file(path, std::ios::in | std::ios::out | std::ios::binary) {
        check();
    }
    void seek(std::uint64_t at) {
        m_file.seekg(static_cast<std::streamoff>(at));
        m_file.seekp(static_cast<std::streamoff>(at));
        check();
    }
    std::uint64_t seekEnd() {
        m_file.seekp(0, std::ios::end);
        check();
        return static_cast<std::uint64_t>(m_file.tellp());
    }
    std::uint64_t at() { return static_cast<std::uint64_t>(m_file.tellg()); }
    void read(void* to, std::size_t size) {
        m_file.read(static_cast<char*>(to), static_cast<std::streamsize>(size));
        check();
    }
    void write(const void* from, std::size_t size) {
        m_file.write(static_cast<const char*>(from), static_cast<std::streamsize>(size));
        check();
    }
    std::string text() {
        std::string text;
        std::getline(m_file, text, '\0');
        check();
        return text;
    }
    void flush() {
        m_file.flush();
        check();
    }
    void check() const {
        if (!m_file)
            throw HostError(ExitCode::kFile, fmt::format("{}: can't be changed", m_path.string()));
    }

  private:
    std::filesystem::path m_path;
    std::fstream m_file;
};

// Walks through the head: visit(name, type, size, where the value is) for each attribute. Returns
// where the table of the tiles' places begins.
template <typename Visit>
std::uint64_t walkHead(InPlace& file, Visit visit) {
    constexpr std::uint64_t kMagicAndVersion = 8;
    file.seek(kMagicAndVersion);
    while (true) {
        const std::string name = file.text();
        if (name.empty()) return file.at();
        const std::string type = file.text();
        std::uint32_t size = 0;
        file.read(&size, sizeof size);
        const std::uint64_t value = file.at();
        visit(name, type, size, value);
        file.seek(value + size);
    }
}

// A tile's bytes: its column, row and level, and what it holds.
struct TileBytes {
    std::array<std::int32_t, 4> place{};
    std::string rest;
};

TileBytes readTile(InPlace& file, std::uint64_t at) {
    TileBytes tile;
    std::int32_t size = 0;
    file.seek(at);
    file.read(tile.place.data(), sizeof tile.place);
    file.read(&size, sizeof size);
    tile.rest.assign(reinterpret_cast<const char*>(&size), sizeof size);
    tile.rest.resize(sizeof size + static_cast<std::size_t>(size));
    file.read(tile.rest.data() + sizeof size, static_cast<std::size_t>(size));
    return tile;
}

}  // namespace

void setExrNumber(const std::filesystem::path& path, std::string_view name, std::int32_t value) {
    InPlace file(path);
    std::uint64_t place = 0;
    walkHead(file, [&](const std::string& found, const std::string& type, std::uint32_t size,
                       std::uint64_t at) {
        if (found == name && type == "int" && size == sizeof value) place = at;
    });
    if (place == 0)
        throw HostError(ExitCode::kFile,
                        fmt::format("{}: has no attribute {}", path.string(), name));
    file.seek(place);
    file.write(&value, sizeof value);
    file.flush();
}

void copyExrTiles(const std::filesystem::path& path, std::size_t columns,
                  const std::vector<std::pair<std::size_t, std::size_t>>& copies) {
    if (copies.empty()) return;
    InPlace file(path);
    const std::uint64_t table = walkHead(file, [](const auto&...) {});
    std::map<std::size_t, TileBytes> originals;
    for (const auto& [to, from] : copies) {
        if (originals.contains(from)) continue;
        std::uint64_t at = 0;
        file.seek(table + from * sizeof at);
        file.read(&at, sizeof at);
        originals[from] = readTile(file, at);
    }
    std::vector<std::uint64_t> places;
    std::uint64_t end = file.seekEnd();
    for (const auto& [to, from] : copies) {
        TileBytes& tile = originals[from];
        tile.place[0] = static_cast<std::int32_t>(to % columns);
        tile.place[1] = static_cast<std::int32_t>(to / columns);
        file.write(tile.place.data(), sizeof tile.place);
        file.write(tile.rest.data(), tile.rest.size());
        places.push_back(end);
        end += sizeof tile.place + tile.rest.size();
    }
    for (std::size_t i = 0; i < copies.size(); ++i) {
        // Most stand side by side; where they don't, the stream has to be moved.
        if (i == 0 || copies[i].first != copies[i - 1].first + 1)
            file.seek(table + copies[i].first * sizeof(std::uint64_t));
        file.write(&places[i], sizeof(std::uint64_t));
    }
    file.flush();
}

}  // namespace pm::host
