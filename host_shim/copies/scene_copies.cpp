// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/scene_copies.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string_view>

#include "host_shim/colour/config_files.h"
#include "host_shim/copies/copied_options.h"
#include "host_shim/copies/download.h"
#include "host_shim/copies/manifest.h"
#include "host_shim/copies/sha256.h"
#include "host_shim/formats/scene_url.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/process/temporary_folder.h"
#include "host_shim/render/scene_memory.h"
#include "host_shim/textures/texture_cache.h"

namespace pm::host {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostManifestBytes = std::uint64_t{64} << 20;
constexpr double kUsualLimitGib = 20, kMib = 1024.0 * 1024.0, kGib = 1024.0 * kMib;
constexpr int kTries = 2;  // of a content that comes with another hash
constexpr mode_t kReadOnly = 0444;

std::uint64_t limitOf(const Options& options) {
    return static_cast<std::uint64_t>(
        std::llround(options.copiesGib.value_or(kUsualLimitGib) * kGib));
}

// Why copies can't be kept in the folder that nobody named; empty: they can.
std::string whyUnusable(const fs::path& folder, Log& log) {
    if (folder.empty()) return "neither XDG_CACHE_HOME nor HOME says where copies are kept";
    try {
        const CopiesFolder usual(folder, 0, log);
        return usual.isWritable() ? "" : folder.string() + ": nothing can be written there";
    } catch (const HostError& error) {
        return error.what();
    }
}

// temporary: made for this run where the usual place can't be used.
fs::path folderOf(const Options& options, TemporaryFolder& temporary, Log& log) {
    if (!options.copies.empty()) return options.copies;
    const fs::path cache = usualCacheFolder();
    const fs::path usual = cache.empty() ? cache : cache / "copies";
    const std::string why = whyUnusable(usual, log);
    if (why.empty()) return usual;
    log.info(why + "; copies are kept for this run only");
    return temporary.path();
}

// The folder of a manifest, with the slash at its end.
std::string folderOfUrl(const std::string& url) {
    const std::string path = url.substr(0, url.find_first_of("?#"));
    return path.substr(0, path.rfind('/') + 1);
}

class Fetching {
  public:
    Fetching(const Options& options, TemporaryFolder& temporary, Log& log)
        : m_url(options.scene.string()),
          m_log(log),
          m_download(log),
          m_folder(folderOf(options, temporary, log), limitOf(options), log),
          m_text(m_download.text(m_url, kMostManifestBytes)),
          m_manifest(Manifest::fromJson(m_text, m_url, memoryForText(options))) {}

    PackInUse run() {
        PackInUse pack(m_folder, m_text);
        std::vector<std::string> missing = m_folder.missing(m_manifest);
        // Once more where a content went between the look at it and its use.
        while (!missing.empty() || !m_folder.layOut(pack.id(), m_manifest)) {
            const FetchLock lock(m_folder, m_log);
            missing = stillMissing(missing);
            m_folder.makeRoom(pack.id(), m_manifest);
            fetchAll(missing);
            missing = m_folder.layOut(pack.id(), m_manifest) ? std::vector<std::string>{}
                                                             : m_folder.missing(m_manifest);
        }
        m_log.message(Level::kDebug,
                      fmt::format("{}: {} files, which are in {}", m_url, m_manifest.files.size(),
                                  m_folder.tree(pack.id()).string()));
        return pack;
    }
    const Manifest& manifest() const { return m_manifest; }
    fs::path tree(const PackInUse& pack) const { return m_folder.tree(pack.id()); }

  private:
    // What nobody brought while we waited; the others were whole.
    std::vector<std::string> stillMissing(const std::vector<std::string>& hashes) const {
        if (hashes.empty()) return m_folder.missing(m_manifest);
        Manifest asked = m_manifest;
        const std::set<std::string> wanted(hashes.begin(), hashes.end());
        std::erase_if(asked.files,
                      [&](const PackedFile& file) { return !wanted.contains(file.sha256); });
        return m_folder.missing(asked);
    }
    void fetchAll(const std::vector<std::string>& missing) {
        std::map<std::string, const PackedFile*> files;
        for (const PackedFile& file : m_manifest.files) files.emplace(file.sha256, &file);
        std::uint64_t bytes = 0;
        for (const std::string& hash : missing) bytes += files.at(hash)->bytes;
        m_log.info(fmt::format("{}: {} of {} files are fetched, {:.1f} MiB", m_url, missing.size(),
                               m_manifest.files.size(), static_cast<double>(bytes) / kMib));
        for (const std::string& hash : missing) fetch(*files.at(hash));
    }
    void fetch(const PackedFile& file) {
        const std::string url = folderOfUrl(m_url) + objectPath(file.sha256);
        const fs::path object = m_folder.object(file.sha256);
        std::error_code failed;
        fs::create_directories(object.parent_path(), failed);
        std::string came;
        for (int tried = 0; tried < kTries; ++tried) {
            FinishedFile copy(object);
            came = fetchInto(copy, url, file);
            if (came.empty()) {
                ::fchmod(copy.descriptor(), kReadOnly);
                return copy.commit();
            }
        }
        throw HostError(ExitCode::kBadInput, fmt::format("{}: is not {} as the manifest has it: {}",
                                                         url, file.place, came));
    }
    // What is wrong with what came; empty: nothing.
    std::string fetchInto(FinishedFile& copy, const std::string& url, const PackedFile& file) {
        Sha256 hash;
        std::uint64_t bytes = 0;
        m_download.fetch(url, file.bytes,
                         {[&] {
                              hash = {};
                              bytes = 0;
                              if (::ftruncate(copy.descriptor(), 0) != 0 ||
                                  ::lseek(copy.descriptor(), 0, SEEK_SET) != 0)
                                  throw HostError(
                                      ExitCode::kFile,
                                      fmt::format("{}: can't be written: {}",
                                                  copy.finalPath().string(), std::strerror(errno)));
                          },
                          [&](std::string_view part) {
                              hash.add(part);
                              bytes += part.size();
                              copy.write(part);
                          }});
        if (bytes != file.bytes) return fmt::format("{} bytes in place of {}", bytes, file.bytes);
        const std::string came = hash.digest();
        return came == file.sha256 ? "" : "its SHA-256 is " + came;
    }

    std::string m_url;
    Log& m_log;
    Download m_download;
    CopiesFolder m_folder;
    std::string m_text;
    Manifest m_manifest;
};

// The config that was fetched reads what was fetched with it alone: the library that finds its
// files knows no rules. Errors: kBadInput.
void checkConfig(const Manifest& manifest, const fs::path& tree, const ColourOptions& colour) {
    if (!manifest.ocio || colour.ocioFile != (tree / manifest.ocio->place).string()) return;
    const fs::path root = fs::canonical(tree);
    for (const fs::path& file : filesOfConfig(colour)) {
        std::error_code failed;
        const std::string place = fs::canonical(file, failed).lexically_relative(root).string();
        if (!failed && isPlace(place) && fs::is_regular_file(file, failed)) continue;
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: reads {}, which is none of the files that were fetched "
                                    "with it",
                                    colour.ocioFile, file.string()));
    }
}

}  // namespace

std::optional<PackInUse> takeCopies(Options& options, Log& log) {
    if (!isSceneUrl(options.scene.string())) return std::nullopt;
    if (options.writeSidecar)
        throw HostError(ExitCode::kUsage,
                        "--write-sidecar: a scene that is fetched has no place for it");
    auto temporary = std::make_shared<TemporaryFolder>();
    Fetching fetching(options, *temporary, log);
    PackInUse pack = fetching.run();
    pack.keep(std::move(temporary));
    nameCopies(fetching.manifest(), fetching.tree(pack), options);
    checkConfig(fetching.manifest(), fetching.tree(pack), options.colour);
    return pack;
}

}  // namespace pm::host
