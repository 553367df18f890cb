// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The library's own JSON: what it finds, and what it refuses to read.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <span>
#include <string>

#include "plugin/values/call_error.h"
#include "plugin/values/json.h"

namespace pm::plugin {
namespace {

Json parsed(const std::string& text) {
    return Json::parse(std::as_bytes(std::span(text)));
}

TEST(Json, FindsManyKeysInTheirOrder) {
    constexpr int kCount = 1000;
    Json json;
    for (int i = 0; i < kCount; ++i) json[std::to_string(kCount - i).c_str()] = i;
    json["1000"] = -1;
    EXPECT_EQ(json.dump().substr(0, 20), R"({"1000":-1,"999":1,")");
    const Json again = parsed(json.dump());
    EXPECT_EQ(again.dump(), json.dump());
    for (int i = 1; i < kCount; ++i)
        EXPECT_EQ(again.at(std::to_string(kCount - i).c_str()).number(),
                  static_cast<std::uint64_t>(i));
    EXPECT_EQ(again.find("0"), nullptr);
    const Json copy = again;
    EXPECT_EQ(copy.at("7").number(), 993u);
}

TEST(Json, RefusesWhatIsNoHead) {
    const auto repeated = [](const std::string& part, std::size_t count) {
        std::string text;
        for (std::size_t i = 0; i < count; ++i) text += part;
        return text;
    };
    const std::string many = "[" + repeated("0,", 99'998) + "0";
    EXPECT_EQ(parsed(many + "]").elements().size(), 99'999u);
    for (const std::string& text :
         {many + ",0]", repeated("[", 300'000), repeated("{\"a\":", 300'000),
          std::string(R"({"a": 1, "a": 2})"), "{" + repeated("\"a\": 1, ", 20) + "\"b\": 1}",
          "\"" + std::string(17 << 20, 'a') + "\""})
        EXPECT_THROW(parsed(text), CallError) << text.substr(0, 20);
}

double secondsOf(int count) {
    std::timespec start{}, end{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    Json json;
    for (int i = 0; i < count; ++i) json[std::to_string(i).c_str()] = i;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    return static_cast<double>(end.tv_sec - start.tv_sec) +
           1e-9 * static_cast<double>(end.tv_nsec - start.tv_nsec);
}

// Quadratic work takes a hundred times as long.
TEST(Json, TakesKeysInTimeThatGrowsAsTheyDo) {
    double best = 1e9;
    for (int i = 0; i < 3 && best > 25; ++i)
        best = std::min(best, secondsOf(50'000) / secondsOf(5'000));
    EXPECT_LT(best, 30);
}

}  // namespace
}  // namespace pm::plugin
