// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "host_shim/values/host_error.h"

namespace pm::host::test {

// Unsets every variable that begins with OCIO, OPENIMAGEIO or LC_, so that a picture test sees what
// a user with a bare environment sees.
void clearColourEnvironment();

// A test with a cleared environment and an empty folder of its own, removed at its end.
class ScratchTest : public testing::Test {
  protected:
    ScratchTest();
    ~ScratchTest() override;
    std::filesystem::path file(const std::string& name) const { return m_folder / name; }
    const std::filesystem::path& folder() const { return m_folder; }
    // Names of what lies in the folder, sorted, separated by spaces.
    std::string listing() const;

  private:
    std::filesystem::path m_folder;
};

std::string readBytes(const std::filesystem::path& path);
void writeBytes(const std::filesystem::path& path, const std::string& bytes);

// Runs use and returns "CODE text" of the HostError it throws, or "nothing thrown".
template <typename Use>
std::string refusal(const Use& use) {
    try {
        use();
    } catch (const HostError& error) {
        return std::to_string(error.exitCode()) + " " + error.what();
    }
    return "nothing thrown";
}

// Both must occur in a refusal.
testing::AssertionResult refusesWith(const std::string& refusal, int exitCode,
                                     std::initializer_list<std::string> fragments);

}  // namespace pm::host::test
