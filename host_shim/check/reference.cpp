// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using json = nlohmann::ordered_json;

constexpr const char* kSchema = "pm-reference/1";

// So many digits as tell a float from its neighbours.
json numbers(const std::vector<double>& values) {
    json list = json::array();
    for (const double value : values) {
        const std::string text = fmt::format("{:.9g}", value);
        double kept = 0;
        std::from_chars(text.data(), text.data() + text.size(), kept);
        list.push_back(kept);
    }
    return list;
}

json textOf(const std::vector<RegionSpread>& spreads) {
    json list = json::array();
    for (const RegionSpread& spread : spreads)
        list.push_back({{"side", spread.side},
                        {"renders", spread.renders},
                        {"limit", spread.limit},
                        {"mean", numbers(spread.mean)},
                        {"variance", numbers(spread.variance)},
                        {"stored", numbers(spread.stored)}});
    return list;
}

std::vector<RegionSpread> spreadsOf(const json& list, const PixelRect& window) {
    std::vector<RegionSpread> spreads;
    for (const json& entry : list) {
        RegionSpread& spread = spreads.emplace_back();
        entry.at("side").get_to(spread.side);
        entry.at("renders").get_to(spread.renders);
        entry.at("limit").get_to(spread.limit);
        entry.at("mean").get_to(spread.mean);
        entry.at("variance").get_to(spread.variance);
        entry.at("stored").get_to(spread.stored);
        if (spread.side < 0 || spread.renders < 3)
            throw HostError(ExitCode::kBadInput, "regions without a side or of too few renders");
        if (!(spread.limit > 0) || !std::isfinite(spread.limit) ||
            !std::ranges::all_of(spread.variance, [](double v) { return v >= 0; }))
            throw HostError(ExitCode::kBadInput,
                            "a limit or a variance that is no positive number");
        const RegionGrid grid(window, spread.side);
        const auto count =
            3 * static_cast<std::size_t>(grid.columns()) * static_cast<std::size_t>(grid.rows());
        if (spread.mean.size() != count || spread.variance.size() != count ||
            spread.stored.size() != count)
            throw HostError(ExitCode::kBadInput,
                            fmt::format("not {} values for regions of {}", count, spread.side));
    }
    return spreads;
}

DisplayNoise displayNoiseOf(const json& entry, const PixelRect& window) {
    return {spreadsOf(entry.at("codes"), window), entry.at("visibleLimit").get<std::int64_t>()};
}

PairSpread pairsOf(const json& entry, const PixelRect& window) {
    PairSpread pairs;
    entry.at("mean").get_to(pairs.mean);
    entry.at("variance").get_to(pairs.variance);
    const RegionGrid grid(window, kPairSide);
    const auto count =
        3 * static_cast<std::size_t>(grid.columns()) * static_cast<std::size_t>(grid.rows());
    if (entry.at("side") != kPairSide || pairs.variance.size() != count ||
        pairs.mean.size() != count ||
        !std::ranges::all_of(pairs.variance, [](double v) { return v >= 0; }))
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("'pairs' are not {} variances of regions of {}", count, kPairSide));
    return pairs;
}

Reference parsed(const json& text) {
    if (text.at("schema") != kSchema)
        throw HostError(ExitCode::kBadInput, fmt::format("'schema' must be \"{}\"", kSchema));
    Reference reference;
    for (const json& entry : text.at("reasons"))
        reference.reasons.push_back({entry.at("because"), entry.at("date"), entry.at("version")});
    const std::vector<std::int32_t> window = text.at("window");
    if (window.size() != 4) throw HostError(ExitCode::kBadInput, "'window' must be four numbers");
    reference.window = {window[0], window[1], window[2], window[3]};
    if (reference.window.empty()) throw HostError(ExitCode::kBadInput, "'window' is empty");
    reference.regions = spreadsOf(text.at("regions"), reference.window);
    reference.display = displayNoiseOf(text, reference.window);
    if (text.contains("views"))
        for (const auto& [name, view] : text["views"].items())
            reference.views[name] = displayNoiseOf(view, reference.window);
    if (!std::ranges::equal(reference.regions, kRegionSides, {}, &RegionSpread::side))
        throw HostError(ExitCode::kBadInput, "'regions' are not those of 16 pixels and the whole");
    text.at("pixelLimit").get_to(reference.pixelLimit);
    if (text.contains("pairs")) reference.pairs = pairsOf(text["pairs"], reference.window);
    if (text.contains("inputs")) reference.inputs = text["inputs"].get<SceneInputs>();
    if (text.contains("warnings"))
        reference.warnings = text["warnings"].get<std::vector<std::string>>();
    return reference;
}

}  // namespace

double seenChange(const Reference& reference) {
    if (reference.pairs) return seenByPairs(*reference.pairs);
    return reference.regions.empty() ? 0 : seenChange(reference.regions.front());
}

Reference readReference(const std::filesystem::path& file) {
    const json text = parseJsonFile(file, throwIfInterrupted);
    try {
        return parsed(text);
    } catch (const json::exception& error) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: no reference: {}", file.string(), error.what()));
    } catch (const HostError& error) {
        throw HostError(error.code(), fmt::format("{}: {}", file.string(), error.what()));
    }
}

std::string textOf(const Reference& reference) {
    json reasons = json::array();
    for (const Reason& reason : reference.reasons)
        reasons.push_back(
            {{"because", reason.because}, {"date", reason.date}, {"version", reason.version}});
    const PixelRect& window = reference.window;
    json text{{"schema", kSchema},
              {"reasons", reasons},
              {"window", {window.x0, window.y0, window.x1, window.y1}},
              {"regions", textOf(reference.regions)},
              {"codes", textOf(reference.display.codes)},
              {"pixelLimit", reference.pixelLimit},
              {"visibleLimit", reference.display.visibleLimit}};
    for (const auto& [name, view] : reference.views)
        text["views"][name] = {{"codes", textOf(view.codes)}, {"visibleLimit", view.visibleLimit}};
    if (reference.pairs)
        text["pairs"] = {{"side", kPairSide},
                         {"twins", kTwins},
                         {"mean", numbers(reference.pairs->mean)},
                         {"variance", numbers(reference.pairs->variance)}};
    if (reference.warnings) text["warnings"] = *reference.warnings;
    if (reference.inputs) text["inputs"] = *reference.inputs;
    // A line for each part, so that a change of the reasons is seen beside those of the numbers.
    std::string lines;
    for (const auto& [key, value] : text.items())
        lines += fmt::format("{}\"{}\": {}", lines.empty() ? "{" : ",\n ", key,
                             value.dump(-1, ' ', false, json::error_handler_t::replace));
    return lines + "}\n";
}

}  // namespace pm::host
