// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

namespace pm::host {

// How far a picture is from the truth as a display shows it: 95 % of its pixels are within so many
// codes of 255, in each of R, G and B, as far as the render can tell.
struct SeenError {
    double codes{};
    // Of the pixels below and of those from kBrightCode on; of few pixels that of all.
    double darkCodes{}, brightCodes{};
    // Whether the picture shows light finer than the estimates' radii: it is never called clean.
    bool isLowerBound{};
};

// Where dark parts end: the largest of a pixel's three codes of 255.
inline constexpr double kBrightCode = 64;
// Of a clean picture 95 % of the pixels are within so many codes.
inline constexpr double kCleanCodes = 1;

// "clean at 8 bits", "visible noise in dark parts", "a draft": the one table from a picture's error
// to words.
std::string errorWords(const SeenError& error);

// The same where nothing is known but the relMSE; such a picture is never called clean, for its
// exposure and view may show more or less of the error. Not finite: a draft.
std::string errorWords(double relMse);

// "noise barely visible, 95 % of the pixels within 1.8 codes of 255".
std::string describe(const SeenError& error);

}  // namespace pm::host
