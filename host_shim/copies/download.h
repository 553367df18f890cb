// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "host_shim/log/log.h"

namespace pm::host {

// Where what is fetched goes.
struct DownloadTarget {
    std::function<void()> begin;                 // before each try: what came so far is nothing
    std::function<void(std::string_view)> take;  // the next bytes; what it throws ends the download
};

// Fetches files by http, https and file, one after the other over a connection that is kept;
// redirections from http and https are followed. What can pass (a server that is not up yet, is
// overloaded or loses the connection) is tried again, some seconds long. Proxies are those of
// http_proxy, https_proxy and no_proxy. Not for several threads.
class Download {
  public:
    explicit Download(Log& log);
    ~Download();
    Download(const Download&) = delete;
    Download& operator=(const Download&) = delete;

    // mostBytes: more end it. Errors: HostError kFile, "URL: can't be fetched: why"; kBadInput
    // where there is more than mostBytes; Interrupted; those of the target.
    void fetch(const std::string& url, std::uint64_t mostBytes, const DownloadTarget& target);
    // The same into a text.
    std::string text(const std::string& url, std::uint64_t mostBytes);

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace pm::host
