// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input are the arguments of a command line, one a line.
#include "host_shim/cli/command_line.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<std::string> arguments;
    std::string_view text = pm::fuzz::textOf(data, size);
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        // As the system hands them over: no zeros within.
        arguments.emplace_back(text.substr(0, end).substr(0, text.find('\0')));
        text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    }
    try {
        pm::host::parseCommandLine(arguments);
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
