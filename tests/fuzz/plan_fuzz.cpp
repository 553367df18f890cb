// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is the plan of a farm; what is understood of it is told, written and read again.
#include <cstdlib>

#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const auto plan = pm::host::FarmPlan::fromJson(pm::fuzz::textOf(data, size), "plan.json");
        for (std::size_t i = 0; i < plan.tasks.size(); ++i) plan.what(static_cast<int>(i) + 1);
        for (std::size_t i = 0; i < plan.frames.size(); ++i)
            if (plan.photonsOf(i) > static_cast<int>(plan.tasks.size())) std::abort();
        const std::string text = plan.toJson();
        if (pm::host::FarmPlan::fromJson(text, "plan.json").toJson() != text) std::abort();
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
