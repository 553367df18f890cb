// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Places for rows of tables, made from the members that they stand for.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"
#include "plugin/parameters/parameter.h"
#include "plugin/values/hasher.h"

namespace pm::plugin {

inline void putValue(Rgb& to, const ParameterValue& value) {
    const auto channel = [&](std::size_t i) { return static_cast<float>(value.numbers.at(i)); };
    to = {channel(0), channel(1), channel(2)};
}
inline void putValue(Vec3d& to, const ParameterValue& value) {
    to = {value.numbers.at(0), value.numbers.at(1), value.numbers.at(2)};
}
inline void putValue(std::array<double, 12>& to, const ParameterValue& value) {
    std::copy_n(value.numbers.begin(), to.size(), to.begin());
}
inline void putValue(std::string& to, const ParameterValue& value) {
    to = value.text;
}
template <typename Number>
requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
void putValue(Number& to, const ParameterValue& value) {
    if constexpr (std::is_enum_v<Number>)
        to = static_cast<Number>(static_cast<std::int32_t>(value.numbers.at(0)));
    else
        to = static_cast<Number>(value.numbers.at(0));
}

template <typename Value>
void hashValue(Hasher& hasher, const Value& value) {
    if constexpr (requires { value.size(); })
        hasher.addArray(std::span<const typename Value::value_type>(value));
    else
        hasher.add(value);
}

template <typename>
struct MemberOf;
template <typename Member, typename Whole>
struct MemberOf<Member Whole::*> {
    using Description = Whole;
};

// The place that is a member of a description.
template <auto Member>
constexpr auto memberPlace() {
    using Description = typename MemberOf<decltype(Member)>::Description;
    return Place<Description>{
        [](Description& d, const ParameterValue& value, std::int32_t) {
            putValue(d.*Member, value);
        },
        [](Hasher& hasher, const Description& d) { hashValue(hasher, d.*Member); }};
}

// The same of a member that pixels don't depend on.
template <auto Member>
constexpr auto unseenPlace() {
    using Description = typename MemberOf<decltype(Member)>::Description;
    return Place<Description>{[](Description& d, const ParameterValue& value, std::int32_t) {
                                  putValue(d.*Member, value);
                              },
                              nullptr};
}

// A member that is the number of a texture in its scene.
template <auto Member>
constexpr auto texturePlace() {
    using Description = typename MemberOf<decltype(Member)>::Description;
    return Place<Description>{
        [](Description& d, const ParameterValue&, std::int32_t texture) { d.*Member = texture; },
        [](Hasher& hasher, const Description& d) { hasher.add(d.*Member); }};
}

}  // namespace pm::plugin
