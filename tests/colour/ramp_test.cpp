// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Ramps through displays and views: stored numbers, and formulas where there are some.
// [1] IEC 61966-2-1 (sRGB)  [2] ITU-R BT.1886
// [3] ACES 1.0.3, CTL reference: RRT and ODT.Academy.RGBmonitor_100nits_dim, whose tone
//     scales are quadratic B-splines in log10
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include "host_shim/colour/colour_pipeline.h"
#include "tests/colour/scratch.h"
#include "tests/colour/stored_ramps.h"

namespace pm::host::test {
namespace {

class Ramps : public ScratchTest {};

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<float> inputRamp() {
    return {0.18f, 0.18f, 0.18f, 4,     4,    4,     1,    0,    0,    0,    1,     0,
            0,     0,     1,     -0.5f, 0.2f, -0.1f, 1e4f, 1e4f, 1e4f, kNan, 0.18f, 0.18f};
}

// [1]; OpenColorIO joins the curve's two parts smoothly, which moves dark codes by 7e-6.
double srgbCode(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

double rec1886Code(double v) {
    return std::pow(v, 1 / 2.4);
}  // [2], black at 0

// [3]: one half of a segmented spline; fraction is where log10(x) lies between its ends, 0 to 1.
double splineLog(std::span<const double> coefficients, double fraction) {
    const auto knots = static_cast<double>(coefficients.size() - 3);
    const double at = std::min(fraction * knots, knots - 1e-9);
    const auto j = static_cast<std::size_t>(at);
    const double t = at - static_cast<double>(j);
    const double a = coefficients[j], b = coefficients[j + 1], c = coefficients[j + 2];
    return t * t * (0.5 * a - b + 0.5 * c) + t * (b - a) + 0.5 * (a + b);
}

double rrtNeutral(double x) {  // [3] segmented_spline_c5_fwd
    constexpr std::array<double, 6> kLow{-4.0,          -4.0,         -3.1573765773,
                                         -0.4852499958, 1.8477324706, 1.8477324706};
    constexpr std::array<double, 6> kHigh{-0.7185482425, 2.0810307172, 3.6681241237, 4, 4, 4};
    const double middle = std::log10(0.18), octave = std::log10(2.0), l = std::log10(x);
    if (l < middle) {
        return std::pow(10, splineLog(kLow, (l - middle + 15 * octave) / (15 * octave)));
    }
    return std::pow(10, splineLog(kHigh, (l - middle) / (18 * octave)));
}

double odtNeutral(double y) {  // [3] segmented_spline_c9_fwd, 48 nits
    constexpr std::array<double, 10> kLow{-1.6989700043, -1.6989700043, -1.4779, -1.2291,
                                          -0.8648,       -0.4480,       0.00518, 0.4511080334,
                                          0.9113744414,  0.9113744414};
    constexpr std::array<double, 10> kHigh{0.5154386965, 0.8470437783, 1.1358, 1.3802,
                                           1.5197,       1.5985,       1.6467, 1.6746091357,
                                           1.6878733390, 1.6878733390};
    const double low = std::log10(rrtNeutral(0.18 * std::exp2(-6.5)));
    const double middle = std::log10(rrtNeutral(0.18));
    const double high = std::log10(rrtNeutral(0.18 * std::exp2(6.5)));
    const double l = std::log10(y);
    const double nits = std::pow(10, l < middle ? splineLog(kLow, (l - low) / (middle - low))
                                                : splineLog(kHigh, (l - middle) / (high - middle)));
    const double linear = (nits - 0.02) / (48 - 0.02);
    return std::pow(linear, 0.9811);  // dim surround
}

Ramp shown(const ColourOptions& options, DisplayCleaning* cleaning = nullptr) {
    std::vector<float> values = inputRamp();
    const auto report = ColourPipeline(options).displayTransform().apply(values, 3);
    if (cleaning != nullptr) *cleaning = report;
    Ramp ramp{};
    for (std::size_t i = 0; i < 24; ++i) ramp[i / 3][i % 3] = values[i];
    return ramp;
}

void expectRamp(const Ramp& actual, const Ramp& expected) {
    for (std::size_t i = 0; i < 8; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(actual[i][c], expected[i][c], 2e-5) << "row " << i << " channel " << c;
        }
    }
}

void checkStored(const std::string& config) {
    std::size_t met = 0;
    for (const StoredRamp& stored : storedRamps()) {
        if (stored.config != config) continue;
        ++met;
        SCOPED_TRACE(std::string(stored.display) + " / " + stored.view);
        ColourOptions options;
        if (!config.empty()) options.ocioFile = PM_SHARED_DATA + config;
        options.renderingSpace = stored.renderingSpace;
        options.display = stored.display;
        options.view = stored.view;
        DisplayCleaning cleaning;
        expectRamp(shown(options, &cleaning), stored.expected);
        EXPECT_EQ(cleaning.nanCount, 1);
        EXPECT_EQ(cleaning.infiniteCount, 0);
    }
    EXPECT_GT(met, 0u);
}

#define PM_NEEDS_SHARED(path)                                         \
    if (!std::filesystem::exists(std::string(PM_SHARED_DATA) + path)) \
    GTEST_SKIP() << "needs " << PM_SHARED_DATA << path

TEST_F(Ramps, BuiltIn) {
    checkStored("");
}

TEST_F(Ramps, CgConfig) {
    PM_NEEDS_SHARED(kCgConfig);
    checkStored(kCgConfig);
}

TEST_F(Ramps, Demo) {
    PM_NEEDS_SHARED(kDemo);
    checkStored(kDemo);
}

void checkNeutral(const ColourOptions& options, const std::function<double(double)>& formula,
                  double tolerance) {
    const DisplayTransform transform = ColourPipeline(options).displayTransform();
    for (const float grey : {0.002f, 0.01f, 0.05f, 0.18f, 0.5f, 0.9f, 2.0f, 4.0f, 10.0f}) {
        std::array<float, 3> values{grey, grey, grey};
        transform.apply(values, 3);
        const double expected = std::min(1.0, formula(static_cast<double>(grey)));
        for (const float value : values) EXPECT_NEAR(value, expected, tolerance) << grey;
    }
}

TEST_F(Ramps, NeutralsFollowTheFormulas) {
    const auto aces = [](double v) { return odtNeutral(rrtNeutral(v)); };
    EXPECT_NEAR(srgbCode(aces(0.18)), 0.3559543, 2e-6);  // the figure known for ACEScg 0.18
    for (const char* space : {"Linear Rec.709", "ACEScg", "ACES2065-1"}) {
        SCOPED_TRACE(space);
        ColourOptions options{.renderingSpace = space, .display = "sRGB", .view = "untone-mapped"};
        checkNeutral(options, srgbCode, 1e-5);
        options.view = "ACES SDR";
        checkNeutral(
            options, [&](double v) { return srgbCode(aces(v)); }, 2e-4);
        options.display = "Rec.1886";
        checkNeutral(
            options, [&](double v) { return rec1886Code(aces(v)); }, 2e-4);
        options.view = "untone-mapped";
        checkNeutral(options, rec1886Code, 2e-6);
        options.view = "raw";
        checkNeutral(
            options, [](double v) { return v; }, 0.0);
    }
}

TEST_F(Ramps, KnownCodes) {
    const ColourOptions options{.view = "untone-mapped"};
    const DisplayTransform transform = ColourPipeline(options).displayTransform();
    const std::array<std::array<double, 2>, 6> codes{{{0.0031308, 0.04045},
                                                      {0.01, 0.099853},
                                                      {0.18, 0.461356},
                                                      {0.5, 0.735357},
                                                      {0.9, 0.954687},
                                                      {1.0, 1.0}}};
    for (const auto& [linear, code] : codes) {
        const auto v = static_cast<float>(linear);
        std::array<float, 3> values{v, v, v};
        transform.apply(values, 3);
        EXPECT_NEAR(values[1], code, 1.5e-6);
    }
}

TEST_F(Ramps, TwoShotsByContextVariable) {
    PM_NEEDS_SHARED(kContextConfig);
    // The config's README: shot1's matrix is x10, shot2's x20, and shot4 (x40) is its default.
    const std::vector<std::pair<std::string, float>> shots{{"shot1", 10}, {"shot2", 20}, {"", 40}};
    for (const auto& [shot, factor] : shots) {
        SCOPED_TRACE(shot);
        ColourOptions options;
        options.ocioFile = std::string(PM_SHARED_DATA) + kContextConfig;
        options.materialSpace = "SHOT_lut1_cs";
        if (!shot.empty()) options.context = {{"SHOT", shot}};
        const ColourPipeline colour(options);
        for (const Rgb3 given : {Rgb3{1, 0, 0}, Rgb3{0.18f, -0.5f, 1e4f}}) {
            const Rgb3 made = colour.materialToRendering(given);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(made[c], given[c] * factor, 1e-6f * std::fabs(made[c]));
            }
        }
        expectRamp(shown(options), storedRamps()[2].expected);  // its only view is raw
    }
}

TEST_F(Ramps, NothingBreaksAView) {
    const float infinity = std::numeric_limits<float>::infinity();
    const float largest = std::numeric_limits<float>::max();
    for (const char* view : {"ACES SDR", "untone-mapped", "raw"}) {
        SCOPED_TRACE(view);
        ColourOptions options;
        options.view = view;
        const DisplayTransform transform = ColourPipeline(options).displayTransform();
        std::vector<float> values{kNan,     kNan,   kNan,    0.25f,   infinity, -infinity,
                                  kNan,     0.5f,   largest, largest, largest,  0.75f,
                                  -largest, -1e30f, 0,       kNan};
        const DisplayCleaning report = transform.apply(values, 4);
        EXPECT_EQ(report.nanCount, 4);
        EXPECT_EQ(report.infiniteCount, 2);
        for (std::size_t i = 0; i < 16; ++i) {
            if (i % 4 != 3) {
                EXPECT_TRUE(values[i] >= 0.0f && values[i] <= 1.0f) << i;
            }
        }
        EXPECT_EQ(values[8], 1.0f);  // bright beyond measure is white, not black
        EXPECT_NEAR(values[0], 0.0f, 1e-6f);
        // The fourth channel is nobody's business.
        EXPECT_EQ(values[3], 0.25f);
        EXPECT_EQ(values[11], 0.75f);
        EXPECT_TRUE(std::isnan(values[15]));
    }
}

}  // namespace
}  // namespace pm::host::test
