// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/parameters/parameter.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// As short as the float that it came from.
std::string shortText(double value) {
    const auto single = static_cast<float>(value);
    return static_cast<double>(single) == value ? fmt::format("{}", single)
                                                : fmt::format("{}", value);
}

std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find(at), text.size());
        if (end > 0) parts.push_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return parts;
}

std::string withUnit(const ParameterInfo& info, std::string text) {
    return *info.unit == 0 ? text : fmt::format("{} ({})", text, info.unit);
}

CallError refuse(const ParameterInfo& info, const std::string& given, const std::string& owner) {
    return argumentError(
        fmt::format("{}: {} is {}; it must be {}", owner, info.name, given, allowedText(info)));
}

bool isInRange(const ParameterInfo& info, double value) {
    if (!std::isfinite(value)) return false;
    if (info.type == ParameterType::kInteger || info.type == ParameterType::kChoice)
        if (value != std::floor(value)) return false;
    const bool aboveMinimum = info.excludesMinimum ? value > info.minimum : value >= info.minimum;
    const bool belowMaximum = info.excludesMaximum ? value < info.maximum : value <= info.maximum;
    return aboveMinimum && belowMaximum;
}

bool hasNumbers(const ParameterInfo& info) {
    return info.type == ParameterType::kNumber || info.type == ParameterType::kInteger ||
           info.type == ParameterType::kChoice;
}

// Without asking for the range.
ParameterValue readValue(const ParameterInfo& info, const std::string& text,
                         const std::string& owner) {
    ParameterValue value;
    if (info.type == ParameterType::kText) value.text = text;
    if (!hasNumbers(info)) return value;
    const std::vector<std::string_view> choices = split(info.choices, ',');
    for (std::size_t i = 0; i < choices.size(); ++i)
        if (text == choices[i]) value.numbers = {static_cast<double>(i)};
    if (!value.numbers.empty()) return value;
    for (const std::string_view part : split(text, ' ')) {
        double number = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
        if (error != std::errc() || end != part.data() + part.size())
            throw refuse(info, fmt::format("'{}'", text), owner);
        value.numbers.push_back(number);
    }
    return value;
}

}  // namespace

std::string allowedText(const ParameterInfo& info) {
    switch (info.type) {
        case ParameterType::kChoice:
            return fmt::format("0 to {} or one of {}", info.maximum, info.choices);
        case ParameterType::kText:
            return "a text";
        case ParameterType::kTexture:
            return "a texture or none";
        case ParameterType::kObjects:
            return "given by the struct that makes the object";
        case ParameterType::kNumber:
        case ParameterType::kInteger:
            break;
    }
    const std::string least =
        fmt::format("{}{}", info.excludesMinimum ? "above " : "", shortText(info.minimum));
    if (info.minimum == -kNoEnd) return withUnit(info, "finite");
    if (info.maximum == kNoEnd)
        return withUnit(info,
                        least + (info.excludesMinimum ? " and finite" : " or more and finite"));
    if (info.excludesMaximum)
        return withUnit(info, fmt::format("{} and below {}", least, shortText(info.maximum)));
    return withUnit(info,
                    fmt::format("{} {} {}", least, info.excludesMinimum ? "and at most" : "to",
                                shortText(info.maximum)));
}

ParameterValue checkedValue(const ParameterInfo& info, ParameterValue value,
                            const std::string& owner) {
    if (info.type == ParameterType::kTexture || info.type == ParameterType::kText) {
        const bool isText = info.type == ParameterType::kText;
        if (!value.numbers.empty()) throw refuse(info, "given as numbers", owner);
        if (isText && value.texture) throw refuse(info, "given as a texture", owner);
        if (!isText && !value.text.empty()) throw refuse(info, "given as a text", owner);
        return value;
    }
    if (info.type == ParameterType::kObjects) throw refuse(info, "given by name", owner);
    if (value.texture) throw refuse(info, "given as a texture", owner);
    if (value.numbers.size() != info.count)
        throw argumentError(fmt::format("{}: {} has {} numbers; it must have {}", owner, info.name,
                                        value.numbers.size(), info.count));
    for (double& number : value.numbers) {
        if (number == 0.0 && info.zeroMeans != 0.0) number = info.zeroMeans;
        if (!isInRange(info, number)) throw refuse(info, shortText(number), owner);
    }
    return value;
}

ParameterValue defaultValue(const ParameterInfo& info) {
    return readValue(info, info.defaultText, "the table");
}

ParameterValue parseValue(const ParameterInfo& info, const std::string& text,
                          const std::string& owner) {
    return checkedValue(info, readValue(info, text, owner), owner);
}

}  // namespace pm::plugin
