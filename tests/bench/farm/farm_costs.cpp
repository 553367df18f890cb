// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/farm/farm_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "integrator/values/error.h"

namespace pm::bench {

namespace {

using nlohmann::json;

MeasuredFrame frameOf(const json& its) {
    MeasuredFrame frame{its.at("name"), its.at("size"), its.at("passes"), {}};
    FarmCosts& costs = frame.costs;
    costs.passes = frame.passes;
    costs.buckets = its.at("buckets").get<std::vector<double>>();
    costs.pilot = its.at("pilot").get<std::vector<double>>();
    for (const auto& [name, seconds] : {std::pair{"pilotSeconds", &costs.pilotSeconds},
                                        {"startSeconds", &costs.startSeconds},
                                        {"mapSeconds", &costs.mapSeconds},
                                        {"photonSeconds", &costs.photonSeconds},
                                        {"mergeSeconds", &costs.mergeSeconds},
                                        {"sceneBytes", &costs.sceneBytes},
                                        {"photonBytes", &costs.photonBytes},
                                        {"partBytes", &costs.partBytes}})
        *seconds = its.at(name);
    return frame;
}

MeasuredFarm farmOf(const json& its) {
    MeasuredFarm farm;
    farm.cores = its.at("cores");
    farm.sharedSpeed = its.at("sharedSpeed");
    for (const json& frame : its.at("frames")) farm.frames.push_back(frameOf(frame));
    const json& preempted = its.at("preempted");
    farm.preemptedEvery = preempted.at("everySeconds");
    farm.preemptedStarts = preempted.at("starts");
    farm.preemptedSeconds = preempted.at("preemptedSeconds");
    farm.wholeSeconds = preempted.at("wholeSeconds");
    if (!its.contains("real")) return farm;
    farm.realFrame = frameOf(its.at("real"));
    const json& latencies = its.at("latencies");
    farm.latencies.submitSeconds = latencies.at("submitSeconds");
    farm.latencies.afterPhotons = latencies.at("afterPhotons");
    farm.latencies.dispatchSeconds = latencies.at("dispatchSeconds");
    farm.latencies.noticeSeconds = latencies.at("noticeSeconds");
    for (const json& real : its.at("farms"))
        farm.realFarms.push_back({real.at("workers"), real.at("runs"), real.at("seconds"),
                                  real.at("runSeconds"), real.at("others")});
    return farm;
}

}  // namespace

FarmCosts MeasuredFrame::lastingFor(double seconds) const {
    FarmCosts more = costs;
    const double perPasses = costs.localSeconds() - costs.startSeconds;
    const double factor = std::max(0.0, seconds - costs.startSeconds) / perPasses;
    for (double& bucket : more.buckets) bucket *= factor;
    more.passes *= factor;
    more.mapSeconds *= factor;
    more.photonSeconds *= factor;
    more.photonBytes *= factor;
    return more;
}

MeasuredFarm readMeasuredFarm(const std::filesystem::path& file) {
    std::ifstream stream(file);
    try {
        return farmOf(json::parse(stream));
    } catch (const std::exception& fault) {
        throw Error(Status::kIo, fmt::format("{}: can't be read as costs of a farm: {}",
                                             file.string(), fault.what()));
    }
}

}  // namespace pm::bench
