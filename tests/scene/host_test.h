// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host_shim/pictures/picture.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {

using Arguments = std::vector<std::string>;

Arguments operator+(Arguments left, const Arguments& right);

// "20,-4,60,40", as --crop takes it.
std::string cropText(const PixelRect& crop);

// Renders through pm_host as a user does: a process of its own in a folder of its own, with every
// variable that begins with OCIO, OPENIMAGEIO or LC_ unset.
class HostTest : public HostProcess {
  protected:
    void SetUp() override;

    // Renders to NAME.exr and reads it back; fails the test, and gives an empty picture, when
    // pm_host does not end with 0. Warnings are left in m_warnings.
    Picture renderExr(const std::string& name, const Arguments& arguments,
                      const std::vector<std::pair<std::string, std::string>>& variables = {});

    std::string m_warnings;
};

// Files of the repository's scenes: scenes/NAME/NAME.obj.
std::string ownScene(const std::string& name);

}  // namespace pm::host::test
