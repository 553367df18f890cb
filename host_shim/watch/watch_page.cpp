// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/watch/watch_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "host_shim/report/report_html.h"

namespace pm::host {
namespace {

constexpr double kWidth = 1000, kHeight = 40;  // CSS pixels
constexpr std::array<const char*, 8> kColours{"#2a6fbb", "#d9822b", "#2a7d3c", "#8e44ad",
                                              "#b3261e", "#16808a", "#8a6d1b", "#c2447a"};
using Colours = std::map<std::string, const char*>;

// Who is shown as the maker of a part: its machine, else the part itself.
std::string makerOf(const WatchState::Part& part) {
    return part.listed.machine.empty() ? part.listed.file.filename().string() : part.listed.machine;
}

// In the order in which parts are listed, so that colours stay.
Colours coloursOf(const WatchState& state) {
    Colours colours;
    for (const WatchState::Part& part : state.parts)
        if (part.isIn)
            colours.emplace(makerOf(part), kColours.at(colours.size() % kColours.size()));
    return colours;
}

// All buckets from left to right in their order, coloured by who made them.
std::string strip(const WatchState& state, const Colours& colours) {
    std::string bars;
    const double wide = kWidth / static_cast<double>(std::max<std::size_t>(state.owners.size(), 1));
    for (std::size_t first = 0, last = 0; first < state.owners.size(); first = last) {
        while (last < state.owners.size() && state.owners[last] == state.owners[first]) ++last;
        if (state.owners[first] < 0) continue;
        const auto& part = state.parts.at(static_cast<std::size_t>(state.owners[first]));
        bars += fmt::format(
            "<rect x=\"{:.2f}\" y=\"0\" width=\"{:.2f}\" height=\"{:.0f}\" fill=\"{}\">"
            "<title>{}</title></rect>\n",
            static_cast<double>(first) * wide, static_cast<double>(last - first) * wide, kHeight,
            colours.at(makerOf(part)),
            escaped(fmt::format("buckets {}:{}, {}", first, last, makerOf(part))));
    }
    return fmt::format(
        "<svg viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\">\n<rect width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" fill=\"#eee\"/>\n{2}</svg>\n",
        kWidth, kHeight, bars);
}

std::string makerTable(const WatchState& state, const Colours& colours) {
    std::map<std::string, std::size_t> buckets;
    for (const WatchState::Part& part : state.parts)
        if (part.isIn) buckets[makerOf(part)] += part.buckets;
    std::vector<Row> rows;
    for (const auto& [maker, count] : buckets)
        rows.push_back({fmt::format("<span style=\"color:{}\">&#9632;</span> {}", colours.at(maker),
                                    escaped(maker)),
                        std::to_string(count)});
    return table({"made by", "buckets"}, rows);
}

std::string stateText(const WatchState::Part& part) {
    if (part.isIn) return fmt::format("in, {} buckets", part.buckets);
    if (!part.refusal.empty()) return escaped("left out till it changes: " + part.refusal);
    if (part.listed.isUnderWay)
        return fmt::format("in the making, {:.0f}%", 100 * part.listed.progress);
    return "awaited";
}

std::string partTable(const WatchState& state) {
    std::vector<Row> rows;
    for (const WatchState::Part& part : state.parts)
        rows.push_back({escaped(part.listed.file.filename().string()), escaped(part.listed.what),
                        escaped(part.listed.machine), stateText(part)});
    return table({"part", "buckets", "machine", "state"}, rows);
}

std::string statusText(const WatchState& state) {
    const auto in = std::ranges::count_if(state.parts, &WatchState::Part::isIn);
    if (in == 0) return fmt::format("No part is there yet; {} are awaited.", state.parts.size());
    return fmt::format("{} of {} buckets are there ({:.1f}%): {} of {} parts.", state.bucketsIn(),
                       state.owners.size(), 100 * state.share(), in, state.parts.size());
}

}  // namespace

std::size_t WatchState::bucketsIn() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(owners, [](int owner) { return owner >= 0; }));
}

double WatchState::share() const {
    return owners.empty() ? 0
                          : static_cast<double>(bucketsIn()) / static_cast<double>(owners.size());
}

bool WatchState::isWhole() const {
    return !owners.empty() && bucketsIn() == owners.size();
}

std::string watchPage(const WatchState& state, int refreshSeconds) {
    const Colours colours = coloursOf(state);
    std::string body = fmt::format("<h1>{}</h1>\n", escaped(state.name)) +
                       fmt::format("<p class=\"status\">{}</p>\n", escaped(statusText(state)));
    if (!state.picture.dataUri.empty())
        body += figureHtml(
            state.picture, "the picture",
            state.isWhole() ? "The picture." : "The picture; what is not there yet is black.");
    if (!state.owners.empty())
        body += section("buckets", "Buckets in their order, by who made them",
                        strip(state, colours) + makerTable(state, colours));
    body += section("parts", "Parts", partTable(state));
    return wholePage("pm watch: " + state.name, body, refreshSeconds);
}

}  // namespace pm::host
