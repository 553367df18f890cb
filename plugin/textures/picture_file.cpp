// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/picture_file.h"

#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

[[noreturn]] void refuse(const std::string& fileName, const std::string& why) {
    throw CallError(CallStatus::kIo, fmt::format("texture {}: {}", fileName, why));
}

const char* kindOf(mode_t mode) {
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

// Files of the kernel call themselves regular, some with a size, and may never end or make wait.
bool isOfKernel(const std::string& fileName) {
    constexpr std::array<decltype(statfs::f_type), 5> kKinds = {
        PROC_SUPER_MAGIC, SYSFS_MAGIC, DEBUGFS_MAGIC, TRACEFS_MAGIC, CGROUP2_SUPER_MAGIC};
    struct statfs system {};
    return ::statfs(fileName.c_str(), &system) == 0 &&
           std::find(kKinds.begin(), kKinds.end(), system.f_type) != kKinds.end();
}

}  // namespace

void checkIsRegularFile(const std::string& fileName) {
    struct stat found {};
    if (::stat(fileName.c_str(), &found) != 0)
        refuse(fileName, "can't be read: " + std::generic_category().message(errno));
    if (!S_ISREG(found.st_mode))
        refuse(fileName, fmt::format("is {}; it must be a regular file", kindOf(found.st_mode)));
    if (isOfKernel(fileName))
        refuse(fileName, "is made by the kernel; it must be a file on a disk");
    if (found.st_size == 0) refuse(fileName, "is empty");
}

}  // namespace pm::plugin
