// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// JSON from outside: all of its readers refuse what would take too much, in one line.
#include "host_shim/formats/json/json_reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "host_shim/check/reference.h"
#include "host_shim/check/suite.h"
#include "host_shim/copies/manifest.h"
#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/formats/sidecar/sidecar.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

namespace fs = std::filesystem;

struct Given {
    const char* name;
    std::function<void(const std::string& text)> read;
};

template <typename Read>
Given ofFile(const char* name, const Read& read) {
    return {name, [read](const std::string& text) {
                const fs::path file = ::testing::TempDir() + "pm_json_reader.json";
                std::ofstream(file, std::ios::binary) << text;
                try {
                    read(file);
                } catch (...) {
                    fs::remove(file);
                    throw;
                }
                fs::remove(file);
            }};
}

const std::vector<Given>& readers() {
    static const std::vector<Given> kReaders{
        {"values", [](const std::string& text) { parseJson(text, "f", {}); }},
        {"sidecar",
         [](const std::string& text) {
             SceneFiles files(".", {});
             readSidecar(text, "f", files);
         }},
        {"manifest", [](const std::string& text) { Manifest::fromJson(text, "f"); }},
        {"plan", [](const std::string& text) { FarmPlan::fromJson(text, "f"); }},
        ofFile("suite", readSuite),
        ofFile("reference", readReference),
        ofFile("file", [](const fs::path& file) { parseJsonFile(file, {}); })};
    return kReaders;
}

void expectRefused(const std::string& text, const std::string& why) {
    for (const Given& reader : readers()) {
        const std::string error = errorOf([&] { reader.read(text); });
        EXPECT_TRUE(error.starts_with("3 ")) << reader.name << ": " << error;
        EXPECT_NE(error.find(why), error.npos) << reader.name << ": " << error;
        EXPECT_EQ(error.find('\n'), error.npos) << reader.name;
        EXPECT_LT(error.size(), 400u) << reader.name;
    }
}

std::string repeated(const std::string& part, std::size_t count) {
    std::string text;
    text.reserve(part.size() * count);
    for (std::size_t i = 0; i < count; ++i) text += part;
    return text;
}

TEST(Json, IsNotFollowedDeeply) {
    constexpr std::size_t kDeep = 300'000;
    const std::string why = "more than 16 deep";
    expectRefused(repeated("[", kDeep), why);
    expectRefused(repeated("[", kDeep) + repeated("]", kDeep), why);
    expectRefused(repeated("{\"a\":", kDeep), why);
    expectRefused("{\"$schema\": " + repeated("[", kDeep) + repeated("]", kDeep) + "}", why);
}

TEST(Json, HasEachKeyOnce) {
    expectRefused(R"({"$schema": 1, "$schema": 2})", "'$schema' is there twice");
    expectRefused(R"({"$schema": {"a": [{"b": 1, "\u0062": 2}]}})", "'b' is there twice");
    std::string many = "{\"$schema\": {";
    for (int i = 0; i < 1000; ++i) many += "\"" + std::to_string(i) + "\": 0, ";
    expectRefused(many + "\"7\": 1}}", "'7' is there twice");
}

TEST(Json, TakesMemoryInProportionToItsText) {
    for (const char* part : {"{},", "[],", "[{}],"})
        expectRefused("{\"$schema\": [" + repeated(part, 200'000) + "0]}", "takes more than ");
    // What we write ourselves is far from that.
    Manifest manifest;
    manifest.scene = "0";
    for (int i = 0; i < 20'000; ++i)
        manifest.files.push_back({std::to_string(i), 1, std::string(64, 'a')});
    const std::string text = manifest.toJson();
    JsonBudget budget("f", text.size());
    parseJson(text, budget, {});
    EXPECT_LT(budget.used(), (std::uint64_t{4} << 20) + 5 * text.size());
}

TEST(Json, TakesNoMoreThanTheMemoryLimit) {
    const std::string text = "[" + repeated("\"text\",", 100'000) + "0]";
    JsonBudget budget("f", text.size(), 1 << 20);
    EXPECT_EQ(errorOf([&] { parseJson(text, budget, {}); }),
              "5 f: what it says takes more than 1.0 MiB of memory, the limit (--memory-limit)");
    SceneFiles files(".", {});
    const std::string lights =
        R"({"schema": "pm-sidecar/1", "lights": [)" +
        repeated(R"({"type": "point", "position": [0, 0, 0], "intensity": 1},)", 9'000);
    EXPECT_TRUE(errorOf([&] {
                    readSidecar(lights, "f", files, {{}, 2 << 20});
                }).starts_with("5 f: what it says takes more than 2.0 MiB"));
}

// However long one value is.
TEST(Json, IsGivenUpWhenAsked) {
    constexpr std::size_t kLong = 1'000'000;
    struct Asked {};
    for (const std::string& text :
         {std::string(kLong, ' '), "\"" + std::string(kLong, 'a'), std::string(kLong, '1'),
          "[" + repeated("[],", kLong / 3), "{\"$schema\": \"" + std::string(kLong, 'a')}) {
        int calls = 0;
        const GoOn goOn = [&calls] {
            if (++calls == 3) throw Asked();
        };
        EXPECT_THROW(parseJson(text, "f", goOn), Asked);
        SceneFiles files(".", {});
        calls = 0;
        EXPECT_THROW(readSidecar(text, "f", files, {goOn, 0}), Asked);
    }
}

double processorSeconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Of ten times as much, by the time of as much. Quadratic work has a hundred.
double growth(std::size_t few, const std::function<void(std::size_t count)>& work) {
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
        const double start = processorSeconds();
        work(few);
        const double middle = processorSeconds();
        work(10 * few);
        best = std::min(best, (processorSeconds() - middle) / (middle - start));
        if (best < 25) break;
    }
    return best;
}

std::string entries(std::size_t count, const std::function<std::string(std::size_t)>& entry) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ",") + entry(i);
    return text;
}

TEST(Json, IsReadInTimeThatGrowsAsItDoes) {
    const auto read = [](const std::string& rest) {
        SceneFiles files(".", {});
        Heard heard;
        const Sidecar sidecar =
            readSidecar(R"({"schema": "pm-sidecar/1", )" + rest + "}", "f", files);
        SceneData scene =
            readObj("v 0 0 0\nv 1 0 0\nv 1 1 0\ng a\nf 1 2 3\n", "s.obj", ".", heard.sink);
        for (const std::string& name : sidecar.materialNames())
            scene.materials.emplace_back().name = name;
        addSidecar(sidecar, scene);
    };
    const auto key = [](std::size_t i) { return "\"k" + std::to_string(i) + "\""; };
    struct List {
        const char* frame;
        std::size_t few;
        std::function<std::string(std::size_t)> entry;
    };
    const List lists[] = {
        {"\"instances\": [{}]", 6'000,
         [&](std::size_t i) {
             return R"({"of": "a", "translate": [1, 2, 3], "materials": {"default": )" +
                    key(i % 1000) + "}}";
         }},
        {"\"spheres\": [{}]", 2'000,
         [&](std::size_t i) { return "{\"radius\": 1, \"material\": " + key(i % 1000) + "}"; }},
        {"\"lights\": [{}]", 4'000,
         [](std::size_t) { return R"({"type": "point", "position": [0, 0, 0], "intensity": 1})"; }},
        {"\"cameras\": [{}]", 2'000, [](std::size_t) { return R"({"position": [0, 0, 1]})"; }},
        {"\"materials\": {{}}", 1'000,
         [&](std::size_t i) { return key(i) + R"(: {"metalness": 1})"; }}};
    for (const List& list : lists) {
        const double times = growth(list.few, [&](std::size_t count) {
            std::string text = list.frame;
            read(text.replace(text.find("{}"), 2, entries(count, list.entry)));
        });
        EXPECT_LT(times, 30) << list.frame;
    }
    const auto whole = [](const std::string& text) {
        JsonBudget budget = JsonBudget::ofLimit("f", 0);
        parseJson(text, budget, {});
    };
    const double ofKeys = growth(4'000, [&](std::size_t count) {
        whole("{" + entries(count, [&](std::size_t i) { return key(i) + ": 1"; }) + "}");
    });
    EXPECT_LT(ofKeys, 30);
    const double ofObjects = growth(8'000, [&](std::size_t count) {
        whole("[" + entries(count, [&](std::size_t i) { return "{" + key(i) + ": 1}"; }) + "]");
    });
    EXPECT_LT(ofObjects, 30);
}

TEST(Json, PartsComeOneByOne) {
    std::string seen;
    JsonBudget budget("f", 1000);
    const auto rest = readJsonParts(
        R"({"a": [1, {"x": [2]}, "s"], "b": {"c": 3, "d": {}}, "e": [], "f": [4], "g": 5})", budget,
        {},
        {[](const std::string& key, bool isObject) {
             return key == "a" || (key == "b" && isObject);
         },
         [&](const JsonPart& part) {
             seen += part.key + (part.isEntry ? std::to_string(part.index) : "") +
                     (part.key == "b" ? part.name : "") + part.value.dump() + " ";
         }});
    EXPECT_EQ(seen, R"(a01 a1{"x":[2]} a2"s" b0c3 b1d{} e[] f[4] g5 )");
    EXPECT_TRUE(rest.is_object() && rest.empty());
    EXPECT_EQ(budget.used(), 0u);
}

TEST(Json, SumsOfAManifestAreExact) {
    const auto of = [](int files, std::uint64_t bytes, const std::string& more) {
        std::string text =
            R"({"schema": "pm-pack/1", "scene": "0", "base": "/", "folders": [], "searchPaths": [],
                "ocio": null, "environment": null, "files": [)";
        for (int i = 0; i < files; ++i)
            text += fmt::format(R"({}{{"place": "{}", "bytes": {}, "sha256": "{:064x}"}})",
                                i == 0 ? "" : ",", i, bytes, i);
        return text + more + "]}";
    };
    constexpr std::uint64_t kMost = std::uint64_t{1} << 50;
    EXPECT_EQ(Manifest::fromJson(of(1024, kMost, ""), "f").bytes(), std::uint64_t{1} << 60);
    // 2^64: what a sum of 64 bits takes for nothing.
    EXPECT_EQ(errorOf([&] { Manifest::fromJson(of(1 << 14, kMost, ""), "f"); }),
              "3 f: can't be understood: its files have more than 1152921504606846976 bytes");
    const std::string other =
        fmt::format(R"(,{{"place": "x", "bytes": 2, "sha256": "{:064x}"}})", 0);
    EXPECT_EQ(errorOf([&] { Manifest::fromJson(of(1, 1, other), "f"); }),
              "3 f: can't be understood: x: 2 bytes, and 1 where the same content is named before");
    const std::string below =
        fmt::format(R"(,{{"place": "0/a/b", "bytes": 2, "sha256": "{:064x}"}})", 7);
    EXPECT_EQ(errorOf([&] { Manifest::fromJson(of(1, 1, below), "f"); }),
              "3 f: can't be understood: '0' is a file and a folder");
}

}  // namespace
}  // namespace pm::host::test
