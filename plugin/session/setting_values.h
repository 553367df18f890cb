// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "integrator/transport/frame/render_settings.h"
#include "integrator/values/rect.h"
#include "plugin/session/setting_table.h"

namespace pm::plugin {

// The values of one render's settings, each within its range at any time; first the defaults.
// A plain value. Errors of all setters: CallError NAME for a name that is not there, ARGUMENT for a
// value outside its range or of a type that doesn't fit; the value before then stays.
class SettingValues {
  public:
    SettingValues();

    void setInteger(std::string_view name, std::int64_t value);
    // Also for integers, when the value is one.
    void setNumber(std::string_view name, double value);
    // Any type; numbers have a dot in any locale.
    void setText(std::string_view name, std::string_view value);

    // As setText takes it, and gives the same value again.
    std::string text(std::string_view name) const;
    std::string text(Setting id) const;

    std::int64_t integer(Setting id) const;
    double number(Setting id) const;
    const std::string& word(Setting id) const;  // CHOICE and TEXT
    std::size_t choice(Setting id) const;       // CHOICE: its place among the choices

    // The window to render: the crop, else the frame.
    Rect window() const;
    // Whether a layer is among those that were asked for by name.
    bool wantsLayer(std::string_view layer) const;
    // Whether the number of passes is limited by itself: it was set, or nothing else ends a render.
    bool limitsPasses() const;
    // Passes at most: the most there can be where limitsPasses() is false.
    std::uint32_t passLimit() const;
    RenderSettings toRenderSettings() const;
    // The same with the error scale that the plan found: what a render's pieces and hash are of.
    SettingValues with(const ErrorScale& found) const;

  private:
    using Value = std::variant<std::int64_t, double, std::string>;

    // The place of a value that is set.
    Value& at(Setting id) {
        if (id == Setting::kPasses) m_passesAreSet = true;
        return m_values[static_cast<std::size_t>(id)];
    }
    const Value& at(Setting id) const { return m_values[static_cast<std::size_t>(id)]; }

    std::array<Value, kSettingCount> m_values;
    bool m_passesAreSet = false;
};

// "x0,y0,x1,y1" as a rectangle that is not empty, nothing for an empty text. Throws
// CallError(ARGUMENT).
std::optional<Rect> parseCrop(std::string_view text);

}  // namespace pm::plugin
