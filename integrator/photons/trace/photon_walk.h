// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/sampling/event_count.h"
#include "integrator/sampling/sampler.h"

namespace pm {

// The way of each photon of a request, from its light on. Threads: trace() from any, at once, each
// with a batch of its own.
class PhotonWalk {
  public:
    // What a run of photons left.
    struct Batch {
        std::vector<Photon> photons;
        PhotonBalance balance;
        std::vector<Photon> descended;
        std::vector<ReceivedPhoton> received;
        std::vector<EmissionRecord> records;
        std::uint64_t metCaster = 0;
    };

    // All must outlive this; request.count > 0.
    PhotonWalk(const Scene& scene, const LightSampler& lights, const PhotonTraceRequest& request)
        : m_scene(scene),
          m_lights(lights),
          m_request(request),
          m_aim(request.aim && !request.aim->empty() ? request.aim : nullptr),
          m_chains(request.oneInChains, request.count,
                   isCaustic(request.kind) ? request.descent : 1.0f,
                   combineBits(combineBits(request.seed, request.pass),
                               static_cast<std::uint64_t>(request.kind))),
          m_scale(1.0f / static_cast<float>(request.count)) {}

    // Photon `index` of the request, added to the batch.
    void trace(std::uint64_t index, Batch& batch) const;
    // The ray on which it leaves its light; nothing where none does.
    std::optional<Ray> firstRay(std::uint64_t index) const;

  private:
    // A caustic photon divides at the first of its events.
    static constexpr int kDividedEvents = 2;

    Sampler samplerOf(std::uint64_t index) const;
    bool emit(Sampler& sampler, AimedPhoton& photon) const;

    // How far a photon has come.
    enum class Stage : std::uint8_t {
        kStraight,   // by no lobe yet, or straight on, which is as if nothing were there
        kSpecular,   // no diffuse surface yet, but other lobes, the first one not broad
        kDiffuse,    // scattered diffusely, or broadly, at first where it came straight from the
                     // light
        kDescended,  // diffusely where it came by way of other lobes
        kBroadened,  // the same, and on by broad lobes
        kRefocused,  // descended, and on by other lobes before it met another diffuse surface
        kLater,      // descended, and has met another since
    };
    struct Way {
        Stage stage = Stage::kStraight;
        bool isFollowed = true;  // of the share that carries on what descends from caustics
        // It has passed, on its way from the light, what shadow rays pass and others do not, or the
        // other way round; see passesHidden().
        bool pastShadowless = false, pastMirrorless = false;
        bool isUnmet = false;  // by delta lobes alone, from a light that no ray meets

        bool isVoid() const { return pastShadowless && pastMirrorless; }
        bool mayGoOnBy(Lobe lobe) const {
            if (lobe == Lobe::kStraight) return true;
            return isDelta(lobe) ? !pastShadowless : !pastMirrorless;
        }
    };

    // A photon, or what goes on of it where it has divided.
    struct Part {
        Ray ray;
        Rgb flux;
        LongChains::Chain chain{};
        Way way{};
        EventCount events{};
        float width = 0.0f;  // of the footprint that the ray starts from, scene units
        PhotonClass of{};    // of its light and time
    };
    // Parts of one photon that wait to be followed.
    struct Waiting {
        std::array<Part, kDividedEvents + 1> parts;
        std::size_t count = 0;
    };

    // Returns the flux that landed as asked for, W, summed over the channels.
    double walk(const EmittedPhoton& photon, std::uint32_t index, Sampler& sampler,
                Batch& batch) const;
    double walk(Part part, Sampler& sampler, Waiting& waiting, Batch& batch) const;

    // On its way from a light, where a surface is hidden from shadow rays or from others. What a
    // shadow ray would go by, from where light is scattered to the lamp, is other than what a ray
    // by way of a mirror would; a photon goes by both until it is scattered. What is hidden from
    // shadow rays alone it meets, for rays of mirrors, and passes, for those of shadows: by
    // chance one, for both. Hidden from others alone it stops at it, but for mirrors beyond.
    bool passesHidden(Part& part, const Surface& surface, Sampler& sampler,
                      PhotonBalance& balance) const;
    static float probabilityOfAll(const Bsdf& bsdf);
    static bool isDiffuseOrStraight(const Bsdf& bsdf);

    // Of what is scattered diffusely where photons are aimed at a focus far away. False: nothing
    // goes on.
    bool aimScattered(const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                      BsdfSample& sample) const;

    // At glass and nothing else, on the way to a caustic.
    bool divides(const Part& part, const Bsdf& bsdf) const;

    // The reflected part waits, the refracted one takes the place of `part`. The smaller of both
    // goes on with the probability of its share, or a little more, the larger always, but for what
    // tinted glass absorbs. False: the refracted one does not go on.
    static bool divide(Part& part, const Surface& surface, const Bsdf& bsdf, Vec2f u,
                       Waiting& waiting, PhotonBalance& balance);

    // By a lobe, with the flux that it carries on. False: the photon is not of the share that is
    // followed.
    bool advance(Part& part, Lobe lobe, Sampler& sampler, Rgb& flux) const;

    // Nothing that comes after a diffuse scattering on this way is asked for.
    bool endsAtDiffuse(const Way& way) const;

    // The same by a broad lobe: light that comes straight from there is no caustic.
    bool endsAtBroad(const Way& way) const;

    // Stores a photon where its way is asked for. Returns its flux if so; of light that descends
    // from caustics 0.
    double land(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                Batch& batch) const;

    // Stores a photon where a lobe that is neither diffuse nor delta receives it as a caustic.
    // Returns its flux if so.
    static double receive(const Part& part, const Surface& surface, const Bsdf& bsdf, Batch& batch);

    // What caustics send straight to a surface, or by broad lobes, is even: the share that is
    // followed carries it.
    void landDescended(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                       Batch& batch) const;

    void storeOfChain(Part& part, const Surface& surface, const Bsdf& bsdf, Sampler& sampler,
                      Batch& batch, std::vector<Photon>& photons) const;

    static void store(const Part& part, const Surface& surface, const Bsdf& bsdf, const Rgb& flux,
                      Batch& batch, std::vector<Photon>& photons);

    const Scene& m_scene;
    const LightSampler& m_lights;
    const PhotonTraceRequest& m_request;
    const AimedEmission* m_aim;
    LongChains m_chains;
    float m_scale;
};

}  // namespace pm
