// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is a part of a picture; its checksums are put right.
#include "tests/fuzz/fuzz_renders.h"
#include "tests/fuzz/fuzz_support.h"

using namespace pm::fuzz;

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
    makeGenuine("part", {}, *argc, *argv);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string file = writeFile("fuzz.part", withChecksums(textOf(data, size)));
    static char text[1 << 16];
    static float pixels[64 * 64 * 4];
    PmrMerge merge = nullptr;
    if (api().createMerge(context(), &merge) != PMR_OK) return 0;
    if (api().addPart(merge, file.c_str()) == PMR_OK) {
        const PmrRectangle area{0, 0, 64, 64};
        api().mergeMissing(merge, text, sizeof text, nullptr);
        api().readMergedPixels(merge, &area, "beauty", pixels, 0, 0);
        api().mergeStatistics(merge, text, sizeof text, nullptr);
        api().addPart(merge, file.c_str());
    }
    api().releaseMerge(merge);
    return 0;
}
