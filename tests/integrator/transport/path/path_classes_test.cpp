// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Which class a path belongs to, by its lobes as read from the eye.
#include <gtest/gtest.h>

#include <string>

#include "integrator/transport/path/direct_light.h"

namespace pm::test {
namespace {

// F: the wide lobe of frosted glass.
PathClass classOf(const std::string& lobes) {
    PathState state;
    for (const char lobe : lobes)
        state.scatter(lobe == 'D'                  ? Lobe::kDiffuse
                      : lobe == 'B'                ? Lobe::kBroad
                      : lobe == 'G'                ? Lobe::kGlossy
                      : lobe == 'W' || lobe == 'F' ? Lobe::kWide
                                                   : Lobe::kReflection,
                      lobe == 'F');
    return state.classify();
}

TEST(PathClasses, ByTheLobesOnTheWay) {
    for (const char* path : {"", "S", "SS"}) EXPECT_EQ(classOf(path), PathClass::kEmission) << path;
    for (const char* path : {"D", "B", "G", "W", "SG", "GS", "SD", "GD", "SB", "SW", "GW", "WD",
                             "WSD", "GWB", "F", "FF", "FSF", "FWF", "GFGF"})
        EXPECT_EQ(classOf(path), PathClass::kDirect) << path;
    for (const char* path :
         {"DS",  "DG",  "SDS", "DBS", "DSBS", "DBBG", "BS", "BG", "WS", "WG", "WW",  "GWS", "SBBS",
          "WBS", "BWG", "BWS", "WDS", "GWDG", "FS",   "FG", "FW", "WF", "BF", "DFF", "FFS"})
        EXPECT_EQ(classOf(path), PathClass::kCaustic) << path;
    for (const char* path :
         {"DD", "DSD", "DB", "DSB", "BD", "BB", "BSD", "DDS", "DBDS", "BDS", "DSDS"})
        EXPECT_EQ(classOf(path), PathClass::kIndirect) << path;
}

}  // namespace
}  // namespace pm::test
