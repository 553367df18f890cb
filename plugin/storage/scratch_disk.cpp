// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/scratch_disk.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <utility>

#include "plugin/storage/owned_file.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// f(), and where that fails, what the file was for.
template <typename F>
auto explained(const F& f) {
    try {
        return f();
    } catch (const CallError& error) {
        throw CallError(
            error.status(),
            fmt::format("{} (a scratch file of photon maps; setting scratchFolder, --scratch, "
                        "says where they are)",
                        error.what()));
    }
}

// Without a name from the start where the file system can that, else from here on.
OwnedFile nameless(const std::string& folder) {
#if defined(O_TMPFILE)
    const int tried = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (tried >= 0) {
        ::close(tried);
        return OwnedFile(folder, O_TMPFILE | O_RDWR);
    }
#endif
    OwnedFile file = OwnedFile::temporaryFor((std::filesystem::path(folder) / "pm").string());
    ::unlink(file.name().c_str());
    return file;
}

}  // namespace

class ScratchDisk::File : public ScratchFile {
  public:
    explicit File(ScratchDisk& disk)
        : m_disk(disk), m_file(explained([&] { return nameless(disk.m_folder); })) {}
    ~File() override { m_disk.m_bytes.fetch_sub(m_bytes, std::memory_order_relaxed); }

    void write(std::uint64_t offset, std::span<const std::byte> bytes) override {
        explained([&] { m_file.writeAt(offset, bytes); });
        m_bytes += bytes.size();
        m_disk.count(bytes.size());
    }
    void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
        if (explained([&] { return m_file.readAt(offset, bytes); })) return;
        throw CallError(CallStatus::kIo,
                        fmt::format("{}: a scratch file of photon maps is shorter than what was "
                                    "written into it",
                                    m_disk.m_folder));
    }

  private:
    ScratchDisk& m_disk;
    const OwnedFile m_file;
    std::uint64_t m_bytes = 0;
};

ScratchDisk::ScratchDisk(const std::string& folder)
    : m_folder(folder.empty() ? usualFolder() : folder) {}

std::string ScratchDisk::usualFolder() {
    const char* const folder = std::getenv("TMPDIR");
    return folder != nullptr && *folder != 0 ? folder : "/tmp";
}

std::unique_ptr<ScratchFile> ScratchDisk::make() {
    return std::make_unique<File>(*this);
}

void ScratchDisk::count(std::uint64_t bytes) {
    m_written.fetch_add(bytes, std::memory_order_relaxed);
    const std::uint64_t now = m_bytes.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    std::uint64_t most = m_most.load(std::memory_order_relaxed);
    while (most < now && !m_most.compare_exchange_weak(most, now)) {
    }
}

}  // namespace pm::plugin
