// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The input is a scene in POV-Ray's language that may include itself.
#include <string>

#include "host_shim/formats/pov/evaluation/parser.h"
#include "host_shim/formats/pov/objects/scene_of.h"
#include "host_shim/values/host_error.h"
#include "tests/fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pm::host::pov;
    const std::string text(pm::fuzz::textOf(data, size));
    Names names;
    Surroundings around;
    around.find = [](const std::string&) { return std::optional<std::string>("fuzz.inc"); };
    around.read = [&text](const std::string&) { return text; };
    around.writable = [](const std::string&) { return std::nullopt; };
    around.debug = [](const std::string&) {};
    around.warn = [](const Place&, const std::string&) {};
    around.limits.iterations = 2000;
    around.limits.elementsOfArrays = 20000;
    around.limits.seconds = 2;
    try {
        Parser parser(std::move(around), names);
        const Evaluated scene = parser.run(text, "fuzz.pov");
        for (const auto& statement : scene.statements) printed(*statement);
        sceneOf(scene, {64, 48});
    } catch (const pm::host::HostError&) {
    }
    return 0;
}
