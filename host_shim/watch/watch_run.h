// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"

namespace pm::host {

// pm_host watch: puts parts into the pictures as they come, and shows them in a page; ends when no
// bucket is missing, with the pictures that pm_host merge would write of these parts, and its exit
// code. A part that is damaged, is being written or is of another picture is told once and left out
// until it changes. Errors: kUsage, kFile, kBadInput as merging; Interrupted, which leaves the last
// pictures and page.
int runWatch(const Options& options, Log& log);

}  // namespace pm::host
