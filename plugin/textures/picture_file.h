// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

namespace pm::plugin {

// Only regular files with something in them may reach a picture library: it would read a device for
// ever, wait for a pipe's other end or for a kernel's log, and others wait for its lock meanwhile.
// Nothing is opened here. Errors: CallError(IO) with the file's name and what it is.
void checkIsRegularFile(const std::string& fileName);

}  // namespace pm::plugin
