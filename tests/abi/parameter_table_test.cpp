// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The tables of parameters from inside: a row more is checked, hashed and listed, and nothing else
// need be written for it.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "plugin/api/parameter_tables.h"
#include "plugin/parameters/parameter_set.h"
#include "plugin/parameters/place.h"

namespace pm::plugin {

namespace {

std::vector<MaterialParameter> rowsWithOneMore() {
    std::vector<MaterialParameter> rows(materialParameters().begin(), materialParameters().end());
    MaterialParameter more{};
    more.info.name = "dust";
    more.info.maximum = 2;
    more.info.defaultText = "0.5";
    more.info.isLater = true;
    more.places = {memberPlace<&MaterialDescription::glossyExponent>()};
    rows.push_back(more);
    return rows;
}

std::string hashOf(std::span<const MaterialParameter> rows, const MaterialDescription& material) {
    return checksumOf([&](Hasher& hasher) { hashRows(hasher, rows, material); });
}

template <typename Call>
std::string refusalOf(Call&& call, CallStatus status) {
    try {
        call();
    } catch (const CallError& error) {
        EXPECT_EQ(status, error.status()) << error.what();
        return error.what();
    }
    return "not refused";
}

TEST(ParameterTable, ARowMoreIsChecked) {
    const std::vector<MaterialParameter> rows = rowsWithOneMore();
    ParameterSet<MaterialParameter> set{std::span<const MaterialParameter>(rows)};
    EXPECT_EQ(0.5, set.number("dust"));
    EXPECT_EQ("wool: dust is 2.5; it must be 0 to 2",
              refusalOf(
                  [&] {
                      set.set("dust", {{2.5}, {}, {}}, "wool");
                  },
                  CallStatus::kArgument));
    EXPECT_EQ("wool: dust is '2x'; it must be 0 to 2",
              refusalOf([&] { set.setText("dust", "2x", "wool"); }, CallStatus::kArgument));
    EXPECT_EQ("wool: dust has 2 numbers; it must have 1",
              refusalOf(
                  [&] {
                      set.set("dust", {{1, 1}, {}, {}}, "wool");
                  },
                  CallStatus::kArgument));
    EXPECT_EQ(0.5, set.number("dust")) << "what was refused changes nothing";
    set.setText("dust", "2", "wool");
    MaterialDescription material;
    set.putInto(material);
    EXPECT_EQ(2.0f, material.glossyExponent);
}

TEST(ParameterTable, ARowMoreIsListed) {
    const std::vector<MaterialParameter> rows = rowsWithOneMore();
    ParameterSet<MaterialParameter> set{std::span<const MaterialParameter>(rows)};
    const std::string refusal =
        refusalOf([&] { set.setText("shine", "1", "wool"); }, CallStatus::kName);
    EXPECT_NE(std::string::npos, refusal.find("there is no parameter 'shine'")) << refusal;
    EXPECT_NE(std::string::npos, refusal.find("diffuse, glossy, ")) << refusal;
    EXPECT_NE(std::string::npos, refusal.find(", dust")) << refusal;
}

TEST(ParameterTable, ARowMoreIsHashedUnlessItHasItsDefault) {
    const std::vector<MaterialParameter> rows = rowsWithOneMore();
    MaterialDescription material;
    material.glossyExponent = 0.5f;
    EXPECT_EQ(hashOf(materialParameters(), material), hashOf(rows, material));
    material.glossyExponent = 0.75f;
    EXPECT_NE(hashOf(materialParameters(), material), hashOf(rows, material));
    // Two rows that differ in their names only.
    std::vector<MaterialParameter> others = rows;
    others.back().info.name = "fuzz";
    EXPECT_NE(hashOf(others, material), hashOf(rows, material));
}

// Where a host says nothing, a struct of zeros and a set of defaults must be the same.
template <typename Row>
void expectSound(std::span<const Row> rows, const char* table) {
    std::set<std::string> names;
    for (const Row& row : rows) {
        const ParameterInfo& info = row.info;
        SCOPED_TRACE(std::string(table) + " " + info.name);
        EXPECT_TRUE(names.insert(info.name).second) << "named twice";
        EXPECT_NE(0, *info.help);
        EXPECT_LE(info.minimum, info.maximum);
        const bool hasNumbers = info.type != ParameterType::kText &&
                                info.type != ParameterType::kTexture &&
                                info.type != ParameterType::kObjects;
        EXPECT_EQ(hasNumbers ? info.count : 0u, defaultValue(info).numbers.size());
        for (const double number : defaultValue(info).numbers)
            EXPECT_TRUE(info.isLater || info.count == 12 || number == 0 ||
                        number == info.zeroMeans);
        EXPECT_TRUE(info.isLater || row.inStruct.kind != StructPlace::Kind::kNone ||
                    info.type == ParameterType::kObjects)
            << "neither in the struct nor later than it";
    }
}

TEST(ParameterTable, RowsAreSound) {
    expectSound(materialParameters(), "material");
    expectSound(lightParameters(), "light");
    expectSound(environmentParameters(), "environment");
    expectSound(cameraParameters(), "camera");
    expectSound(instanceParameters(), "instance");
    std::apply([](const auto&... rows) { (expectSound(rows, "a shape"), ...); },
               sceneTables().shapes);
}

// A member of a description that no row fills and hashes would be lost in silence: whoever adds
// one changes a size here, and adds its row.
TEST(ParameterTable, EveryMemberHasARow) {
    EXPECT_EQ(288u, sizeof(MaterialDescription));
    EXPECT_EQ(44u, materialParameters().size());
    EXPECT_EQ(72u, sizeof(PointLightDescription));
    EXPECT_EQ(112u, sizeof(SpotLightDescription));
    EXPECT_EQ(80u, sizeof(DirectionalLightDescription));
    EXPECT_EQ(8u, lightParameters().size());
    EXPECT_EQ(112u, sizeof(EnvironmentDescription));
    EXPECT_EQ(3u, environmentParameters().size());
    EXPECT_EQ(120u, sizeof(CameraDescription));
    EXPECT_EQ(7u, cameraParameters().size());
}

}  // namespace

}  // namespace pm::plugin
