// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/temporary_folder.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "host_shim/values/host_error.h"

namespace pm::host {

std::filesystem::path temporaryPlace() {
    const char* const place = std::getenv("TMPDIR");
    const bool isGiven = place != nullptr && *place != '\0';
    return std::filesystem::absolute(isGiven ? place : P_tmpdir);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    if (!m_path.empty()) std::filesystem::remove_all(m_path, ignored);
}

const std::filesystem::path& TemporaryFolder::path() {
    if (!m_path.empty()) return m_path;
    const std::filesystem::path place = temporaryPlace();
    std::string name = place / fmt::format("pm_host.{}.XXXXXX", getpid());
    if (mkdtemp(name.data()) == nullptr)
        throw HostError(ExitCode::kFile, fmt::format("{}: no temporary folder can be made there "
                                                     "($TMPDIR, else /tmp, says where): {}",
                                                     place.string(), std::strerror(errno)));
    m_path = name;
    return m_path;
}

}  // namespace pm::host
