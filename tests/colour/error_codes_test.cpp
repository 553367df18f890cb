// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a display shows of a picture's error, and the words for it.
#include "host_shim/colour/error_codes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "host_shim/colour/colour_pipeline.h"

namespace pm::host::test {
namespace {

constexpr double kOffset = 0.01;

// So many grey pixels; the half differences of their reds go evenly from 0 to `most` codes.
struct Pixels {
    std::vector<float> values, halfDifferences;
    void add(int count, float value, double mostCodes) {
        for (int i = 0; i < count; ++i) {
            values.insert(values.end(), 3, value);
            const double codes = mostCodes * i / (count - 1);
            halfDifferences.insert(halfDifferences.end(),
                                   {static_cast<float>(codes / 255), 0.0f, 0.0f});
        }
    }
    SeenError seen(const DisplayTransform& view, double bias = 0) const {
        ErrorCodes codes(view, bias, kOffset);
        codes.add(values, halfDifferences);
        return codes.result();
    }
};

TEST(ErrorCodes, AreThoseOfNoiseAndBias) {
    const DisplayTransform raw = ColourPipeline({.view = "raw"}).displayTransform();
    Pixels pixels;
    pixels.add(1001, 0.5f, 10);
    EXPECT_NEAR(pixels.seen(raw).codes, 9.7, 0.02);
    // Bias of relMSE 1e-4 is 1 % of root(x^2 + 0.01).
    EXPECT_NEAR(pixels.seen(raw, 1e-4).codes, 9.7 + 0.01 * std::sqrt(0.26) * 255, 0.02);
    // A stop less shows half as much.
    DisplayTransform exposed = raw;
    exposed.setExposureStops(-1);
    EXPECT_NEAR(pixels.seen(exposed).codes, 9.7 / 2, 0.01);
}

TEST(ErrorCodes, TellDarkFromBrightParts) {
    const DisplayTransform raw = ColourPipeline({.view = "raw"}).displayTransform();
    Pixels pixels;
    pixels.add(1001, 0.1f, 10);
    pixels.add(2002, 0.5f, 2);
    const SeenError seen = pixels.seen(raw);
    EXPECT_NEAR(seen.darkCodes, 9.7, 0.02);
    EXPECT_NEAR(seen.brightCodes, 1.94, 0.01);
    // 9 % of the dark ones, a third of all, are above.
    EXPECT_NEAR(seen.codes, 9.1, 0.02);
    EXPECT_EQ(errorWords(seen), "noisy in dark parts");
    // Two dark pixels are no part.
    Pixels few;
    few.add(2, 0.1f, 10);
    few.add(98, 0.5f, 2);
    EXPECT_EQ(few.seen(raw).darkCodes, few.seen(raw).codes);
}

// What can't be shown is not seen: white stays white. Values that are no numbers count as black.
TEST(ErrorCodes, KnowWhatIsNotShown) {
    const DisplayTransform raw = ColourPipeline({.view = "raw"}).displayTransform();
    Pixels pixels;
    pixels.add(100, 3.0f, 100);
    EXPECT_EQ(pixels.seen(raw).codes, 0);
    pixels.halfDifferences.assign(300, std::numeric_limits<float>::quiet_NaN());
    EXPECT_TRUE(std::isfinite(pixels.seen(raw).codes));
    EXPECT_EQ(Pixels().seen(raw).codes, 0);
}

TEST(ErrorWords, AreOneTable) {
    const auto words = [](double all, double dark, double bright, bool isLowerBound = false) {
        return errorWords(SeenError{all, dark, bright, isLowerBound});
    };
    EXPECT_EQ(words(1, 1, 1), "clean at 8 bits");
    EXPECT_EQ(words(1, 1, 1, true), "noise barely visible");
    EXPECT_EQ(words(1.01, 2, 1), "noise barely visible");
    EXPECT_EQ(words(4, 5, 4), "visible noise");
    EXPECT_EQ(words(4, 5, 3), "visible noise in dark parts");
    EXPECT_EQ(words(4, 1, 5), "visible noise in bright parts");
    EXPECT_EQ(words(8.1, 9, 8, true), "noisy");
    EXPECT_EQ(words(25, 30, 1), "a draft");
    EXPECT_EQ(describe(SeenError{1.84, 2, 1, false}),
              "noise barely visible, 95 % of the pixels within 1.8 codes of 255");
    EXPECT_EQ(describe(SeenError{0.01, 0, 0, false}),
              "clean at 8 bits, 95 % of the pixels within 0.1 codes of 255");
}

// Users find the table in docs.
TEST(ErrorWords, AreDocumented) {
    std::ostringstream page;
    page << std::ifstream(PM_SOURCE_DIR "/docs/first_look.md").rdbuf();
    for (const double codes : {1.0, 3.0, 8.0, 24.0}) {
        const std::string row =
            "| " + errorWords(SeenError{codes, codes + 3, codes + 3, false}) + " | ";
        const std::string number = std::to_string(static_cast<int>(codes));
        EXPECT_NE(page.str().find(row + number + " |"), std::string::npos) << row;
        EXPECT_NE(errorWords(SeenError{codes, codes + 3, codes + 3, false}),
                  errorWords(SeenError{codes + 0.01, codes + 3, codes + 3, false}));
    }
    EXPECT_NE(page.str().find("| a draft | more |"), std::string::npos);
}

TEST(ErrorWords, OfRelMseAloneNeverSayClean) {
    EXPECT_EQ(errorWords(0.0), "noise barely visible");
    EXPECT_EQ(errorWords(1e-7), "noise barely visible");
    EXPECT_EQ(errorWords(4e-4), "visible noise");
    EXPECT_EQ(errorWords(0.1), "a draft");
    EXPECT_EQ(errorWords(std::nan("")), "a draft");
    EXPECT_EQ(errorWords(std::numeric_limits<double>::infinity()), "a draft");
}

}  // namespace
}  // namespace pm::host::test
