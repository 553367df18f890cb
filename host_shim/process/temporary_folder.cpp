// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/temporary_folder.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "host_shim/values/host_error.h"

namespace pm::host {

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    if (!m_path.empty()) std::filesystem::remove_all(m_path, ignored);
}

const std::filesystem::path& TemporaryFolder::path() {
    if (!m_path.empty()) return m_path;
    std::string name = fmt::format("{}/pm_host.{}.XXXXXX", P_tmpdir, getpid());
    if (mkdtemp(name.data()) == nullptr) {
        throw HostError(ExitCode::kFile, fmt::format("{}: no folder for textures can be made: {}",
                                                     name, std::strerror(errno)));
    }
    m_path = name;
    return m_path;
}

}  // namespace pm::host
