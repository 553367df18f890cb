// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/copies/download.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <thread>

#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array<std::chrono::milliseconds, 4> kPauses{
    std::chrono::milliseconds(250), std::chrono::milliseconds(500), std::chrono::milliseconds(1000),
    std::chrono::milliseconds(2000)};
constexpr long kConnectSeconds = 20;
constexpr long kSlowBytes = 100, kSlowSeconds = 30;  // slower for longer is a connection lost
constexpr long kMostRedirections = 5;
constexpr auto kGlance = std::chrono::milliseconds(20);
constexpr auto kLook = std::chrono::milliseconds(100);  // for signals, while nothing comes

// Once for the process, before any thread that may use it.
void beginCurl() {
    static const CURLcode begun = curl_global_init(CURL_GLOBAL_DEFAULT);
    if (begun != CURLE_OK) throw HostError(ExitCode::kInternal, "libcurl can't be used");
}

bool mayPass(CURLcode code, long status) {
    constexpr long kTimeout = 408, kTooEarly = 425, kTooMany = 429, kServer = 500;
    switch (code) {
        case CURLE_HTTP_RETURNED_ERROR:
            return status == kTimeout || status == kTooEarly || status == kTooMany ||
                   status >= kServer;
        case CURLE_COULDNT_RESOLVE_HOST:
        case CURLE_COULDNT_CONNECT:
        case CURLE_OPERATION_TIMEDOUT:
        case CURLE_PARTIAL_FILE:
        case CURLE_GOT_NOTHING:
        case CURLE_SEND_ERROR:
        case CURLE_RECV_ERROR:
        case CURLE_HTTP2:
        case CURLE_HTTP2_STREAM:
            return true;
        default:
            return false;
    }
}

void waitUnlessInterrupted(std::chrono::milliseconds pause) {
    for (const auto end = Clock::now() + pause; Clock::now() < end;
         std::this_thread::sleep_for(kGlance))
        throwIfInterrupted();
}

}  // namespace

struct Download::State {
    explicit State(Log& itsLog) : log(itsLog) {
        beginCurl();
        handle = curl_easy_init();
        multi = curl_multi_init();
        if (handle != nullptr && multi != nullptr) return;
        cleanUp();
        throw HostError(ExitCode::kInternal, "libcurl can't be used");
    }
    ~State() { cleanUp(); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    static std::size_t write(char* bytes, std::size_t size, std::size_t count, void* user);
    static int progress(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t);
    void cleanUp() {
        curl_multi_cleanup(multi);
        curl_easy_cleanup(handle);
    }
    // As curl_easy_perform, which looks up only once a second while a name is resolved.
    CURLcode perform();
    void setUp(const std::string& url);
    std::string whyFailed(CURLcode code, long status) const;

    Log& log;
    CURL* handle{};
    CURLM* multi{};
    std::array<char, CURL_ERROR_SIZE> error{};
    const DownloadTarget* target{};
    std::uint64_t bytes{}, mostBytes{};  // of this try
    bool isTooLong{};
    std::exception_ptr thrown;  // by the target
};

std::size_t Download::State::write(char* bytes, std::size_t size, std::size_t count, void* user) {
    State& state = *static_cast<State*>(user);
    const std::size_t all = size * count;
    state.bytes += all;
    state.isTooLong = state.bytes > state.mostBytes;
    if (state.isTooLong) return 0;
    try {
        state.target->take({bytes, all});
    } catch (...) {
        state.thrown = std::current_exception();
        return 0;
    }
    return all;
}

int Download::State::progress(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
    return interruptSignal() != 0 ? 1 : 0;
}

CURLcode Download::State::perform() {
    const auto check = [](CURLMcode code) {
        if (code != CURLM_OK) throw HostError(ExitCode::kInternal, curl_multi_strerror(code));
    };
    struct Added {
        Added(CURLM* itsMulti, CURL* itsHandle) : multi(itsMulti), handle(itsHandle) {}
        ~Added() { curl_multi_remove_handle(multi, handle); }
        Added(const Added&) = delete;
        Added& operator=(const Added&) = delete;
        CURLM* multi;
        CURL* handle;
    };
    check(curl_multi_add_handle(multi, handle));
    const Added added(multi, handle);
    for (int running = 1; running > 0;) {
        throwIfInterrupted();
        check(curl_multi_perform(multi, &running));
        if (running > 0)
            check(curl_multi_poll(multi, nullptr, 0, static_cast<int>(kLook.count()), nullptr));
    }
    int left = 0;
    while (const CURLMsg* message = curl_multi_info_read(multi, &left))
        if (message->msg == CURLMSG_DONE) return message->data.result;
    return CURLE_OK;
}

void Download::State::setUp(const std::string& url) {
    curl_easy_reset(handle);
    const auto set = [this](CURLoption option, auto value) {
        if (curl_easy_setopt(handle, option, value) != CURLE_OK)
            throw HostError(ExitCode::kInternal, "this libcurl lacks an option that is needed");
    };
    const bool isFile = url.starts_with("file://");
    set(CURLOPT_URL, url.c_str());
    // No one else than who typed the address decides to read a file of this machine.
    set(CURLOPT_PROTOCOLS_STR, isFile ? "file" : "http,https");
    set(CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
    set(CURLOPT_FOLLOWLOCATION, 1L);
    set(CURLOPT_MAXREDIRS, kMostRedirections);
    set(CURLOPT_FAILONERROR, 1L);
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_NETRC, static_cast<long>(CURL_NETRC_OPTIONAL));
    // A name server that doesn't answer is not waited for at the end.
    set(CURLOPT_QUICK_EXIT, 1L);
    set(CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
    set(CURLOPT_LOW_SPEED_LIMIT, kSlowBytes);
    set(CURLOPT_LOW_SPEED_TIME, kSlowSeconds);
    set(CURLOPT_USERAGENT, "pm_host");
    set(CURLOPT_ERRORBUFFER, error.data());
    set(CURLOPT_WRITEFUNCTION, &State::write);
    set(CURLOPT_WRITEDATA, this);
    set(CURLOPT_XFERINFOFUNCTION, &State::progress);
    set(CURLOPT_NOPROGRESS, 0L);
}

std::string Download::State::whyFailed(CURLcode code, long status) const {
    if (code == CURLE_HTTP_RETURNED_ERROR) return fmt::format("the server answers {}", status);
    std::string why = error[0] != '\0' ? error.data() : curl_easy_strerror(code);
    std::ranges::replace(why, '\n', ' ');
    return why;
}

Download::Download(Log& log) : m_state(std::make_unique<State>(log)) {}
Download::~Download() = default;

void Download::fetch(const std::string& url, std::uint64_t mostBytes,
                     const DownloadTarget& target) {
    State& state = *m_state;
    state.target = &target;
    state.mostBytes = mostBytes;
    for (std::size_t tried = 0;; ++tried) {
        throwIfInterrupted();
        state.setUp(url);
        state.bytes = 0;
        state.isTooLong = false;
        state.thrown = nullptr;
        state.error[0] = '\0';
        target.begin();
        const CURLcode code = state.perform();
        throwIfInterrupted();
        if (state.thrown) std::rethrow_exception(state.thrown);
        if (state.isTooLong)
            throw HostError(ExitCode::kBadInput,
                            fmt::format("{}: is longer than {} bytes", url, mostBytes));
        if (code == CURLE_OK) return;
        long status = 0;
        curl_easy_getinfo(state.handle, CURLINFO_RESPONSE_CODE, &status);
        const std::string why = state.whyFailed(code, status);
        if (tried == kPauses.size() || !mayPass(code, status))
            throw HostError(ExitCode::kFile,
                            fmt::format("{}: can't be fetched: {}{}", url, why,
                                        tried == 0 ? "" : fmt::format(", {} times", tried + 1)));
        state.log.message(Level::kDebug, fmt::format("{}: {}; tried again", url, why));
        waitUnlessInterrupted(kPauses.at(tried));
    }
}

std::string Download::text(const std::string& url, std::uint64_t mostBytes) {
    std::string text;
    fetch(url, mostBytes,
          {[&] { text.clear(); }, [&](std::string_view bytes) { text.append(bytes); }});
    return text;
}

}  // namespace pm::host
