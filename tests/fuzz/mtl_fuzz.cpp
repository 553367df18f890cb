// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is the MTL file of a triangle.
#include "host_shim/formats/obj/obj_reader.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static constexpr const char* kScene =
        "mtllib fuzz.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n"
        "usemtl b\nf 1/1 2/1 3/1\n";
    pm::fuzz::writeFile("fuzz.mtl", pm::fuzz::textOf(data, size));
    try {
        pm::host::readObj(kScene, "fuzz.obj", pm::fuzz::folder(),
                          [](pm::host::Warning, const std::string&) {});
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
