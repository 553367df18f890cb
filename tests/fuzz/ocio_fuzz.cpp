// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is an OpenColorIO config.
#include "host_shim/colour/colour_pipeline.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pm::host::ColourOptions options;
    options.ocioFile = pm::fuzz::writeFile("fuzz.ocio", pm::fuzz::textOf(data, size));
    try {
        const pm::host::ColourPipeline colour(options);
        colour.listViews();
        colour.listSpaces();
        colour.materialToRendering({0.5f, 0.25f, 1.0f});
        colour.displayTransform();
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
