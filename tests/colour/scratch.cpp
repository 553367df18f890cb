// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/colour/scratch.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

namespace pm::host::test {

void clearColourEnvironment() {
    std::vector<std::string> names;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text(*entry);
        for (const char* prefix : {"OCIO", "OPENIMAGEIO", "LC_"}) {
            if (text.starts_with(prefix)) names.push_back(text.substr(0, text.find('=')));
        }
    }
    for (const std::string& name : names) unsetenv(name.c_str());
}

ScratchTest::ScratchTest() {
    clearColourEnvironment();
    std::string pattern = (std::filesystem::temp_directory_path() / "pm_colour_XXXXXX").string();
    m_folder = mkdtemp(pattern.data());
}

ScratchTest::~ScratchTest() {
    std::error_code ignored;
    std::filesystem::remove_all(m_folder, ignored);
}

std::string ScratchTest::listing() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(m_folder)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
    return text;
}

std::string readBytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

testing::AssertionResult refusesWith(const std::string& refusal, int exitCode,
                                     std::initializer_list<std::string> fragments) {
    if (!refusal.starts_with(std::to_string(exitCode) + " ")) {
        return testing::AssertionFailure() << "exit code is not " << exitCode << ": " << refusal;
    }
    for (const std::string& fragment : fragments) {
        if (refusal.find(fragment) == std::string::npos) {
            return testing::AssertionFailure() << "'" << fragment << "' is not in: " << refusal;
        }
    }
    return testing::AssertionSuccess();
}

}  // namespace pm::host::test
