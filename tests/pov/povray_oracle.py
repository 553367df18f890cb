#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: The pm authors
"""Small scenes say the same by #debug here and in POV-Ray, to the last digit that is printed.

usage: povray_oracle.py PM_HOST

Skips, with a line, where povray is not installed. Each scene stands for itself: a macro M(V) says a vector.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

HEAD = """#version 3.7;
global_settings { assumed_gamma 1 }
#macro F(A) #debug concat(str(A, 0, 9), "\\n") #end
#macro M(V) #debug concat(vstr(3, V, " ", 0, 9), "\\n") #end
#macro S(T) #debug concat(T, "\\n") #end
#debug "BEGIN\\n"
"""
TAIL = '\n#debug "END\\n"\nsphere { 0, 1 }\n'
SPLINE = "#declare P = spline { KIND 0, <0, 0, 0> 1, <1, 2, 0> 3, <2, -1, 5> 4, <7, 7, 7> 6, <0, 1, 2> }\n" \
         "#for (I, -1, 7, .25) M(P(I)) #end"

SCENES = [
    "F(1 + 2 * 3) F(-2 * -3) F(7 - 2 - 1) F(8 / 2 / 2)",
    "F((1 < 2)) F((2 <= 2)) F((1 != 1)) F((1 & 0 | 1)) F((3 > 2 & 2 > 1))",
    "F((1 ? 2 : 3)) F((0 ? 2 : (1 ? 5 : 6)))",
    "F(!0) F(!5 + 1) F(+5 - +3) F(-(-4))",
    "F(mod(-7, 3)) F(mod(7, -3)) F(mod(7.5, 2)) F(div(-7, 3)) F(div(7, 2))",
    "F(int(-2.5)) F(floor(-2.5)) F(ceil(-2.5)) F(int(2.9)) F(abs(-3))",
    "F(sin(1)) F(cos(1)) F(tan(1)) F(asin(.5)) F(acos(.5)) F(atan2(1, -1))",
    "F(sinh(1)) F(cosh(1)) F(tanh(1)) F(asinh(1)) F(acosh(2)) F(atanh(.5))",
    "F(exp(1)) F(ln(10)) F(log(1000)) F(pow(2, .5)) F(sqrt(2)) F(degrees(1)) F(radians(90))",
    "F(max(1, 5, 3)) F(min(4, 2, 8)) F(select(-1, 1, 2)) F(select(0, 1, 2, 3)) F(select(2, 1, 2, 3))",
    "F(bitwise_and(12, 10)) F(bitwise_or(12, 10)) F(bitwise_xor(12, 10))",
    "F(pi) F(true + yes + on) F(off + no + false) F(version)",
    "M(<1, 2, 3> + <4, 5, 6>) M(<1, 2, 3> * 2) M(2 / <1, 2, 4>) M(<1, 2, 3> - 1)",
    "M(x + 2 * y - z) M(-<1, 2, 3> * 2 + x) M(<1, 2, 3> * y)",
    "M(vcross(<1, 2, 3>, <4, 5, 6>)) M(vnormalize(<1, 2, 3>)) F(vdot(<1, 2, 3>, <4, 5, 6>)) F(vlength(<1, 2, 3>))",
    "M(vrotate(<1, 2, 3>, <10, 20, 30>)) M(vrotate(x, 90 * z)) M(vrotate(z, 90 * y))",
    "M(vaxis_rotate(<1, 2, 3>, <1, 1, 0>, 50)) M(vaxis_rotate(y, x, 90))",
    "#declare V = <1, 2, 3>; F(V.x) F(V.y + V.z) F(<4, 5, 6>.z) F(x.x)",
    "#declare V = <1, 2> + <1, 1, 1>; M(V) #declare W = <1, 2, 3, 4>; F(W.t)",
    "M((<1, 2, 3> = <1, 0, 3>)) M((<1, 2, 3> < <2, 2, 2>))",
    "#declare C = rgb <.75, .5, .25>; F(C.red) F(C.gray) F(C.transmit) M(C * 2)",
    "#declare C = rgbft <.1, .2, .3, .4, .5>; F(C.filter) F(C.transmit) #declare D = C * .5; F(D.transmit)",
    "#declare C = color red .5 green .25 filter .125; F(C.red) F(C.green) F(C.blue) F(C.filter)",
    "#declare C = rgb <1, .3, .7>; #declare D = 1.0 * C; F(D.red) F(D.green) F(D.blue)",
    "#declare C = srgb <.5, .25, 1>; F(C.red) F(C.green) F(C.blue)",
    "#declare C = rgbt <1, .5, .25, .75>; F(C.transmit) F(C.filter) F(C.blue)",
    'S(str(1 / 3, 0, -1)) S(str(-7, 10, 2)) S(str(-7, -10, 2)) S(str(2.5, 0, 0)) S(str(123.456, 4, 3))',
    'S(concat("a", "b\\"c", chr(65))) S(strlwr("ABC")) S(strupr("abc")) S(substr("ABCDEF", 2, 3))',
    'F(strlen("hello")) F(asc("B")) F(val("12.5e1")) F(val("-3")) F(strcmp("a", "a"))',
    'F(("a" = "a")) F(("b" < "a")) F(("a" != "b")) S(vstr(4, <1, 2, 3, 4>, ", ", 6, 2))',
    'S("tab\\tback\\\\slash")',
    "#declare R = seed(1); F(rand(R)) F(rand(R)) F(rand(R)) #declare Q = seed(12345); F(rand(Q)) F(rand(R))",
    "#declare R = seed(-5); F(rand(R)) F(rand(R))",
    "#declare A = array[3] {1, 2, 3} F(A[0] + A[2]) F(dimensions(A)) F(dimension_size(A, 1))",
    "#declare A = array[2][2] {{1, 2}, {3, 4}} #declare A[1][0] = 9; F(A[1][0] * A[0][1])",
    "#declare A = array[2] #declare A[0] = <1, 2, 3>; #ifdef (A[1]) F(1) #else F(0) #end M(A[0])",
    "#declare A = array[2] {1, 2} #declare B = A #declare B[0] = 7; F(A[0]) F(B[0])",
    "#for (I, 1, 3) F(I) #end F(I) #for (I, 3, 1, -1) F(I) #end #for (I, 1, 2, .5) F(I) #end",
    "#local I = 0; #while (I < 3) F(I) #local I = I + 1; #end",
    "#local I = 0; #while (1) #if (I >= 2) #break #end F(I) #local I = I + 1; #end",
    "#macro A(V) #switch (V) #case (1) F(1) #case (2) F(2) #break #range (3, 5) F(3) #break #else F(9) #end #end "
    "A(1) A(2) A(4) A(7)",
    "#macro Up(N) #declare N = N + 1; #end #declare B = 1; Up(B) Up(B) F(B)",
    "#macro D(N) #local L = N * 2; (L + 1) #end #declare L = 5; F(D(4) * 2) F(L)",
    "#macro Fac(N, R) #if (N > 1) #declare R = R * N; Fac(N - 1, R) #end #end #declare P = 1; Fac(6, P) F(P)",
    "#macro B(N) #if (N > 2) #break #end F(N) #end B(1) B(5) B(2)",
    "#declare A = 1; #undef A #ifdef (A) F(1) #elseif (1) F(2) #else F(3) #end #ifndef (A) F(4) #end",
    "#declare G = function(a, b) { a * b + max(a, b, 3) - select(a - 1, 2, 3, 4) } F(G(2, 5)) F(G(-2, .5))",
    "#declare G = function { x + y * z } F(G(1, 2, 3)) #declare H = function(u, v) { x - y } F(H(5, 3))",
    "#declare G = function(n) { sum(i, 1, n, i * i) + prod(j, 1, 3, j) } F(G(4))",
    "#declare G = function { x * x } #declare H = function { G(y, 0, 0) + 1 } F(H(0, 3, 0))",
    "#declare T = function { transform { rotate 30 * y scale <1, 2, 3> translate x } } M(T(1, 2, 3))",
    "#declare T = function { transform { rotate <10, 20, 30> inverse } } M(T(1, 2, 3))",
    *(SPLINE.replace("KIND", kind) for kind in
      ("linear_spline", "quadratic_spline", "cubic_spline", "natural_spline")),
    '#declare N = concat("A", "B"); S(N) #declare N = concat(N, N); S(N)',
    '#fopen W "oracle.txt" write #write (W, "\\"t\\",", 5.25, ",", <1, 2.5, 3>) #fclose W '
    '#fopen W "oracle.txt" read #read (W, T, N, V) S(T) F(N) M(V) #ifdef (W) F(1) #else F(0) #end',
]  # fmt: skip


def said(text):
    """The lines between BEGIN and END."""
    lines = [line.strip() for line in text.splitlines() if not line.startswith("pm_host: ")]
    if "BEGIN" not in lines:
        return lines
    begin = lines.index("BEGIN") + 1
    return lines[begin:lines.index("END")] if "END" in lines else lines[begin:]


def main():
    host = pathlib.Path(sys.argv[1]).resolve()
    if shutil.which("povray") is None:
        print("povray is not installed: skipped")
        return 77
    failures = 0
    with tempfile.TemporaryDirectory(dir="/tmp") as name:
        for number, scene in enumerate(SCENES):
            file = pathlib.Path(name) / f"s{number}.pov"
            file.write_text(HEAD + scene + TAIL)
            theirs = subprocess.run(["povray", f"+I{file.name}", "+W4", "+H4", "-D", "-F", "+Q0", "-GR", "-GS"],
                                    cwd=name, capture_output=True, text=True)  # fmt: skip
            ours = subprocess.run([host, file.name, "--explain", "-q"], cwd=name, capture_output=True, text=True)
            if said(theirs.stderr) != said(ours.stderr) or "END" not in theirs.stderr:
                failures += 1
                print(f"{scene}\n  povray: {said(theirs.stderr)[-12:]}\n  pm_host: {said(ours.stderr)[-12:]}")
    print(f"{len(SCENES) - failures} of {len(SCENES)} scenes say the same")
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
