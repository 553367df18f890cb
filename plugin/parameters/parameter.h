// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a host says of a material, light, camera or instance, each number written down once: reader,
// checks, identity hash, list of textures, listing and manual loop over rows of these.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "plugin/textures/texture.h"

namespace pm::plugin {

class Hasher;

// The numbers are those of PMR_PARAMETER_* in pm_plugin.h.
enum class ParameterType : std::int32_t {
    kNumber,
    kInteger,
    kChoice,   // one of `choices`, by its place there or by its name
    kText,     // any
    kTexture,  // null: none
    kObjects,  // handles; by the struct only
};

inline constexpr double kNoEnd = std::numeric_limits<double>::infinity();
inline constexpr std::uint32_t kAllKinds = 0xffffffffu;
inline constexpr const char* kIdentityText = "1 0 0 0 0 1 0 0 0 0 1 0";  // of a transform

// What people and hosts are told of one parameter. Texts live as long as the library.
struct ParameterInfo {
    const char* name = "";
    const char* help = "";  // one line
    ParameterType type = ParameterType::kNumber;
    std::uint32_t count = 1;  // of numbers
    const char* unit = "";
    double minimum = 0, maximum = 1;  // kNoEnd: no end, but finite
    bool excludesMinimum = false, excludesMaximum = false;
    const char* defaultText = "";     // where a host says nothing; as parseValue takes it
    double zeroMeans = 0;             // what 0 stands for where that is no value of its own
    const char* choices = "";         // separated by commas
    std::uint32_t kinds = kAllKinds;  // bits by the kind of object: for which it means something
    bool changesPixels = true;        // and so the identity
    // Came after the structs: it is in none, and an object in which it has its default is the same
    // as one from before there was such a parameter.
    bool isLater = false;
};

struct ParameterValue {
    std::vector<double> numbers;
    std::string text;
    std::shared_ptr<const Texture> texture;
};

// Where a parameter lies in a description of the integrator's; empty where that has no such thing.
template <typename Description>
struct Place {
    // textureIndex: of the value's texture in the scene.
    void (*put)(Description&, const ParameterValue&, std::int32_t textureIndex) = nullptr;
    void (*hash)(Hasher&, const Description&) = nullptr;
};

// And in a struct of the C interface.
struct StructPlace {
    enum class Kind : std::uint8_t {
        kNone,  // not there
        kFloats,
        kDoubles,
        kInt32,
        kUint32,
        kText,       // const char*, null is empty
        kTransform,  // const double*, followed by the number of time samples
        kTexture,    // handle
    };
    Kind kind = Kind::kNone;
    std::size_t offset = 0;  // bytes
};

// A row of a table. Descriptions: what objects of this table become, one for each kind.
template <typename... Descriptions>
struct Parameter {
    ParameterInfo info;
    StructPlace inStruct;
    std::tuple<Place<Descriptions>...> places;
};

// What is allowed, in words, as "0 to 1 (radians)".
std::string allowedText(const ParameterInfo& info);
ParameterValue defaultValue(const ParameterInfo& info);

// The value, what 0 means put in its place. owner: for the text of errors, as "material 'wood'".
// Errors: CallError(ARGUMENT) saying the range where a number is outside of it, their count is
// another, or the value is of another type.
ParameterValue checkedValue(const ParameterInfo& info, ParameterValue value,
                            const std::string& owner);
// A text that stands for numbers: "0.5 0.5 1", or the name of a choice. Errors as above.
ParameterValue parseValue(const ParameterInfo& info, const std::string& text,
                          const std::string& owner);

}  // namespace pm::plugin
