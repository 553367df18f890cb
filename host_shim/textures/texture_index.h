// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// What tells whether a file is the one that was seen before, without opening it.
struct FileStamp {
    std::uint64_t device{}, inode{}, size{};
    std::int64_t modified{}, changed{};  // ns since the epoch: of its bytes; of anything

    bool operator==(const FileStamp&) const = default;
    std::string text() const;
    static std::optional<FileStamp> fromText(const std::string& text);
};

// Follows links. None where there is no regular file.
std::optional<FileStamp> stampOf(const std::filesystem::path& file);

// XXH3 of 128 bits, as 32 hexadecimal digits.
std::string hashText(const std::string& text);
// The same of a file's bytes; goOn (may be empty) is called now and then and may throw. Errors:
// HostError kFile.
std::string hashFile(const std::filesystem::path& file, const std::function<void()>& goOn);

// A small file of "key value" lines, closed by a checksum, so that what was cut off or changed is
// no record. Values have no line breaks.
class Record {
  public:
    void set(const std::string& key, const std::string& value);
    void setNumber(const std::string& key, std::int64_t value);
    // Empty, and 0, where there is no such key.
    std::string get(const std::string& key) const;
    std::int64_t number(const std::string& key) const;

    // Under a name of its own, then renamed. False where it can't be written.
    bool write(const std::filesystem::path& file) const;
    static std::optional<Record> read(const std::filesystem::path& file);

  private:
    std::map<std::string, std::string> m_values;
};

// "tmp-" and 16 hexadecimal digits by chance.
std::string uniqueName();
bool isUniqueName(std::string_view name);
// Makes an empty file beside `file` under a name that nothing has, with the permissions that files
// have; empty where that can't be.
std::filesystem::path makeTemporaryBeside(const std::filesystem::path& file);

}  // namespace pm::host
