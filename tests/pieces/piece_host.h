// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders of the box that leave pieces in a folder of the test's own.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

using Settings = std::map<std::string, std::string>;

// What a render or a merge left.
struct Outcome {
    PmrStatus started = PMR_OK;
    PmrStatus ended = PMR_OK;
    std::string error;  // of whichever failed
    std::vector<float> beauty, standardError, samples;
    nlohmann::json json;
    std::string warnings, infos;  // messages, one a line

    bool isOk() const { return started == PMR_OK && ended == PMR_OK; }
};

// The same bits everywhere, and something to see.
void expectSameBits(const Outcome& a, const Outcome& b);

class PieceHost : public ::testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;

    std::string path(const std::string& name) const { return (m_folder / name).string(); }
    std::vector<std::string> files() const;

    // Renders with settings on top of small ones. cancelAfter: buckets after which it is cancelled
    // from a callback, 0 = never.
    Outcome render(const Settings& settings, int cancelAfter = 0);
    Outcome render(PmrScene scene, const Settings& settings, int cancelAfter = 0);
    // Renders a run of buckets to a part.
    void makePart(const std::string& name, const std::string& buckets, const Settings& more = {});

    static std::string readFile(const std::string& name);
    static void writeFile(const std::string& name, const std::string& bytes);

    BoxHost m_host;
    std::filesystem::path m_folder;
    // The picture that all pieces are of; what its pixels need decides on their samples.
    Settings m_settings = {{"width", "40"},     {"height", "28"},    {"passes", "5"},
                           {"photons", "1000"}, {"aaLevel", "2"},    {"aaLevelMost", "3"},
                           {"gatherRays", "4"}, {"bucketSize", "8"}, {"layers", "stderr,samples"}};
};

}  // namespace pm::test
