// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrator/values/rect.h"

namespace pm::plugin {

// Which pixels of a window are done in a pass that was interrupted; it may go on with other
// buckets. A plain value.
class DonePixels {
  public:
    explicit DonePixels(const Rect& window);

    void clear();
    // Of rect what is in the window.
    void add(const Rect& rect);
    std::uint64_t count() const { return m_count; }

    // Whether all pixels that rect and window share, or any of them, are done.
    bool hasAll(const Rect& rect) const;
    bool hasAny(const Rect& rect) const;

  private:
    // Calls visit(place in the window) for each pixel that both have.
    template <typename Visit>
    void forEach(const Rect& rect, Visit visit) const;

    Rect m_window;
    std::vector<bool> m_done;  // empty while none is
    std::uint64_t m_count = 0;
};

}  // namespace pm::plugin
