// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host_shim/copies/manifest.h"
#include "host_shim/folders/own_folder.h"
#include "host_shim/log/log.h"
#include "host_shim/process/temporary_folder.h"

namespace pm::host {

// A folder of local copies that many processes of a machine share:
//   objects/ab/ab12...   contents, named by their SHA-256
//   packs/ID.json        a manifest, ID its SHA-256; locked (shared) by who renders it
//   packs/ID/            its files by their names, hard links to objects
//   set_aside/           files that somebody else laid among those of a scene
//   lock                 locked by who fetches or makes room
// Whatever of it is removed while nobody renders is fetched again.
class CopiesFolder {
  public:
    // Makes the folder where it isn't there. Errors: HostError kFile, also for one that is not
    // pm's.
    CopiesFolder(const std::filesystem::path& folder, std::uint64_t limitBytes, Log& log);

    const std::filesystem::path& path() const { return m_own.path(); }
    bool isWritable() const;
    std::filesystem::path object(const std::string& sha256) const;
    std::filesystem::path tree(const std::string& id) const;

    // Hashes of contents that are not there; those that are there and not what they were are
    // removed, with a warning. All bytes are read. Errors: HostError kFile; Interrupted.
    std::vector<std::string> missing(const Manifest& manifest) const;

    // Lays out the files by their names, and sets aside whatever else is there, with a warning.
    // False where a content went meanwhile. Errors: HostError kFile.
    bool layOut(const std::string& id, const Manifest& manifest) const;

    // Removes the contents of packs that nobody renders, those not used for longest first, until
    // all together with those that the pack wants have at most limitBytes. Only for who has the
    // lock. Errors: HostError kFile where that can't be.
    void makeRoom(const std::string& id, const Manifest& manifest) const;

    std::uint64_t limitBytes() const { return m_limitBytes; }

  private:
    bool isWhole(const PackedFile& file) const;
    void setAsideStrangers(const std::string& id, const Manifest& manifest) const;
    void setAside(const std::filesystem::path& path) const;
    void removePack(const std::string& id) const;
    std::map<std::string, std::uint64_t> objects() const;
    // A content by its name in a scene. False where there is no such content any more.
    bool link(const std::filesystem::path& object, const std::filesystem::path& place) const;

    OwnFolder m_own;
    std::uint64_t m_limitBytes;
    Log& m_log;
};

// The one who fetches into a folder of copies or makes room there: others wait. Interrupted ends
// the waiting. Errors: HostError kFile.
class FetchLock {
  public:
    FetchLock(const CopiesFolder& folder, Log& log);
    ~FetchLock();
    FetchLock(const FetchLock&) = delete;
    FetchLock& operator=(const FetchLock&) = delete;

  private:
    int m_file{-1};
};

// A pack that is in use: nobody makes room by it until this ends.
class PackInUse {
  public:
    // text: the manifest. Errors: HostError kFile.
    PackInUse(const CopiesFolder& folder, const std::string& text);
    ~PackInUse();
    PackInUse(PackInUse&& other) noexcept;
    PackInUse& operator=(PackInUse&&) = delete;

    const std::string& id() const { return m_id; }
    // A folder of copies for this run alone, which goes with this.
    void keep(std::shared_ptr<TemporaryFolder> folder) { m_folder = std::move(folder); }

  private:
    std::shared_ptr<TemporaryFolder> m_folder;
    std::string m_id;
    int m_file{-1};
};

}  // namespace pm::host
