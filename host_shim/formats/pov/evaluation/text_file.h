// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <fstream>
#include <memory>

#include "host_shim/formats/pov/lexer/token.h"

namespace pm::host::pov {

// A file that a scene opened with #fopen: to read values from, or to write texts to.
class TextFile {
  public:
    // To read: what was in the file.
    explicit TextFile(std::shared_ptr<const Source> source) : m_source(std::move(source)) {}
    // To write; to a stream, unless that is not open, and to a text.
    TextFile(std::ofstream stream, std::shared_ptr<std::string> text)
        : m_stream(std::move(stream)), m_text(std::move(text)) {}

    bool isRead() const { return m_source != nullptr; }
    const Source& source() const { return *m_source; }
    std::size_t at = 0;  // the next of the source's tokens

    void write(const std::string& bytes) {
        if (m_stream.is_open()) m_stream << bytes;
        constexpr std::size_t kMostKept = 16u << 20;
        if (m_text->size() + bytes.size() <= kMostKept) *m_text += bytes;
    }

  private:
    std::shared_ptr<const Source> m_source;
    std::ofstream m_stream;
    std::shared_ptr<std::string> m_text;
};

}  // namespace pm::host::pov
