// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/setting_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <vector>

#include "plugin/session/layer_table.h"
#include "plugin/storage/bucket_range.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// Crops may exceed the frame, but not by more than this on each side.
constexpr std::int32_t kMaxOverscanPixels = 65536;
constexpr std::string_view kAutoErrorScale = "auto";

const SettingSpec& specOf(std::string_view name) {
    const SettingSpec* spec = findSetting(name);
    if (spec == nullptr)
        throw CallError(CallStatus::kName, fmt::format("there is no setting '{}'", name));
    return *spec;
}

std::string allowed(const SettingSpec& spec) {
    switch (spec.type) {
        case SettingType::kInteger:
            // 0 is no size but the library's own choice.
            if (spec.step > 1)
                return fmt::format("{}a multiple of {} from {} to {}",
                                   spec.minimum == 0 ? "0 or " : "", spec.step,
                                   std::max(spec.minimum, spec.step), spec.maximum);
            return fmt::format("{} to {}", spec.minimum, spec.maximum);
        case SettingType::kNumber:
            return fmt::format("{} to {}", spec.minimum, spec.maximum);
        case SettingType::kChoice:
            return fmt::format("one of {}", spec.choices);
        default:
            return "a text";
    }
}

template <typename Given>
CallError refuse(const SettingSpec& spec, const Given& given) {
    return argumentError(
        fmt::format("setting {} is {}; it must be {}", spec.name, given, allowed(spec)));
}

std::int64_t checkedInteger(const SettingSpec& spec, std::int64_t value) {
    if (value < spec.minimum || value > spec.maximum || value % spec.step != 0)
        throw refuse(spec, value);
    return value;
}

double checkedNumber(const SettingSpec& spec, double value) {
    if (!(value >= static_cast<double>(spec.minimum) && value <= static_cast<double>(spec.maximum)))
        throw refuse(spec, value);
    return value;
}

std::vector<std::string_view> splitAtCommas(std::string_view text) {
    std::vector<std::string_view> parts;
    while (!text.empty()) {
        const std::size_t comma = text.find(',');
        parts.push_back(text.substr(0, comma));
        if (comma == std::string_view::npos) return parts;
        text.remove_prefix(comma + 1);
        if (text.empty()) parts.push_back(text);
    }
    return parts;
}

std::string checkedChoice(const SettingSpec& spec, std::string_view value) {
    for (const std::string_view choice : splitAtCommas(spec.choices))
        if (value == choice) return std::string(value);
    throw refuse(spec, fmt::format("'{}'", value));
}

std::string checkedLayers(std::string_view value) {
    for (const std::string_view name : splitAtCommas(value)) {
        if (findLayer(name) == nullptr)
            throw argumentError(
                fmt::format("setting layers names '{}'; it must name layers out of {}", name,
                            fmt::join(layerNames(), ", ")));
    }
    return std::string(value);
}

template <typename Number>
bool parse(std::string_view text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

std::string checkedErrorScale(const SettingSpec& spec, std::string_view value) {
    std::int32_t stops = 0;
    if (value == kAutoErrorScale ||
        (parse(value, stops) && std::abs(stops) <= ErrorScale::kMostStops))
        return value == kAutoErrorScale ? std::string(value) : fmt::format("{}", stops);
    throw argumentError(
        fmt::format("setting {} is '{}'; it must be {}, or whole stops from {} to {}", spec.name,
                    value, kAutoErrorScale, -ErrorScale::kMostStops, ErrorScale::kMostStops));
}

std::string checkedFreeText(const SettingSpec& spec, std::string_view value) {
    if (spec.id == Setting::kLayers) return checkedLayers(value);
    if (spec.id == Setting::kCrop) parseCrop(value);
    if (spec.id == Setting::kBuckets) checkBucketRange(value);
    if (spec.id == Setting::kErrorScale) return checkedErrorScale(spec, value);
    return std::string(value);
}

}  // namespace

std::optional<Rect> parseCrop(std::string_view text) {
    if (text.empty()) return std::nullopt;
    const auto bad = [text] {
        return argumentError(
            fmt::format("setting crop is '{}'; it must be x0,y0,x1,y1 in whole pixels with x0 < x1 "
                        "and y0 < y1, from {} to {} and at most {} wide and high, or empty",
                        text, -kMaxOverscanPixels, kMaxFramePixels + kMaxOverscanPixels,
                        kMaxFramePixels + kMaxOverscanPixels));
    };
    const std::vector<std::string_view> parts = splitAtCommas(text);
    if (parts.size() != 4) throw bad();
    std::array<std::int32_t, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) {
        if (!parse(parts[i], values[i]) || values[i] < -kMaxOverscanPixels ||
            values[i] > kMaxFramePixels + kMaxOverscanPixels)
            throw bad();
    }
    const Rect crop{values[0], values[1], values[2], values[3]};
    if (crop.empty() || crop.width() > kMaxFramePixels + kMaxOverscanPixels ||
        crop.height() > kMaxFramePixels + kMaxOverscanPixels)
        throw bad();
    return crop;
}

SettingValues SettingValues::with(const ErrorScale& found) const {
    SettingValues values = *this;
    values.setInteger("errorScale", found.stops());
    return values;
}

SettingValues::SettingValues() {
    for (const SettingSpec& spec : settingSpecs()) setText(spec.name, spec.defaultText);
    m_passesAreSet = false;
}

void SettingValues::setInteger(std::string_view name, std::int64_t value) {
    const SettingSpec& spec = specOf(name);
    if (spec.type == SettingType::kInteger)
        at(spec.id) = checkedInteger(spec, value);
    else if (spec.type == SettingType::kNumber)
        at(spec.id) = checkedNumber(spec, static_cast<double>(value));
    else if (spec.id == Setting::kErrorScale)
        at(spec.id) = checkedErrorScale(spec, fmt::format("{}", value));
    else
        throw refuse(spec, fmt::format("given as the number {}", value));
}

void SettingValues::setNumber(std::string_view name, double value) {
    const SettingSpec& spec = specOf(name);
    if (spec.type == SettingType::kNumber) {
        at(spec.id) = checkedNumber(spec, value);
    } else if (spec.type == SettingType::kInteger) {
        // 2^63 is the first double beyond the range of integers.
        if (!(std::abs(value) < 9223372036854775808.0) || value != std::floor(value))
            throw refuse(spec, value);
        at(spec.id) = checkedInteger(spec, static_cast<std::int64_t>(value));
    } else {
        throw refuse(spec, fmt::format("given as the number {}", value));
    }
}

void SettingValues::setText(std::string_view name, std::string_view value) {
    const SettingSpec& spec = specOf(name);
    if (spec.type == SettingType::kInteger) {
        std::int64_t parsed = 0;
        if (!parse(value, parsed)) throw refuse(spec, fmt::format("'{}'", value));
        at(spec.id) = checkedInteger(spec, parsed);
    } else if (spec.type == SettingType::kNumber) {
        double parsed = 0;
        if (!parse(value, parsed)) throw refuse(spec, fmt::format("'{}'", value));
        at(spec.id) = checkedNumber(spec, parsed);
    } else if (spec.type == SettingType::kChoice) {
        at(spec.id) = checkedChoice(spec, value);
    } else {
        at(spec.id) = checkedFreeText(spec, value);
    }
}

std::string SettingValues::text(std::string_view name) const {
    return text(specOf(name).id);
}

std::string SettingValues::text(Setting id) const {
    return std::visit([](const auto& value) { return fmt::format("{}", value); }, at(id));
}

std::int64_t SettingValues::integer(Setting id) const {
    return std::get<std::int64_t>(at(id));
}

double SettingValues::number(Setting id) const {
    return std::get<double>(at(id));
}

const std::string& SettingValues::word(Setting id) const {
    return std::get<std::string>(at(id));
}

std::size_t SettingValues::choice(Setting id) const {
    std::size_t place = 0;
    for (const std::string_view name :
         splitAtCommas(settingSpecs()[static_cast<std::size_t>(id)].choices)) {
        if (name == word(id)) break;
        ++place;
    }
    return place;
}

Rect SettingValues::window() const {
    const Rect frame{0, 0, static_cast<std::int32_t>(integer(Setting::kWidth)),
                     static_cast<std::int32_t>(integer(Setting::kHeight))};
    return parseCrop(word(Setting::kCrop)).value_or(frame);
}

bool SettingValues::wantsLayer(std::string_view layer) const {
    for (const std::string_view name : splitAtCommas(word(Setting::kLayers)))
        if (name == layer) return true;
    return false;
}

bool SettingValues::limitsPasses() const {
    return m_passesAreSet ||
           !(number(Setting::kErrorTarget) > 0 || number(Setting::kTimeLimit) > 0);
}

std::uint32_t SettingValues::passLimit() const {
    return static_cast<std::uint32_t>(limitsPasses() ? integer(Setting::kPasses)
                                                     : specOf("passes").maximum);
}

RenderSettings SettingValues::toRenderSettings() const {
    RenderSettings settings;
    settings.width = static_cast<std::int32_t>(integer(Setting::kWidth));
    settings.height = static_cast<std::int32_t>(integer(Setting::kHeight));
    settings.window = window();
    settings.integrator = static_cast<IntegratorKind>(choice(Setting::kIntegrator));
    settings.plan = word(Setting::kPlan) == "everything" ? PlanKind::kEverything : PlanKind::kAuto;
    settings.photons = static_cast<std::uint64_t>(integer(Setting::kPhotons));
    settings.estimatePhotons = static_cast<std::uint32_t>(integer(Setting::kEstimatePhotons));
    settings.gatherRays = static_cast<std::uint32_t>(integer(Setting::kGatherRays));
    settings.passes = passLimit();
    settings.aaLevel = static_cast<std::uint32_t>(integer(Setting::kAaLevel));
    const auto most = static_cast<std::uint32_t>(integer(Setting::kAaLevelMost));
    settings.aaLevelMost = most > settings.aaLevel ? most : 0;
    settings.aaThreshold = number(Setting::kAaThreshold);
    settings.filter =
        word(Setting::kFilter) == "gaussian" ? PixelFilter::kGaussian : PixelFilter::kBox;
    std::int32_t stops = 0;
    if (parse(std::string_view(word(Setting::kErrorScale)), stops))
        settings.errorScale = ErrorScale(stops);
    settings.seed = static_cast<std::uint64_t>(integer(Setting::kSeed));
    settings.wantAlbedo = wantsLayer("albedo");
    settings.wantNormal = wantsLayer("N");
    settings.wantDepth = wantsLayer("Z");
    return settings;
}

}  // namespace pm::plugin
