// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the C++ tests of the interface share: the loaded table, handles that let go by themselves,
// one call that renders.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "plugin/include/pm_plugin.h"

namespace pm::test {

// The table of the library that was built; loaded once and never unloaded.
const PmrApi& api();

// A context and the committed box scene in it.
class BoxHost {
  public:
    explicit BoxHost(PmrMessageFunction message = nullptr, void* user = nullptr);
    ~BoxHost();
    BoxHost(const BoxHost&) = delete;
    BoxHost& operator=(const BoxHost&) = delete;

    PmrContext context() const { return m_context; }
    PmrScene scene() const { return m_scene; }
    std::string lastError() const;
    // A render with small defaults, and these settings on top.
    PmrRender makeRender(const std::map<std::string, std::string>& settings,
                         const PmrRenderDesc* desc = nullptr) const;

  private:
    PmrContext m_context = nullptr;
    PmrScene m_scene = nullptr;
};

inline constexpr std::int32_t kWidth = 72, kHeight = 56;

// Something to see: a sphere of radius 1 around the origin.
void addGreyBall(PmrContext context, PmrScene scene);

// All floats of a layer in a rectangle.
std::vector<float> readLayer(PmrRender render, const char* layer, std::uint32_t channels,
                             PmrRectangle rectangle);
// The beauty of a finished render of the box: rendered, read, destroyed.
std::vector<float> renderBox(const BoxHost& host,
                             const std::map<std::string, std::string>& settings,
                             PmrRectangle rectangle = {0, 0, kWidth, kHeight});

// The text that a function of the interface writes to a buffer.
template <typename Call>
std::string textOf(Call&& call) {
    std::uint64_t needed = 0;
    EXPECT_EQ(PMR_OK, call(nullptr, std::uint64_t{0}, &needed));
    // While a render runs the text may have grown since it was measured; then it is asked for
    // again.
    std::string text;
    PmrStatus status = PMR_ERROR_ARGUMENT;
    for (int tries = 0; status == PMR_ERROR_ARGUMENT && tries < 100; ++tries) {
        text.assign(needed, '\0');
        status = call(text.data(), std::uint64_t{text.size()}, &needed);
    }
    EXPECT_EQ(PMR_OK, status);
    text.resize(needed - 1);
    return text;
}

}  // namespace pm::test
