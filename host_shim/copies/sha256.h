// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace pm::host {

// SHA-256 of bytes that come piece by piece. By it files are named, and no one can make another
// file of the same name. Not for several threads.
class Sha256 {
  public:
    Sha256();
    void add(std::string_view bytes);
    // 64 hexadecimal digits, small letters; nothing is added any more.
    std::string digest();

  private:
    struct Free {
        void operator()(void* state) const;
    };
    std::unique_ptr<void, Free> m_state;
};

std::string sha256Of(std::string_view text);

// onBytes (may be empty) is given what was read, and may throw. Errors: HostError kFile.
std::string sha256OfFile(const std::filesystem::path& file,
                         const std::function<void(std::string_view)>& onBytes);

// 64 hexadecimal digits, small letters.
bool isSha256(std::string_view text);

}  // namespace pm::host
