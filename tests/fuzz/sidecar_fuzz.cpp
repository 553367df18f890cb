// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is the sidecar of a small scene.
#include "host_shim/formats/obj/obj_reader.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static constexpr const char* kScene =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\nusemtl m\nf 1 2 3\ng b\nusemtl n\nf 1 2 3\n";
    try {
        pm::host::SceneFiles files(pm::fuzz::folder(), {});
        const auto sidecar =
            pm::host::readSidecar(pm::fuzz::textOf(data, size), "fuzz.pm.json", files);
        auto scene = pm::host::readObj(kScene, "fuzz.obj", pm::fuzz::folder(),
                                       [](pm::host::Warning, const std::string&) {});
        pm::host::addSidecar(sidecar, scene);
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
