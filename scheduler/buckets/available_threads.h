// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>

namespace pm {

// How many threads this process may keep busy, at least 1: the processors of its affinity mask,
// or fewer where a cgroup (version 2 or 1) gives it less processor time than that; a share of a
// processor counts as one.
// Threads: any; reads small files, so call it once a render.
int availableThreads();

// The processor time that cgroups allow, in processors (2.5 = two and a half), or nothing where
// there is no limit. The least limit counts from the process's own group up to the root.
// procCgroup: the file /proc/self/cgroup; cgroupRoot: the folder /sys/fs/cgroup; others in tests.
std::optional<double> cgroupProcessorLimit(const std::filesystem::path& procCgroup,
                                           const std::filesystem::path& cgroupRoot);

}  // namespace pm
