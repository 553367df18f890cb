// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/same_bits_matrix.h"

#include <stdlib.h>

#include <cstdlib>
#include <cstring>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

constexpr const char* kCommaLocale = "de_DE.UTF-8";

// The factors of a combination, in its order.
enum Factor { kThreads, kSize, kOrder, kWindow, kResume, kParts, kFlush, kLocale };

const std::vector<int> kThreadCounts = {1, 2, 3, 8};
const std::vector<int> kSizes = {8, 24, 32, 64, 128};  // the last: one bucket holds any window
// The frame, a crop on no boundary of buckets or of 8 x 8 pixels, more than the frame.
const std::vector<PmrRectangle> kWindows = {kSameBitsFrame, {13, 7, 61, 50}, {-11, -5, 103, 75}};

// All that the library has, by its own account.
std::vector<std::string> bucketOrders() {
    std::vector<std::string> orders;
    for (std::uint32_t i = 0; i < api().settingCount(); ++i) {
        PmrSettingInfo info = PMR_INIT(PmrSettingInfo);
        EXPECT_EQ(PMR_OK, api().settingInfo(i, &info));
        if (std::strcmp(info.name, "bucketOrder") != 0) continue;
        std::istringstream choices(info.choices);
        for (std::string order; std::getline(choices, order, ',');) orders.push_back(order);
    }
    return orders;
}

std::string everyLayer() {
    std::string names;
    for (std::uint32_t i = 0; i < api().layerCount(); ++i) {
        PmrLayerInfo info = PMR_INIT(PmrLayerInfo);
        EXPECT_EQ(PMR_OK, api().layerInfo(i, &info));
        if (info.isDefault != 0) continue;
        if (!names.empty()) names += ',';
        names += info.name;
    }
    return names;
}

std::filesystem::path makeFolder() {
    std::string name = ::testing::TempDir() + "pm_same_bits.XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder " + name);
    return name;
}

void removeFolder(const std::filesystem::path& folder) {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
}

bool isCommaLocaleThere() {
    try {
        return std::use_facet<std::numpunct<char>>(std::locale(kCommaLocale)).decimal_point() ==
               ',';
    } catch (const std::runtime_error&) {
        return false;
    }
}

// A locale with a comma, made with localedef where it is not installed, until the end.
class CommaLocale {
  public:
    CommaLocale() : m_isThere(isCommaLocaleThere()) {
        if (m_isThere) return;
        m_folder = makeFolder();
        const std::string command = "localedef -i de_DE -f UTF-8 '" +
                                    (m_folder / kCommaLocale).string() + "' >/dev/null 2>&1";
        if (std::system(command.c_str()) == 0) setenv("LOCPATH", m_folder.c_str(), 1);
        m_isThere = isCommaLocaleThere();
    }
    ~CommaLocale() {
        if (m_folder.empty()) return;
        unsetenv("LOCPATH");
        removeFolder(m_folder);
    }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;

    bool isThere() const { return m_isThere; }

  private:
    bool m_isThere;
    std::filesystem::path m_folder;
};

bool hasCommaLocale() {
    static const CommaLocale locale;  // takes a second to make
    return locale.isThere();
}

}  // namespace

Settings pairSettings() {
    return {{"width", "96"},     {"height", "72"},        {"passes", "3"},
            {"photons", "4500"},  // a batch is 4096
            {"aaLevel", "2"},    {"aaLevelMost", "3"},    {"aaThreshold", "0.05"},
            {"gatherRays", "2"}, {"layers", everyLayer()}};
}

Settings fullMatrixSettings(bool isOneBucket) {
    Settings settings = {
        {"aaLevel", "0"}, {"photons", isOneBucket ? "4200" : "300"}, {"estimatePhotons", "20"}};
    settings.merge(pairSettings());  // the rest
    return settings;
}

bool isOneBucket(const Way& way) {
    return way.bucketSize == kSizes.back();
}

SameBitsMatrix::SameBitsMatrix() : m_orders(bucketOrders()), m_hasCommaLocale(hasCommaLocale()) {
    const auto count = [](const auto& levels) { return static_cast<int>(levels.size()); };
    // Parts have to know their buckets beforehand.
    const auto isAllowed = [this](const Combination& c) {
        return c[kParts] == 0 || m_orders[static_cast<std::size_t>(c[kOrder])] != "correlated";
    };
    m_all = fullMatrix(
        {count(kThreadCounts), count(kSizes), count(m_orders), count(kWindows), 2, 2, 2, 2},
        isAllowed);
}

bool SameBitsMatrix::isPossible(const Combination& combination) const {
    return combination[kLocale] == 0 || m_hasCommaLocale;
}

Combinations SameBitsMatrix::possible() const {
    Combinations some;
    for (const Combination& combination : m_all)
        if (isPossible(combination)) some.push_back(combination);
    return some;
}

Way SameBitsMatrix::wayOf(const Combination& c) const {
    const auto at = [&](const auto& levels, Factor factor, int further = 0) {
        return levels[static_cast<std::size_t>(c[factor] + further) % levels.size()];
    };
    Way way;
    way.threads = at(kThreadCounts, kThreads);
    way.bucketSize = at(kSizes, kSize);
    way.order = at(m_orders, kOrder);
    way.window = at(kWindows, kWindow);
    way.isCropped = c[kWindow] != 0;
    if (c[kResume] != 0) {
        way.resumeThreads = at(kThreadCounts, kThreads, 1);
        way.resumeBucketSize = at(kSizes, kSize, 2);
    }
    way.isInParts = c[kParts] != 0;
    way.flushesDenormals = c[kFlush] != 0;
    way.locale = c[kLocale] != 0 ? kCommaLocale : "";
    return way;
}

std::vector<std::size_t> indicesOfShare(std::size_t count, std::size_t share, std::size_t shares) {
    std::vector<std::size_t> indices;
    for (std::size_t i = share - 1; i < count; i += shares) indices.push_back(i);
    return indices;
}

SameBitsStudio::SameBitsStudio(Settings settings)
    : m_settings(std::move(settings)), m_folder(makeFolder()), m_texture(m_folder / "floor.ppm") {
    writeFloorTexture(m_texture);
}

SameBitsStudio::~SameBitsStudio() {
    removeFolder(m_folder);
}

LayeredPicture SameBitsStudio::make(const Way& way) {
    return makePicture(way, m_settings, {.texture = m_texture}, m_folder, m_interruptions);
}

std::string SameBitsStudio::differenceOf(const Way& way) {
    if (!m_expected) m_expected = make(Way{.window = kWindows.back(), .isCropped = true});
    return difference(make(way), *m_expected);
}

}  // namespace pm::test
