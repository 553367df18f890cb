// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <locale>
#include <string>
#include <utility>
#include <vector>

#include "host_shim/formats/obj/obj_reader.h"
#include "host_shim/formats/warnings.h"
#include "host_shim/values/host_error.h"

namespace pm::host::test {

// Keeps the warnings of what is tested.
struct Heard {
    std::vector<std::pair<Warning, std::string>> list;
    WarningSink sink = [this](Warning code, const std::string& text) {
        list.emplace_back(code, text);
    };
    bool has(Warning code, const std::string& part) const {
        return std::ranges::any_of(list, [&](const auto& warning) {
            return warning.first == code && warning.second.find(part) != std::string::npos;
        });
    }
};

// A decimal comma for C++ streams, whatever locales are installed.
struct CommaPoint : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

// The text of the HostError that work throws, its exit code before it: "3 scene.obj:1: ...".
template <typename Work>
std::string errorOf(const Work& work) {
    try {
        work();
    } catch (const HostError& error) {
        return std::to_string(error.exitCode()) + " " + error.what();
    }
    return "no error";
}

}  // namespace pm::host::test
