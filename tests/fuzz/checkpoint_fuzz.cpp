// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is a checkpoint that a render goes on from; its checksums are put right.
#include "tests/fuzz/fuzz_renders.h"
#include "tests/fuzz/fuzz_support.h"

using namespace pm::fuzz;

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    makeGenuine("checkpoint", {{"buckets", ""}}, *argc, *argv);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string file = writeFile("fuzz.checkpoint", withChecksums(textOf(data, size)));
    renderTriangle({{"checkpoint", file}, {"resume", "1"}, {"passes", "2"}});
    return 0;
}
