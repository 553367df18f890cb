// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is a photon map that a render reads; its checksums are put right.
#include "tests/fuzz/fuzz_renders.h"
#include "tests/fuzz/fuzz_support.h"

using namespace pm::fuzz;

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    makeGenuine("photonMap", {{"photonsOnly", "1"}}, *argc, *argv);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string file = writeFile("fuzz.photons", withChecksums(textOf(data, size)));
    renderTriangle({{"photonMap", file}});
    return 0;
}
