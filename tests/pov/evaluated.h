// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_shim/formats/pov/evaluation/parser.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov::test {

// A scene with include files of its own, and what it says.
struct Scene {
    std::map<std::string, std::string> files;
    std::string said;
    std::vector<std::string> warnings;
    Limits limits;

    Evaluated read(const std::string& text) {
        Names names;
        Surroundings around;
        around.find = [this](const std::string& name) -> std::optional<std::string> {
            return files.contains(name) ? std::optional<std::string>(name) : std::nullopt;
        };
        around.read = [this](const std::string& name) { return files.at(name); };
        around.writable = [](const std::string&) { return std::nullopt; };
        around.debug = [this](const std::string& text) { said += text; };
        around.warn = [this](const Place& place, const std::string& text) {
            warnings.push_back(place.text() + ": " + text);
        };
        around.limits = limits;
        Parser parser(std::move(around), names);
        return parser.run(text, "scene.pov");
    }

    // What #debug says.
    std::string debug(const std::string& text) {
        read(text);
        return said;
    }
    std::string error(const std::string& text) {
        try {
            read(text);
        } catch (const HostError& error) {
            return error.what();
        }
        return "no error";
    }
    // All statements as printed() has them, one line each.
    std::string printedOf(const std::string& text) {
        std::string lines;
        const Evaluated scene = read(text);
        for (const auto& statement : scene.statements) lines += printed(*statement) + "\n";
        return lines;
    }
};

}  // namespace pm::host::pov::test
