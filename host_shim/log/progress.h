// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"

namespace pm::host {

// Shows how far a render is and how long it may still take, at most once a second (a bar ten
// times).
class Progress {
  public:
    // style kAuto: a bar when standard error is a terminal, else plain lines.
    Progress(ProgressStyle style, bool quiet, Log& log);
    ~Progress();

    // fraction in [0,1]; remainingSeconds NaN: not known yet.
    void update(double fraction, double remainingSeconds);

  private:
    void show(double fraction, double remainingSeconds);
    void print(const std::string& lines);

    ProgressStyle m_style;
    Log& m_log;
    double m_shownAt{-1e9};  // seconds since the start
    int m_shownPercent{-1};
};

// 75 -> "1:15", 3675 -> "1:01:15".
std::string clockText(double seconds);

}  // namespace pm::host
