// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/pieces/piece_host.h"

#include <stdlib.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <fstream>
#include <sstream>

namespace pm::test {

namespace {

struct Seen {
    int cancelAfter = 0;
    std::atomic<int> buckets{0};
    std::string warnings, infos;
};

void onBucket(void* user, PmrRender render, const PmrBucketInfo*) {
    auto* seen = static_cast<Seen*>(user);
    if (++seen->buckets == seen->cancelAfter) api().cancelRender(render);
}

void onMessage(void* user, PmrRender, std::int32_t level, std::int32_t, const char* text) {
    auto* seen = static_cast<Seen*>(user);
    (level == PMR_LEVEL_WARNING ? seen->warnings : seen->infos) += std::string(text) + "\n";
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace

void expectSameBits(const Outcome& a, const Outcome& b) {
    ASSERT_TRUE(a.isOk()) << a.error;
    ASSERT_TRUE(b.isOk()) << b.error;
    EXPECT_GT(std::count_if(a.beauty.begin(), a.beauty.end(), [](float v) { return v > 0.0f; }),
              static_cast<std::ptrdiff_t>(a.beauty.size() / 2));
    EXPECT_TRUE(sameBits(a.beauty, b.beauty));
    EXPECT_TRUE(sameBits(a.standardError, b.standardError));
    EXPECT_TRUE(sameBits(a.samples, b.samples));
    EXPECT_EQ(a.json["passesDone"], b.json["passesDone"]);
    EXPECT_EQ(a.json["relMseEstimate"], b.json["relMseEstimate"]);
    EXPECT_EQ(a.json["hashes"], b.json["hashes"]);
}

void PieceHost::SetUp() {
    std::string name = ::testing::TempDir() + "pm_pieces.XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    m_folder = name;
}

void PieceHost::TearDown() {
    std::error_code ignored;
    std::filesystem::remove_all(m_folder, ignored);
}

std::vector<std::string> PieceHost::files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(m_folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

Outcome PieceHost::render(const Settings& settings, int cancelAfter) {
    return render(m_host.scene(), settings, cancelAfter);
}

Outcome PieceHost::render(PmrScene scene, const Settings& settings, int cancelAfter) {
    Seen seen;
    seen.cancelAfter = cancelAfter;
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.user = &seen;
    desc.bucketFinished = onBucket;
    desc.message = onMessage;
    PmrRender render = nullptr;
    EXPECT_EQ(PMR_OK, api().createRender(scene, &desc, &render)) << m_host.lastError();
    Settings all = m_settings;
    for (const auto& [name, value] : settings) all[name] = value;
    for (const auto& [name, value] : all)
        EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str()))
            << m_host.lastError();
    Outcome outcome;
    outcome.started = api().startRender(render);
    if (outcome.started == PMR_OK) {
        outcome.ended = api().waitRender(render, -1.0);
        if (!outcome.isOk()) outcome.error = m_host.lastError();
        const PmrRectangle frame{0, 0, 40, 28};
        outcome.beauty = readLayer(render, "beauty", 4, frame);
        outcome.standardError = readLayer(render, "stderr", 3, frame);
        outcome.samples = readLayer(render, "samples", 1, frame);
        outcome.json = nlohmann::json::parse(
            textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                return api().renderStatistics(render, buffer, capacity, needed);
            }));
    } else {
        outcome.error = m_host.lastError();
    }
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    outcome.warnings = seen.warnings;
    outcome.infos = seen.infos;
    return outcome;
}

void PieceHost::makePart(const std::string& name, const std::string& buckets,
                         const Settings& more) {
    Settings settings = more;
    settings["part"] = path(name);
    settings["buckets"] = buckets;
    const Outcome outcome = render(settings);
    ASSERT_TRUE(outcome.isOk()) << outcome.error;
}

std::string PieceHost::readFile(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(name, std::ios::binary).rdbuf();
    return std::move(text).str();
}

void PieceHost::writeFile(const std::string& name, const std::string& bytes) {
    std::ofstream(name, std::ios::binary) << bytes;
}

}  // namespace pm::test
