// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input are the tags of a cube that is a subdivision cage, and what else may follow its faces.
#include "host_shim/formats/obj/obj_reader.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static constexpr const char* kCube =
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "g cube\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
    try {
        pm::host::readObj(kCube + std::string(pm::fuzz::textOf(data, size)), "fuzz.obj",
                          pm::fuzz::folder(), [](pm::host::Warning, const std::string&) {});
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
