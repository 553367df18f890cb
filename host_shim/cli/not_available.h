// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::host {

// Refuses options and values that later work will bring. Errors: kUsage, "not available yet".
void refuseWhatIsNotAvailableYet(const std::vector<std::string>& arguments);

// The same for values of options that exist.
void refuseValueNotAvailableYet(const std::string& option, const std::string& value,
                                const std::vector<std::string>& laterValues);

}  // namespace pm::host
