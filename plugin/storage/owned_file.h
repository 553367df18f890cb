// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace pm::plugin {

// A file of the system, closed with this. Errors of all members: CallError(IO) with the file's name
// and the system's reason. Threads: const members from any, also at once.
class OwnedFile {
  public:
    OwnedFile() = default;
    // flags: as open(2); O_CLOEXEC is added, new files get 0666 less the umask. Never one of the
    // standard descriptors, into which a host that closed them would print.
    OwnedFile(std::string name, int flags);
    // A new one, where `file` is written until it is whole: NAME.tmp.HOST.PID, or
    // NAME.tmp.HOST.PID.N where that was there; NAME cut where that is too long. For reading too.
    static OwnedFile temporaryFor(const std::string& file);
    ~OwnedFile();
    OwnedFile(OwnedFile&& other) noexcept;
    OwnedFile& operator=(OwnedFile&& other) noexcept;

    explicit operator bool() const { return m_file >= 0; }
    const std::string& name() const { return m_name; }
    // This is its name from then on. What had it is replaced, and its mode, and its owner and group
    // where this user may give it to them, are kept.
    void rename(const std::string& to);
    // The same where nothing has that name; else false.
    bool renameToNew(const std::string& to);

    std::uint64_t size() const;
    void truncate(std::uint64_t size) const;
    void writeAt(std::uint64_t offset, std::span<const std::byte> bytes) const;
    // False where the file ends before.
    bool readAt(std::uint64_t offset, std::span<std::byte> bytes) const;
    void sync() const;
    // False when another process, or another open file of this one, has the lock. It ends with the
    // file or the process, however that ends.
    bool lock() const;
    void unlock() const noexcept;
    // Whether the name still leads to this file.
    bool isAtItsName() const;

  private:
    void open(int flags);
    [[noreturn]] void fail(const char* what) const;

    int m_file = -1;
    std::string m_name;
};

// So that a rename in its folder outlives a power cut; where a file system can't, the file itself
// is safe anyway.
void syncFolderOf(const std::string& file);

}  // namespace pm::plugin
