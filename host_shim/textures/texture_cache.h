// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/folders/own_folder.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/textures/texture_index.h"

namespace pm::host {

// A folder of prepared textures that many processes use at once: `textures` has NAME.tx and beside
// it NAME.rec, which says what it is; `index` has what is known of originals, by their stamps;
// `leases` has a file for each process that uses some, locked while it lives. All files are written
// under a name of their own and renamed, so nobody waits for anybody. Threads: any.
class TextureCache {
  public:
    struct Entry {
        std::string name;
        std::filesystem::path file;  // the .tx; a texture that is used as it is has none
        std::uint64_t bytes{};
        std::int64_t lastUsed{};  // seconds since the epoch
        std::string source;       // of which it was made, as it was then called
    };

    // Makes the folder where it isn't there. limitBytes: see makeRoom. Where nothing can be written
    // isWritable() is false, and what is there can still be read. Errors: HostError kFile for a
    // folder that is not pm's.
    TextureCache(const std::filesystem::path& folder, std::uint64_t limitBytes);
    ~TextureCache();
    TextureCache(const TextureCache&) = delete;
    TextureCache& operator=(const TextureCache&) = delete;

    const std::filesystem::path& folder() const { return m_own.path(); }
    bool isWritable() const { return m_lease >= 0; }

    // key: a hash of the stamp and what else decides.
    std::optional<Record> original(const std::string& key) const;
    void putOriginal(const std::string& key, const Record& record) const;

    // What is known of a prepared texture, where it is there and whole. From then on until this
    // process ends no other one makes room by it.
    std::optional<Record> find(const std::string& name);
    std::filesystem::path textureFile(const std::string& name) const;
    // A name for a texture that is being made, which no other has.
    std::filesystem::path nameForNew() const;
    // A file that is being written, to be removed by abandon(). Errors: HostError kFile after that.
    void noteUnderway(const std::filesystem::path& temporary);
    // This process ends while threads may still write: what they write is removed, and the lease.
    void abandon();
    // Gives a texture its name, and writes its record. Errors: HostError kFile.
    void commit(const std::string& name, FinishedFile& texture, Record record);
    // The record of a picture that is used as it is.
    void commitAsItIs(const std::string& name, Record record) const;

    // Removes the textures that were not used for the longest time, until all together have at most
    // limitBytes; never what a living process uses. Also what crashed processes left.
    void makeRoom();

    // For people: all textures, the least recently used first.
    std::vector<Entry> list() const;
    // Removes everything but what living processes use; returns how many textures.
    std::size_t clear();
    // Reads all textures, and all originals that are still where they were; what is not as it was
    // recorded is removed. Returns a line for each. goOn: called now and then; may throw.
    std::vector<std::string> verify(const std::function<void()>& goOn = {});

  private:
    bool isWhole(const std::string& name, Record& record) const;
    void lease(const std::string& name);
    std::vector<std::string> leasedNames() const;
    void removeTexture(const std::string& name) const;
    void removeLeftovers() const;
    std::filesystem::path recordFile(const std::string& name) const;

    OwnFolder m_own;
    std::uint64_t m_limitBytes;
    std::mutex m_mutex;
    int m_lease{-1};  // descriptor of the lease's file
    std::filesystem::path m_leaseFile;
    std::vector<std::filesystem::path> m_underway;
    bool m_isAbandoned{};
};

// $XDG_CACHE_HOME/pm, else ~/.cache/pm; empty where neither is known.
std::filesystem::path usualCacheFolder();

}  // namespace pm::host
