// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <map>
#include <string>

#include "host_shim/cli/option_values.h"
#include "host_shim/cli/options.h"

namespace pm::host {

// What the command line says of checkpoints, parts and merging. Errors of all: kUsage.

// Takes the part out of the outputs, and gives the library its settings.
void readPieces(const std::string& checkpoint, const FrameNumber& frame, Options& options);

// The photon map and, with --photons-only, what that forbids: all that is about a picture or leaves
// the number of passes open. Before the outputs and readPieces. typed: as for checkBuckets.
void readPhotonMap(const std::string& photonMap, const std::map<std::string, std::string>& typed,
                   const FrameNumber& frame, Options& options);

// A run of buckets is one of many, of which a merge makes a picture: what that forbids. typed: the
// texts of options that are settings of the library.
void checkBuckets(const std::map<std::string, std::string>& typed, const Options& options);

// pm_host merge has parts and an output, and that is a picture.
void checkMerge(const Options& options);
// No output is a part. verb: for the message.
void checkPicturesOnly(const std::string& verb, const Options& options);

}  // namespace pm::host
