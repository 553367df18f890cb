// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// CopiesFolder::makeRoom, and the locks of a folder of copies.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <thread>
#include <utility>

#include "host_shim/copies/copies_folder.h"
#include "host_shim/copies/sha256.h"
#include "host_shim/formats/source_file.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr auto kGlance = std::chrono::milliseconds(20);
constexpr auto kBeforeTelling = std::chrono::seconds(1);
constexpr double kMib = 1024.0 * 1024.0;

// A pack that nobody uses, and nobody can begin to while this lives.
struct IdlePack {
    fs::path manifest;
    struct timespec used {};
    std::set<std::string> objects;
    int file{-1};
};

std::set<std::string> hashesOf(const Manifest& manifest) {
    std::set<std::string> hashes;
    for (const PackedFile& file : manifest.files) hashes.insert(file.sha256);
    return hashes;
}

std::set<std::string> hashesIn(const fs::path& file) {
    try {
        return hashesOf(Manifest::fromJson(readWholeFile(file), file.string()));
    } catch (const HostError&) {
        return {};  // damaged: whoever wants it writes it anew
    }
}

class Packs {
  public:
    explicit Packs(const fs::path& folder, const std::string& own) {
        std::error_code failed;
        for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
             entry.increment(failed))
            if (entry->path().extension() == ".json" && entry->path().stem() != own &&
                isSha256(entry->path().stem().string()))
                look(entry->path());
        std::ranges::sort(idle, [](const IdlePack& a, const IdlePack& b) {
            return std::pair(a.used.tv_sec, a.used.tv_nsec) <
                   std::pair(b.used.tv_sec, b.used.tv_nsec);
        });
    }
    ~Packs() {
        for (const IdlePack& pack : idle) ::close(pack.file);
    }
    Packs(const Packs&) = delete;
    Packs& operator=(const Packs&) = delete;

    std::vector<IdlePack> idle;  // those not used for longest first
    std::set<std::string> used;  // hashes of those in use

  private:
    void look(const fs::path& file) {
        IdlePack pack;
        pack.manifest = file;
        pack.objects = hashesIn(file);
        pack.file = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
        struct stat status {};
        if (pack.file < 0 || ::fstat(pack.file, &status) != 0) return;
        if (::flock(pack.file, LOCK_EX | LOCK_NB) != 0) {
            used.insert(pack.objects.begin(), pack.objects.end());
            ::close(pack.file);
            return;
        }
        pack.used = status.st_mtim;
        idle.push_back(std::move(pack));
    }
};

int openFile(const fs::path& file, int flags) {
    const int opened = ::open(file.c_str(), flags | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (opened < 0 && errno != ENOENT)
        throw HostError(ExitCode::kFile, fmt::format("{}: can't be opened: {}", file.string(),
                                                     std::strerror(errno)));
    return opened;
}

[[noreturn]] void failLocking(int opened, const fs::path& file) {
    const std::string why = std::strerror(errno);
    ::close(opened);
    throw HostError(ExitCode::kFile, fmt::format("{}: can't be locked: {}", file.string(), why));
}

// Closes the file where it throws. tell: called once where it lasts.
void waitForLock(int opened, int kind, const fs::path& file, const std::function<void()>& tell) {
    const auto start = std::chrono::steady_clock::now();
    for (bool isTold = false; ::flock(opened, kind | LOCK_NB) != 0;
         std::this_thread::sleep_for(kGlance)) {
        if (errno != EWOULDBLOCK && errno != EINTR) failLocking(opened, file);
        if (interruptSignal() != 0) ::close(opened);
        throwIfInterrupted();
        if (isTold || std::chrono::steady_clock::now() - start < kBeforeTelling) continue;
        isTold = true;
        tell();
    }
}

}  // namespace

// Bytes by hash. A name that is pm's and no hash was left by one who was stopped while he wrote.
std::map<std::string, std::uint64_t> CopiesFolder::objects() const {
    std::map<std::string, std::uint64_t> objects;
    std::error_code failed;
    for (fs::recursive_directory_iterator entry(path() / "objects", failed), end;
         !failed && entry != end; entry.increment(failed)) {
        struct stat status {};
        if (!m_own.owns(entry->path()) || ::lstat(entry->path().c_str(), &status) != 0 ||
            !S_ISREG(status.st_mode))
            continue;
        const std::string name = entry->path().filename().string();
        if (isSha256(name))
            objects[name] = static_cast<std::uint64_t>(status.st_size);
        else
            m_own.remove(entry->path());
    }
    return objects;
}

void CopiesFolder::makeRoom(const std::string& id, const Manifest& manifest) const {
    auto objects = this->objects();
    Packs packs(path() / "packs", id);
    std::set<std::string> kept = hashesOf(manifest);
    kept.insert(packs.used.begin(), packs.used.end());
    std::uint64_t bytes = manifest.bytes();
    const std::set<std::string> own = hashesOf(manifest);
    for (const auto& [hash, size] : objects)
        if (!own.contains(hash)) bytes += size;
    const auto removeUnless = [&](const std::set<std::string>& wanted) {
        for (auto object = objects.begin(); object != objects.end();) {
            if (kept.contains(object->first) || wanted.contains(object->first)) {
                ++object;
                continue;
            }
            m_own.remove(this->object(object->first));
            bytes -= object->second;
            object = objects.erase(object);
        }
    };
    for (std::size_t gone = 0; bytes > m_limitBytes && gone <= packs.idle.size(); ++gone) {
        if (gone > 0) removePack(packs.idle[gone - 1].manifest.stem().string());
        std::set<std::string> wanted;
        for (std::size_t i = gone; i < packs.idle.size(); ++i)
            wanted.insert(packs.idle[i].objects.begin(), packs.idle[i].objects.end());
        removeUnless(wanted);
    }
    if (bytes > m_limitBytes)
        throw HostError(
            ExitCode::kFile,
            fmt::format("{}: the scene is {:.1f} MiB, and with what others render now there would "
                        "be {:.1f} MiB; --copies-limit allows {:.1f}",
                        path().string(), static_cast<double>(manifest.bytes()) / kMib,
                        static_cast<double>(bytes) / kMib,
                        static_cast<double>(m_limitBytes) / kMib));
}

FetchLock::FetchLock(const CopiesFolder& folder, Log& log) {
    const fs::path file = folder.path() / "lock";
    m_file = openFile(file, O_RDWR | O_CREAT);
    waitForLock(m_file, LOCK_EX, file, [&] {
        log.info(fmt::format("{}: another process fetches; waiting", folder.path().string()));
    });
}

FetchLock::~FetchLock() {
    ::close(m_file);
}

PackInUse::PackInUse(const CopiesFolder& folder, const std::string& text) : m_id(sha256Of(text)) {
    const fs::path file = folder.path() / "packs" / (m_id + ".json");
    for (;;) {
        m_file = openFile(file, O_RDONLY);
        if (m_file < 0) {
            writeFinishedFile(file, text);
            continue;
        }
        // One who makes room has it for a moment, and it may be gone then.
        waitForLock(m_file, LOCK_SH, file, [] {});
        struct stat status {};
        if (::fstat(m_file, &status) == 0 && status.st_nlink > 0) {
            if (static_cast<std::size_t>(status.st_size) == text.size()) break;
            ::unlink(file.c_str());
        }
        ::close(m_file);
    }
    ::futimens(m_file, nullptr);
}

PackInUse::~PackInUse() {
    if (m_file >= 0) ::close(m_file);
}

PackInUse::PackInUse(PackInUse&& other) noexcept
    : m_folder(std::move(other.m_folder)),
      m_id(std::move(other.m_id)),
      m_file(std::exchange(other.m_file, -1)) {}

}  // namespace pm::host
