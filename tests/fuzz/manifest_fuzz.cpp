// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is the manifest of a packed scene; what is understood of it is written and read again.
#include <cstdlib>

#include "host_shim/copies/manifest.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const auto manifest =
            pm::host::Manifest::fromJson(pm::fuzz::textOf(data, size), "fuzz/manifest.json");
        const std::string text = manifest.toJson();
        const auto again = pm::host::Manifest::fromJson(text, "fuzz/manifest.json");
        if (again.toJson() != text || again.bytes() != manifest.bytes()) std::abort();
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
