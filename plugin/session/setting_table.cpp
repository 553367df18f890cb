// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/setting_table.h"

#include <array>
#include <limits>

#include "plugin/values/named_table.h"

namespace pm::plugin {

namespace {

constexpr std::int64_t kMaxInteger = std::numeric_limits<std::int64_t>::max();

constexpr std::array<SettingSpec, kSettingCount> kSettings = {{
    {Setting::kWidth, "width", SettingType::kInteger, "pixels", "640", 1, kMaxFramePixels, 1, "",
     true, "Width of the frame.", "Time and memory grow with width x height."},
    {Setting::kHeight, "height", SettingType::kInteger, "pixels", "480", 1, kMaxFramePixels, 1, "",
     true, "Height of the frame.", "Time and memory grow with width x height."},
    {Setting::kCrop, "crop", SettingType::kText, "pixels", "", 0, 0, 1, "", false,
     "Pixels to render, x0,y0,x1,y1 (half-open, origin top left); may exceed the frame; empty = "
     "the "
     "frame. A pixel has the same value in any crop.",
     "Only the crop's pixels cost time and memory; photons cost the same."},
    {Setting::kThreads, "threads", SettingType::kInteger, "threads", "0", 0, kMaxThreads, 1, "",
     false, "Threads of this render; 0 = all that affinity and cgroup allow.",
     "Each thread needs a buffer of one bucket."},
    {Setting::kBucketSize, "bucketSize", SettingType::kInteger, "pixels", "32", 0, 1024, 8, "",
     false, "Side of a bucket, a multiple of 8; 0 = chosen from the frame's size.",
     "Small ones cost more administration, large ones more memory and reach the host later."},
    {Setting::kBucketOrder, "bucketOrder", SettingType::kChoice, "", "hilbert", 0, 0, 1,
     "hilbert,row,column,diagonal,spiral,random,correlated", false,
     "The order in which buckets are rendered; random is shuffled by the seed, correlated chooses "
     "the next bucket while rendering.",
     "Within a few per cent of each other; see docs/orders.md."},
    {Setting::kAaLevel, "aaLevel", SettingType::kInteger, "", "3", 0, 6, 1, "", true,
     "Anti-aliasing: level l takes 4^(l-1) samples a pixel in every four passes; this is the "
     "least. At 0 each 2 x 2 pixels share one, a blur for previews that the estimated error does "
     "not cover; with a higher aaLevelMost they are divided where their first two samples differ.",
     "Each level takes four times the time of the one before."},
    {Setting::kAaLevelMost, "aaLevelMost", SettingType::kInteger, "", "5", 0, 6, 1, "", true,
     "The most that a pixel gets whose samples differ, from the second pass on; aaLevel or less: "
     "every pixel gets the same.",
     "Time goes to the pixels that need it; up to 480 bytes a pixel in place of 250."},
    {Setting::kAaThreshold, "aaThreshold", SettingType::kNumber, "", "0.01", 0, 1, 1, "", true,
     "A pixel gets samples, from aaLevel to aaLevelMost, until one more in four passes would lower "
     "its squared relative error by less than this squared; from the fifth pass on, half of this. "
     "Without photons, half of either.",
     "Halved, noisy pixels get twice the samples."},
    {Setting::kFilter, "filter", SettingType::kChoice, "", "box", 0, 0, 1, "box,gaussian", true,
     "How the frame around a pixel counts in it: box, all of the pixel alike; gaussian, by a "
     "normal density around its centre with a standard deviation of 0.5 pixels, cut off at 1.5.",
     "None to speak of: samples are placed by it."},
    {Setting::kIntegrator, "integrator", SettingType::kChoice, "", "photon", 0, 0, 1, "photon,path",
     true, "photon: photon maps with final gathering; path: the unbiased path tracer, a reference.",
     "path needs no memory for maps, but many more samples where light is indirect or focused."},
    {Setting::kPhotons, "photons", SettingType::kInteger, "photons", "0", 0, 4000000000, 1, "",
     true,
     "Photons emitted in each pass for each map that the scene needs; 0 = chosen by the plan (see "
     "--explain).",
     "About 1 us of one thread and up to 64 bytes a photon."},
    {Setting::kEstimatePhotons, "estimatePhotons", SettingType::kInteger, "photons", "50", 2,
     100000, 1, "", true,
     "Photons in each density estimate: fewer are noisier, more are more blurred.",
     "Time of a look-up grows with it."},
    {Setting::kGatherRays, "gatherRays", SettingType::kInteger, "rays", "0", 0, 1024, 1, "", true,
     "Final-gather rays of each gather point; 0 = chosen by the plan (see --explain).",
     "Time grows with it where light is indirect."},
    {Setting::kPasses, "passes", SettingType::kInteger, "passes", "4", 1, 1000000, 1, "", true,
     "Passes, each with photons and samples of its own; the picture is their mean. At least 2 are "
     "needed to tell the error. With an error target or a time limit and no number given: as many "
     "as those need.",
     "Time grows with it; memory does not."},
    {Setting::kSeed, "seed", SettingType::kInteger, "", "1", 0, kMaxInteger, 1, "", true,
     "Start of all random numbers; the same seed gives the same picture.", "None."},
    {Setting::kLayers, "layers", SettingType::kText, "", "", 0, 0, 1, "", false,
     "Optional layers, separated by commas: albedo, N, Z, stderr, halfdiff, samples, aalevel.",
     "albedo and N take 24 bytes a pixel each, Z 8; stderr, halfdiff, samples and aalevel none."},
    {Setting::kMemoryLimit, "memoryLimitGib", SettingType::kNumber, "GiB", "0", 0, 1048576, 1, "",
     false,
     "A render that needs more is refused at its start, or goes bucket by bucket where the host "
     "takes that (see delivery); 0 = the cgroup's limit, else 90 % of memory.",
     "None; it never changes the picture."},
    {Setting::kErrorTarget, "errorTarget", SettingType::kNumber, "relMSE", "0", 0, 1000000, 1, "",
     false,
     "Ends the render after the first pass (from the second on) whose estimated relMSE, bias "
     "included, is no larger; 0 = none. What it has then is the picture of so many passes.",
     "Time grows with 1/target. One that is below what bias can fall to is never reached."},
    {Setting::kTimeLimit, "timeLimitSeconds", SettingType::kNumber, "s", "0", 0, 1000000000, 1, "",
     false,
     "Begins no pass that would not end by then, counted from the render's start and judged by the "
     "passes before; 0 = none. The first pass is always made, whole.",
     "Decides only how many passes there are."},
    {Setting::kPlan, "plan", SettingType::kChoice, "", "auto", 0, 0, 1, "auto,everything", true,
     "auto: the maps and estimators that the scene needs (see --explain); everything: all there "
     "are, for the same picture in more time.",
     "everything takes up to several times as long."},
    {Setting::kBuckets, "buckets", SettingType::kText, "", "", 0, 0, 1, "", false,
     "Renders only these buckets of the order: A:B, half-open, or I/N, the I-th of N runs; empty = "
     "all. Not with buckets of a size chosen by itself, the correlated order, or a target that "
     "ends the render.",
     "Of the pixels' time the buckets' share; photons cost the same."},
    {Setting::kPart, "part", SettingType::kText, "", "", 0, 0, 1, "", false,
     "File that takes the sums of the buckets when the render has ended, for createMerge.",
     "Some 250 bytes a pixel on disk."},
    {Setting::kCheckpoint, "checkpoint", SettingType::kText, "", "", 0, 0, 1, "", false,
     "File that keeps finished buckets while the render runs; it stays when the render ends.",
     "On disk up to some 700 bytes a pixel; a few per cent of the time."},
    {Setting::kResume, "resume", SettingType::kInteger, "", "0", 0, 1, 1, "", false,
     "1: go on from the checkpoint where its file is there, with more passes too; 0: begin anew.",
     "None."},
    {Setting::kHostIdentity, "hostIdentity", SettingType::kText, "", "", 0, 0, 1, "", false,
     "What of the host decides on the picture, as its colour config: lines `name: value`. "
     "Checkpoints and parts of another are refused.",
     "None."},
    {Setting::kDelivery, "delivery", SettingType::kChoice, "", "frame", 0, 0, 1,
     "frame,buckets,fit", false,
     "frame: all pixels are kept until the render is destroyed; buckets: a bucket is rendered with "
     "all its passes (8 at most, a fixed number), its pixels can be read inside its bucketFinished "
     "and are forgotten; fit: frame where that fits the memory limit, else buckets where that can "
     "be. See PMR_DELIVERY_BUCKETS.",
     "buckets holds the maps of all passes at once, and little for each pixel."},
    {Setting::kPhotonMap, "photonMap", SettingType::kText, "", "", 0, 0, 1, "", false,
     "File that photons are read from in place of being traced, for the same picture: one that "
     "photonsOnly made of the same scene, seed and numbers of photons, with any camera and no "
     "fewer passes. Empty: none.",
     "Reading takes a small part of the time of tracing."},
    {Setting::kPhotonsOnly, "photonsOnly", SettingType::kInteger, "", "0", 0, 1, 1, "", false,
     "1: traces the photons of all passes into the file photonMap and ends; there are no pixels.",
     "On disk 28 bytes a photon that landed."},
    {Setting::kHostNote, "hostNote", SettingType::kText, "", "", 0, 0, 1, "", false,
     "A line that a part keeps for the host that merges it, as how the picture is to be shown: "
     "nothing is refused for it. Of a merge, the lines of all its parts, each once.",
     "None."},
    {Setting::kPhotonPages, "photonPagesMib", SettingType::kNumber, "MiB", "0", 0, 1048576, 1, "",
     false,
     "Photon maps are kept in scratch files, in pages of which so much is in memory at once; 0 = "
     "only where they would not fit the memory limit otherwise.",
     "Time grows where pages are read again and again; on disk up to 60 bytes a photon that "
     "landed."},
    {Setting::kScratchFolder, "scratchFolder", SettingType::kText, "", "", 0, 0, 1, "", false,
     "Folder of the scratch files of photon maps that are kept in pages; they have no name there "
     "and are gone with the process. Empty: that of the environment variable TMPDIR, else /tmp.",
     "A disk of its own for them is as fast as it reads."},
    {Setting::kHostPeak, "hostPeakGib", SettingType::kNumber, "GiB", "0", 0, 1048576, 1, "", false,
     "The most memory that the process takes before the render, to read and to hand over the scene "
     "and its textures, as the host knows it. A render is refused where it is above the memory "
     "limit, and the smallest limit that is told is no less.",
     "None."},
    {Setting::kInputHashes, "inputHashes", SettingType::kInteger, "", "0", 0, 1, 1, "", false,
     "1: the statistics have, among their hashes, one of each object, material, light and texture "
     "by its name, and of the camera, so that a host can tell what of a scene has changed.",
     "The statistics grow by a line for each."},
    {Setting::kErrorScale, "errorScale", SettingType::kText, "stops", "auto", 0, 0, 1, "", true,
     "Errors are judged of values times 2^this, a whole number from -40 to 40: relMSE is the mean "
     "of (x - r)^2 / (r^2 + 0.01 * 4^-this). auto: the number that brings the log-average "
     "luminance of a pilot to 0.18, 0 where that is within -3 to 3.",
     "None; of auto a few milliseconds."},
}};

static_assert(isInOrderOfIds(kSettings));

}  // namespace

std::span<const SettingSpec, kSettingCount> settingSpecs() {
    return kSettings;
}

const SettingSpec* findSetting(std::string_view name) {
    return findByName(kSettings, name);
}

}  // namespace pm::plugin
