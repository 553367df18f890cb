// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is an OBJ file.
#include "host_shim/formats/obj/obj_reader.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        pm::host::readObj(pm::fuzz::textOf(data, size), "fuzz.obj", pm::fuzz::folder(),
                          [](pm::host::Warning, const std::string&) {});
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
