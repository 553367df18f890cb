// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::host {

// Refuses options that later work will bring. Errors: kUsage, "not available yet".
void refuseWhatIsNotAvailableYet(const std::vector<std::string>& arguments);

}  // namespace pm::host
