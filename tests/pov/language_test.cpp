// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The scene language of POV-Ray on small texts; povray_oracle.py holds the same to POV-Ray itself.
#include <gtest/gtest.h>

#include <string>

#include "tests/pov/evaluated.h"

namespace pm::host::pov::test {
namespace {

std::string said(const std::string& text) {
    return Scene().debug(text);
}
std::string value(const std::string& expression) {
    return said("#declare V = " + expression + "; #debug vstr(5, V, \" \", 0, 3)");
}
std::string number(const std::string& expression) {
    return said("#debug str(" + expression + ", 0, 9)");
}

TEST(PovLanguage, NumbersPromoteAndKeepPrecedence) {
    EXPECT_EQ(number("1 + 2 * 3"), "7.000000000");
    EXPECT_EQ(number("-2 * -3"), "6.000000000");
    EXPECT_EQ(number("(1 < 2 & 3 >= 3 | 0)"), "1.000000000");
    EXPECT_EQ(number("(0 ? 5 : 6)"), "6.000000000");
    EXPECT_EQ(value("<1, 2, 3> * y"), "0.000 2.000 0.000 0.000 0.000");
    EXPECT_EQ(value("<1, 2> + <1, 1, 1>"), "2.000 3.000 1.000 0.000 0.000");
    EXPECT_EQ(value("rgb 0.5"), "0.500 0.500 0.500 0.000 0.000");
    EXPECT_EQ(value("rgbt <1, 0, 0, 0.25>"), "1.000 0.000 0.000 0.000 0.250");
    EXPECT_EQ(value("color red 0.5 filter 0.25"), "0.500 0.000 0.000 0.250 0.000");
    EXPECT_EQ(number("<1, 2, 3>.z + vlength(<3, 4, 0>)"), "8.000000000");
    EXPECT_EQ(number("vrotate(x, 90 * z).y"), "1.000000000");
    EXPECT_EQ(number("vaxis_rotate(y, x, 90).z"), "1.000000000");
}

TEST(PovLanguage, RandomNumbersAreThoseOfPovRay) {
    EXPECT_EQ(
        said("#declare R = seed(1); #for (I, 1, 3) #debug str(rand(R), 0, 9) #debug \" \" #end"),
        "0.421992875 0.487121198 0.665896216 ");
}

TEST(PovLanguage, LoopsChooseAndBreak) {
    EXPECT_EQ(said("#for (I, 0, 10, 2) #if (I = 6) #break #end #debug str(I, 0, 0) #end"), "024");
    EXPECT_EQ(said("#local I = 3; #while (I > 0) #debug str(I, 0, 0) #local I = I - 1; #end"),
              "321");
    const std::string choose =
        "#macro A(V) #switch (V) #case (1) #debug \"one \" #case (2) #debug \"two \" #break "
        "#range (3, 5) #debug \"some \" #break #else #debug \"other \" #end #end ";
    EXPECT_EQ(said(choose + "A(1) A(2) A(4) A(9)"), "one two two some other ");
    EXPECT_EQ(said("#ifdef (Q) #debug \"yes\" #elseif (1) #debug \"else\" #end"), "else");
}

TEST(PovLanguage, NamesComeAndGo) {
    EXPECT_EQ(said("#macro Up(N) #declare N = N + 1; #end #declare A = 1; Up(A) Up(A) #debug "
                   "str(A, 0, 0)"),
              "3");
    EXPECT_EQ(
        said("#macro F(N) #local L = N * 2; L #end #declare L = 5; #debug str(F(4) + L, 0, 0)"),
        "13");
    EXPECT_EQ(said("#declare A = 1; #undef A #ifndef (A) #debug \"gone\" #end"), "gone");
    EXPECT_EQ(said("#declare A = array[2][2] {{1, 2}, {3, 4}} #declare A[1][0] = 7; "
                   "#debug str(A[1][0] + A[0][1], 0, 0) #debug str(dimension_size(A, 2), 0, 0)"),
              "92");
    // What is declared next waits until this is.
    EXPECT_EQ(said("#macro G(R) #local A = array[2] {1, R} A #end #declare V = G(3) "
                   "#declare Q = V[1]; #debug str(Q, 0, 0)"),
              "3");
    Scene scene;
    scene.files["a.inc"] = "#local L = 2; #declare G = L + 1;";
    EXPECT_EQ(scene.debug("#include \"a.inc\" #debug str(G, 0, 0) #ifdef (L) #debug \"L\" #end"),
              "3");
}

TEST(PovLanguage, TextsAreMade) {
    EXPECT_EQ(said("#debug concat(\"a\\\"b\", str(123.456, 9, 3), str(123.456, -9, 3))"),
              "a\"b  123.45600123.456");
    EXPECT_EQ(
        said("#debug strupr(substr(\"ABcdEF\", 3, 2)) #if (\"ABC\" < \"ABD\") #debug chr(70) #end"),
        "CDF");
    EXPECT_EQ(number("val(\"-12.5\") + strlen(\"four\") + asc(\"A\")"), "56.500000000");
}

TEST(PovLanguage, FunctionsAndSplinesAreValues) {
    EXPECT_EQ(number("1"), "1.000000000");
    const std::string f =
        "#declare F = function(a, b) { a * b + pow(a, 2) } "
        "#declare G = function { F(x, 2) - u } ";
    EXPECT_EQ(said(f + "#debug str(G(3, 0, 0), 0, 3)"), "12.000");
    EXPECT_EQ(said("#declare S = function(n) { sum(i, 1, n, i * i) } #debug str(S(4), 0, 1)"),
              "30.0");
    const std::string s = "#declare S = spline { linear_spline 0, <0, 0, 0> 1, <2, 4, 6> } ";
    EXPECT_EQ(said(s + "#debug vstr(3, S(0.5), \" \", 0, 1)"), "1.0 2.0 3.0");
    const Evaluated scene =
        Scene().read("#declare F = function { x + 2 * y } isosurface { function { F(x, 1, z) } }");
    EXPECT_EQ(printed(*scene.statements[0]),
              "isosurface { function function (x, y, z) { (function (x, y, z) { (x + (2 * y)) "
              "})(x, 1, z) } }");
}

TEST(PovLanguage, StatementsBecomeNodes) {
    Scene scene;
    EXPECT_EQ(scene.printedOf(
                  "#declare R = sphere { 0, 1 } object { R pigment { rgb <1, 0, 0> } scale 2 }"),
              "object { sphere { 0, 1 } pigment { rgbft <1, 0, 0, 0, 0> } scale 2 }\n");
    EXPECT_EQ(
        scene.printedOf("prism { linear_sweep linear_spline -1, 1, 3, <0, 0>, <1, 0>, <0, 0> }"),
        "prism { -1, 1, 3, <0, 0>, <1, 0>, <0, 0> linear_sweep linear_spline }\n");
    EXPECT_EQ(scene.printedOf("plane { y, 0 pigment { checker rgb 1, rgb 0 scale 2 } }"),
              "plane { <0, 1, 0>, 0 pigment { checker rgbft <1, 1, 1, 0, 0>, rgbft <0, 0, 0, 0, 0> "
              "scale 2 } }\n");
}

TEST(PovLanguage, FailuresNamePlaceAndWhatIsAround) {
    Scene scene;
    scene.files["a.inc"] = "#macro M(A)\n  sphere { Unknown, 1 }\n#end\n";
    EXPECT_EQ(scene.error("#include \"a.inc\"\nM(1)\n"),
              "a.inc:2:12: 'Unknown' is not declared; in macro M, called at scene.pov:2:1");
    EXPECT_EQ(scene.error("#if (1)\n"), "scene.pov:1:1: #if has no #end");
    EXPECT_EQ(scene.error("##"), "scene.pov:1:1: # without the name of a directive");
    EXPECT_EQ(scene.error("#error \"stop\""), "scene.pov:1:1: #error: stop");
    EXPECT_NE(scene.error("sphere { <1, 2, 3> ").find("the end of the file"), std::string::npos);
}

TEST(PovLanguage, HostileTextsEnd) {
    Scene scene;
    scene.limits.iterations = 1000;
    EXPECT_NE(scene.error("#while (1) #end").find("more than 1000 iterations"), std::string::npos);
    EXPECT_NE(scene.error("#macro A() A() #end A()").find("more than"), std::string::npos);
    EXPECT_NE(scene.error("#declare A = array[1000000000]").find("an array of"), std::string::npos);
    scene.files["a.inc"] = "#include \"a.inc\"";
    EXPECT_NE(scene.error("#include \"a.inc\"").find("in each other"), std::string::npos);
    EXPECT_NE(scene.error("#declare A = " + std::string(5000, '(')).find("deeper than"),
              std::string::npos);
    EXPECT_NE(scene.error(std::string(5000, '{')).find("expected"), std::string::npos);
}

}  // namespace
}  // namespace pm::host::pov::test
