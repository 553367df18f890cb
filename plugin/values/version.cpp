// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/values/version.h"

#include <OpenImageIO/oiioversion.h>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>
#include <oneapi/tbb/version.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace pm::plugin {

namespace {

std::string openImageIoVersion() {
    return fmt::format("{}.{}.{}", OIIO_VERSION_MAJOR, OIIO_VERSION_MINOR, OIIO_VERSION_PATCH);
}

std::string tbbVersion() {
    return fmt::format("{}.{}", TBB_VERSION_MAJOR, TBB_VERSION_MINOR);
}

// Looks through the notes of one loaded object; stops (1) at the one that holds this function.
int findBuildId(dl_phdr_info* object, std::size_t, void* result) {
    const auto own = reinterpret_cast<ElfW(Addr)>(&findBuildId);
    const std::span headers(object->dlpi_phdr, object->dlpi_phnum);
    const bool isOwn = std::ranges::any_of(headers, [&](const ElfW(Phdr) & part) {
        const ElfW(Addr) first = object->dlpi_addr + part.p_vaddr;
        return part.p_type == PT_LOAD && own >= first && own - first < part.p_memsz;
    });
    if (!isOwn) return 0;
    for (const ElfW(Phdr) & part : headers) {
        if (part.p_type != PT_NOTE) continue;
        const auto* at = reinterpret_cast<const unsigned char*>(object->dlpi_addr + part.p_vaddr);
        const unsigned char* const end = at + part.p_memsz;
        while (end - at >= static_cast<std::ptrdiff_t>(sizeof(ElfW(Nhdr)))) {
            ElfW(Nhdr) note;
            std::memcpy(&note, at, sizeof note);
            const auto padded = [](std::uint32_t bytes) { return (bytes + 3u) & ~3u; };
            const unsigned char* const name = at + sizeof note;
            const unsigned char* const text = name + padded(note.n_namesz);
            at = text + padded(note.n_descsz);
            if (at > end || note.n_type != NT_GNU_BUILD_ID || note.n_namesz != 4 ||
                std::memcmp(name, "GNU", 4) != 0)
                continue;
            for (std::uint32_t i = 0; i < note.n_descsz; ++i)
                *static_cast<std::string*>(result) += fmt::format("{:02x}", text[i]);
        }
    }
    return 1;
}

}  // namespace

const std::string& buildId() {
    static const std::string& id = *[] {
        auto* found = new std::string;
        dl_iterate_phdr(findBuildId, found);
        return found;
    }();
    return id;
}

const std::string& versionText() {
    // Never destroyed: a host may keep the pointer to its very end.
    static const std::string& text = *new std::string(
        fmt::format("{} (embree {}, OpenImageIO {}, TBB {}, {})", PM_VERSION_TEXT,
                    PM_EMBREE_VERSION_TEXT, openImageIoVersion(), tbbVersion(), PM_BUILD_TEXT));
    return text;
}

Json versionsJson() {
    return {{"pm", PM_VERSION_TEXT},
            {"build", PM_BUILD_TEXT},
            {"buildId", buildId()},
            {"embree", PM_EMBREE_VERSION_TEXT},
            {"openImageIo", openImageIoVersion()},
            {"tbb", tbbVersion()}};
}

}  // namespace pm::plugin
