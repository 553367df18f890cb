// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>

#include "host_shim/colour/pipeline_state.h"
#include "host_shim/values/letter_case.h"

namespace pm::host {
namespace {

std::vector<std::string> activeDisplays(const OCIO::ConstConfigRcPtr& config) {
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumDisplays(); ++i) names.emplace_back(config->getDisplay(i));
    return names;
}

std::vector<std::string> activeViews(const OCIO::ConstConfigRcPtr& config,
                                     const std::string& display) {
    std::vector<std::string> names;
    for (int i = 0; i < config->getNumViews(display.c_str()); ++i) {
        names.emplace_back(config->getView(display.c_str(), i));
    }
    return names;
}

// The canonical spelling of name among the allowed. Errors: kBadInput.
std::string checkedName(const std::string& option, const std::string& kind, const std::string& name,
                        const std::vector<std::string>& allowed) {
    for (const std::string& candidate : allowed) {  // OpenColorIO goes by no case either
        if (equalInAnyCase(candidate, name)) return candidate;
    }
    const std::string names =
        allowed.empty() ? "there are none" : "allowed are " + quotedList(allowed);
    throw HostError(ExitCode::kBadInput,
                    fmt::format("{}: unknown {} '{}'; {}", option, kind, name, names));
}

std::string defaultView(const ColourPipeline::State& state, const std::string& display) {
    const auto& config = state.config.config;
    // The viewing rules may prefer a view for this kind of space.
    const std::string ruled = config->getDefaultView(display.c_str(), state.renderingSpace.c_str());
    return ruled.empty() ? config->getDefaultView(display.c_str()) : ruled;
}

// Names in a looks string such as "+grade, -denoise | other".
void checkLooks(const ColourPipeline::State& state) {
    const auto& config = state.config.config;
    std::vector<std::string> allowed;
    for (int i = 0; i < config->getNumLooks(); ++i) {
        allowed.emplace_back(config->getLookNameByIndex(i));
    }
    const std::string& text = state.options.look;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find_first_of(",:|", begin), text.size());
        const std::size_t first = text.find_first_not_of(" +-", begin);
        if (first < end) {
            const std::size_t last = text.find_last_not_of(' ', end - 1);
            checkedName("--look", "look", text.substr(first, last - first + 1), allowed);
        }
        begin = end + 1;
    }
}

}  // namespace

void chooseView(ColourPipeline::State& state) {
    const auto& config = state.config.config;
    const ColourOptions& asked = state.options;
    const auto displays = activeDisplays(config);
    state.display = asked.display.empty()
                        ? config->getDefaultDisplay()
                        : checkedName("--display", "display", asked.display, displays);
    if (state.display.empty()) {
        if (!asked.view.empty()) checkedName("--view", "view", asked.view, {});
        return;  // a config without displays still renders to EXR
    }
    state.view = asked.view.empty()
                     ? defaultView(state, state.display)
                     : checkedName("--view", fmt::format("view of display '{}'", state.display),
                                   asked.view, activeViews(config, state.display));
    checkLooks(state);
}

DisplayTransform ColourPipeline::displayTransform() const {
    const State& state = *m_state;
    if (state.display.empty() || state.view.empty()) {
        throw HostError(
            ExitCode::kBadInput,
            fmt::format("--view: the config {} has no display with a view, so only .exr "
                        "can be written",
                        state.config.name));
    }
    const auto transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(state.renderingSpace.c_str());
    transform->setDisplay(state.display.c_str());
    transform->setView(state.view.c_str());
    const auto pipeline = OCIO::LegacyViewingPipeline::Create();
    pipeline->setDisplayViewTransform(transform);
    if (!state.options.look.empty()) {
        pipeline->setLooksOverrideEnabled(true);
        pipeline->setLooksOverride(state.options.look.c_str());
    }
    return DisplayTransform(
        guarded(fmt::format("display '{}', view '{}'", state.display, state.view), [&] {
            return makeSpaceConversion(
                pipeline->getProcessor(state.config.config, state.config.context));
        }));
}

std::vector<ViewEntry> ColourPipeline::listViews() const {
    const State& state = *m_state;
    const auto& config = state.config.config;
    const std::string display0 = config->getDefaultDisplay();
    std::vector<ViewEntry> entries;
    for (const std::string& display : activeDisplays(config)) {
        const std::string view0 = display == display0 ? defaultView(state, display) : "";
        for (const std::string& view : activeViews(config, display)) {
            entries.push_back({display, view, display == display0 && view == view0});
        }
    }
    return entries;
}

std::vector<LookEntry> ColourPipeline::listLooks() const {
    const auto& config = m_state->config.config;
    std::vector<LookEntry> entries;
    for (int i = 0; i < config->getNumLooks(); ++i) {
        const char* name = config->getLookNameByIndex(i);
        std::string words = config->getLook(name)->getDescription();
        std::ranges::replace(words, '\n', ' ');
        entries.push_back({name, std::move(words)});
    }
    return entries;
}

std::vector<SpaceEntry> ColourPipeline::listSpaces() const {
    std::vector<SpaceEntry> entries;
    const auto add = [&](const ColourConfig& config) {
        for (int i = 0; i < config.config->getNumColorSpaces(); ++i) {
            const auto space = findSpace(config, config.config->getColorSpaceNameByIndex(i));
            SpaceEntry entry{space->getName(), {}, isData(space), false, false, config.isBuiltIn};
            for (std::size_t a = 0; a < space->getNumAliases(); ++a) {
                entry.aliases.emplace_back(space->getAlias(a));
            }
            const bool inUse = config.name == m_state->config.name;
            entry.canRender = inUse && canRender(config, space);
            entry.isRenderingSpace = inUse && entry.name == m_state->renderingSpace;
            entries.push_back(std::move(entry));
        }
    };
    add(m_state->config);
    if (!m_state->config.isBuiltIn) add(m_state->builtIn);
    return entries;
}

}  // namespace pm::host
