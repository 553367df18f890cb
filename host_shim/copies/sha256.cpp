// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/sha256.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "host_shim/folders/own_folder.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;  // bytes read at once

EVP_MD_CTX* stateOf(void* state) {
    return static_cast<EVP_MD_CTX*>(state);
}

void check(int result) {
    if (result != 1) throw HostError(ExitCode::kInternal, "SHA-256 can't be computed");
}

[[noreturn]] void failReading(const std::filesystem::path& file) {
    throw HostError(ExitCode::kFile,
                    fmt::format("{}: can't be read: {}", file.string(), std::strerror(errno)));
}

// Closed with this.
struct Descriptor {
    int number;
    explicit Descriptor(const std::filesystem::path& file)
        : number(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {
        if (number < 0) failReading(file);
        struct stat status {};
        if (::fstat(number, &status) == 0 && S_ISREG(status.st_mode)) return;
        ::close(number);
        throw HostError(ExitCode::kFile, file.string() + ": can't be read: it is no file");
    }
    ~Descriptor() { ::close(number); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
};

}  // namespace

void Sha256::Free::operator()(void* state) const {
    EVP_MD_CTX_free(stateOf(state));
}

Sha256::Sha256() : m_state(EVP_MD_CTX_new()) {
    check(m_state ? EVP_DigestInit_ex(stateOf(m_state.get()), EVP_sha256(), nullptr) : 0);
}

void Sha256::add(std::string_view bytes) {
    check(EVP_DigestUpdate(stateOf(m_state.get()), bytes.data(), bytes.size()));
}

std::string Sha256::digest() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned int size = 0;
    check(EVP_DigestFinal_ex(stateOf(m_state.get()), bytes.data(), &size));
    std::string text;
    for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", bytes[i]);
    return text;
}

std::string sha256Of(std::string_view text) {
    Sha256 hash;
    hash.add(text);
    return hash.digest();
}

std::string sha256OfFile(const std::filesystem::path& file,
                         const std::function<void(std::string_view)>& onBytes) {
    const Descriptor descriptor(file);
    std::vector<char> piece(kPiece);
    Sha256 hash;
    for (;;) {
        const ssize_t count = ::read(descriptor.number, piece.data(), piece.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) failReading(file);
        if (count == 0) return hash.digest();
        const std::string_view bytes(piece.data(), static_cast<std::size_t>(count));
        hash.add(bytes);
        if (onBytes) onBytes(bytes);
    }
}

bool isSha256(std::string_view text) {
    constexpr std::size_t kDigits = 64;
    return isHex(text, kDigits);
}

}  // namespace pm::host
