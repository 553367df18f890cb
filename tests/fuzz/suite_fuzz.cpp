// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is a suite of pictures that are compared: what is read, and its options.
#include "host_shim/check/scene_check.h"
#include "host_shim/check/suite.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const auto suite =
            pm::host::readSuite(pm::fuzz::writeFile("suite.json", pm::fuzz::textOf(data, size)));
        for (pm::host::SuiteScene scene : suite.scenes) {
            scene.hasDisplay = false;  // configs are another fuzzer's
            try {
                pm::host::checkOptions(suite, scene);
            } catch (const pm::host::HostError&) {
            }
        }
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
