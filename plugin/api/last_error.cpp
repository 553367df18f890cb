// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/last_error.h"

#include <pthread.h>

#include <cstdlib>
#include <cstring>

namespace pm::plugin {

namespace {

// Stands for a text that there was no memory for.
constexpr char kNoMemory[] = "out of memory";

// The text of each thread, from strdup; null is none. No thread_local: of a library that is loaded
// at run time its place comes from malloc, and without memory the C library ends the process.
class TextOfThread {
  public:
    TextOfThread() noexcept : m_isUsable(pthread_key_create(&m_key, letGo) == 0) {}

    const char* find() const noexcept {
        return m_isUsable ? static_cast<const char*>(pthread_getspecific(m_key)) : nullptr;
    }
    // Takes what strdup gave, kNoMemory or null.
    void put(const char* text) const noexcept {
        const char* before = find();
        const bool isIn = m_isUsable && pthread_setspecific(m_key, text) == 0;
        letGo(const_cast<char*>(isIn ? before : text));
    }

  private:
    static void letGo(void* text) noexcept {
        if (text != kNoMemory) std::free(text);
    }

    pthread_key_t m_key{};
    bool m_isUsable;
};

const TextOfThread& textOfThread() noexcept {
    static const TextOfThread text;
    return text;
}

}  // namespace

void setLastError(const char* text) noexcept {
    const char* copy = strdup(text);
    textOfThread().put(copy == nullptr ? kNoMemory : copy);
}

void clearLastError() noexcept {
    textOfThread().put(nullptr);
}

std::string lastError() {
    const char* text = textOfThread().find();
    return text == nullptr ? std::string() : text;
}

}  // namespace pm::plugin
