// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/job/farm_plan.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host_shim/formats/json/json_reader.h"
#include "host_shim/formats/json/json_values.h"
#include "host_shim/process/interrupt.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "pm-farm/1";
constexpr const char* kPhotons = "photons";
constexpr const char* kRun = "run";

Json taskJson(const FarmTask& task) {
    const bool isRun = task.kind == FarmTask::Kind::kRun;
    Json json = {{"kind", isRun ? kRun : kPhotons}, {"frame", task.frame}};
    if (isRun) {
        json["firstBucket"] = task.first;
        json["lastBucket"] = task.last;
        json["predictedThreadSeconds"] = task.predictedCost;
    }
    json["product"] = task.product.string();
    json["words"] = task.words;
    return json;
}

FarmTask taskOf(const Json& json) {
    FarmTask task;
    const bool isRun = json.at("kind").get<std::string>() == kRun;
    task.kind = isRun ? FarmTask::Kind::kRun : FarmTask::Kind::kPhotons;
    task.frame = wholeNumber<std::size_t>(json, "frame");
    if (isRun) {
        task.first = wholeNumber<std::uint32_t>(json, "firstBucket");
        task.last = wholeNumber<std::uint32_t>(json, "lastBucket");
        task.predictedCost = json.at("predictedThreadSeconds").get<double>();
    }
    task.product = json.at("product").get<std::string>();
    task.words = json.at("words").get<std::vector<std::string>>();
    return task;
}

FarmPlan planOf(const Json& json) {
    FarmPlan plan;
    for (const Json& option : json.at("given"))
        plan.given.push_back({option.at("name").get<std::string>(),
                              option.at("values").get<std::vector<std::string>>()});
    plan.program = json.at("program").get<std::string>();
    plan.folder = json.at("folder").get<std::string>();
    plan.isa = json.at("isa").get<std::string>();
    plan.bucketCount = wholeNumber<std::uint32_t>(json, "bucketCount");
    for (const Json& frame : json.at("frames")) {
        FarmFrame read;
        if (!frame.at("number").is_null()) read.number = wholeNumber<std::int64_t>(frame, "number");
        read.mergeWords = frame.at("mergeWords").get<std::vector<std::string>>();
        plan.frames.push_back(std::move(read));
    }
    for (const Json& task : json.at("tasks")) {
        throwIfInterrupted();
        plan.tasks.push_back(taskOf(task));
        static_cast<void>(plan.frames.at(plan.tasks.back().frame));
    }
    return plan;
}

}  // namespace

std::string FarmTask::what(const std::optional<std::int64_t>& frameNumber) const {
    const std::string of = frameNumber ? fmt::format(" of frame {}", *frameNumber) : "";
    return kind == Kind::kPhotons ? "photons" + of
                                  : fmt::format("buckets {}:{}{}", first, last, of);
}

std::string FarmPlan::what(int number) const {
    const FarmTask& its = task(number);
    return its.what(frames.at(its.frame).number);
}

int FarmPlan::photonsOf(std::size_t frame) const {
    for (std::size_t i = 0; i < tasks.size() && tasks[i].kind == FarmTask::Kind::kPhotons; ++i)
        if (tasks[i].frame == frame) return static_cast<int>(i) + 1;
    return 0;
}

std::string FarmPlan::beginning() {
    return fmt::format("{{\"schema\":\"{}\"", kSchema);
}

std::string FarmPlan::toJson() const {
    Json json = {{"schema", kSchema},
                 {"program", program.string()},
                 {"folder", folder.string()},
                 {"isa", isa},
                 {"bucketCount", bucketCount}};
    json["given"] = Json::array();
    for (const GivenOption& option : given)
        json["given"].push_back({{"name", option.name}, {"values", option.values}});
    json["frames"] = Json::array();
    for (const FarmFrame& frame : frames)
        json["frames"].push_back({{"number", frame.number ? Json(*frame.number) : Json(nullptr)},
                                  {"mergeWords", frame.mergeWords}});
    json["tasks"] = Json::array();
    for (const FarmTask& task : tasks) json["tasks"].push_back(taskJson(task));
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

FarmPlan FarmPlan::fromJson(std::string_view text, const std::filesystem::path& file) {
    const Json json = parseJson(text, file.string(), throwIfInterrupted);
    if (!json.is_object() || json.value("schema", Json()) != kSchema)
        throw HostError(ExitCode::kBadInput,
                        fmt::format("{}: is no plan of a farm, schema {}", file.string(), kSchema));
    try {
        return planOf(json);
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& fault) {
        throw HostError(ExitCode::kBadInput, fmt::format("{}: the plan can't be understood: {}",
                                                         file.string(), fault.what()));
    }
}

}  // namespace pm::host
