// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/copies/manifest.h"
#include "host_shim/log/log.h"

namespace pm::host {

// A folder of local copies that many processes of a machine share:
//   objects/ab/ab12...   contents, named by their SHA-256
//   packs/ID.json        a manifest, ID its SHA-256; locked (shared) by who renders it
//   packs/ID/            its files by their names, hard links to objects
//   lock                 locked by who fetches or makes room
// Whatever of it is removed while nobody renders is fetched again.
class CopiesFolder {
  public:
    // Makes the folder where it isn't there. Errors: HostError kFile.
    CopiesFolder(std::filesystem::path folder, std::uint64_t limitBytes, Log& log);

    const std::filesystem::path& path() const { return m_folder; }
    std::filesystem::path object(const std::string& sha256) const;
    std::filesystem::path tree(const std::string& id) const;

    // Hashes of contents that are not there; those that are there and not what they were are
    // removed, with a warning. All bytes are read. Errors: HostError kFile; Interrupted.
    std::vector<std::string> missing(const Manifest& manifest) const;

    // Lays out the files by their names, and removes whatever else is there. False where a content
    // went meanwhile. Errors: HostError kFile.
    bool layOut(const std::string& id, const Manifest& manifest) const;

    // Removes the contents of packs that nobody renders, those not used for longest first, until
    // all together with those that the pack wants have at most limitBytes. Only for who has the
    // lock. Errors: HostError kFile where that can't be.
    void makeRoom(const std::string& id, const Manifest& manifest) const;

    std::uint64_t limitBytes() const { return m_limitBytes; }

  private:
    bool isWhole(const PackedFile& file) const;
    void removeStrangers(const std::string& id, const Manifest& manifest) const;

    std::filesystem::path m_folder;
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

  private:
    std::string m_id;
    int m_file{-1};
};

}  // namespace pm::host
