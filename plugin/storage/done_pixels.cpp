// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/done_pixels.h"

namespace pm::plugin {

DonePixels::DonePixels(const Rect& window) : m_window(window) {}

template <typename Visit>
void DonePixels::forEach(const Rect& rect, Visit visit) const {
    const Rect both = intersect(rect, m_window);
    for (std::int32_t y = both.y0; y < both.y1; ++y) {
        std::size_t pixel =
            static_cast<std::size_t>(y - m_window.y0) * static_cast<std::size_t>(m_window.width()) +
            static_cast<std::size_t>(both.x0 - m_window.x0);
        for (std::int32_t x = both.x0; x < both.x1; ++x) visit(pixel++);
    }
}

void DonePixels::clear() {
    m_done = {};
    m_count = 0;
}

void DonePixels::add(const Rect& rect) {
    if (m_done.empty()) m_done.resize(static_cast<std::size_t>(m_window.area()));
    forEach(rect, [&](std::size_t pixel) {
        if (!m_done[pixel]) ++m_count;
        m_done[pixel] = true;
    });
}

bool DonePixels::hasAll(const Rect& rect) const {
    if (m_done.empty()) return false;
    bool all = true;
    forEach(rect, [&](std::size_t pixel) { all = all && m_done[pixel]; });
    return all;
}

bool DonePixels::hasAny(const Rect& rect) const {
    if (m_done.empty()) return false;
    bool any = false;
    forEach(rect, [&](std::size_t pixel) { any = any || m_done[pixel]; });
    return any;
}

}  // namespace pm::plugin
