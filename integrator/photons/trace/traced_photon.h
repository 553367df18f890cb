// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/paths/path_class.h"
#include "integrator/paths/walk.h"
#include "integrator/photons/trace/photon_tracer.h"

namespace pm {

// What a run of photons left.
struct PhotonBatch {
    std::vector<Photon> photons;
    PhotonBalance balance;
    std::vector<Photon> descended;
    std::vector<ReceivedPhoton> received;
    std::vector<EmissionRecord> records;
    std::uint64_t metCaster = 0;
};

// A photon, or what goes on of it where it has divided; it carries its flux, W.
struct PhotonStep : PathStep {
    LongChains::Chain chain{};
    PhotonStage stage = PhotonStage::kStraight;
    bool isFollowed = true;  // of the share that carries on what descends from caustics
    // It has passed, on its way from the light, what shadow rays pass and others do not, or the
    // other way round; see TracedPhoton::passesHidden().
    bool pastShadowless = false, pastMirrorless = false;
    bool isUnmet = false;       // by delta lobes alone, from a light that no ray meets
    bool beganFrosted = false;  // by frosted glass, where it came straight from its light
    float width = 0.0f;         // of the footprint that the ray starts from, scene units
    // What corrections for shading normals have multiplied its flux by; see evenOut().
    float excess = 1.0f;
    std::uint32_t light = 0;  // where it comes from
    PhotonClass of{};         // of its light and time

    bool isVoid() const { return pastShadowless && pastMirrorless; }
    bool mayGoOnBy(Lobe lobe) const {
        if (lobe == Lobe::kStraight) return true;
        return isDelta(lobe) ? !pastShadowless : !pastMirrorless;
    }
};

// One photon's way from its light on: the policy of a walk. Threads: one.
class TracedPhoton {
  public:
    using Step = PhotonStep;
    static constexpr Transport kTransport = Transport::kPhotons;

    // All must outlive this. aim: null where nothing is aimed.
    TracedPhoton(const Scene& scene, const PhotonTraceRequest& request, const AimedEmission* aim,
                 const LongChains& chains, PhotonBatch& batch)
        : m_scene(scene), m_request(request), m_aim(aim), m_chains(chains), m_batch(batch) {}

    // Flux that landed as asked for, W, summed over the channels.
    double landed() const { return m_landed; }

    static CacheUser user(const PhotonStep&) { return CacheUser::kPhoton; }
    void setOut(PhotonStep& photon);
    void meetNothing(const PhotonStep& photon);
    Verdict meet(PhotonStep& photon, const Surface& surface);
    bool scatter(PhotonStep& photon, Surface& surface, const Bsdf& bsdf,
                 Waiting<PhotonStep>& waiting);

  private:
    // A caustic photon divides at the first of its events.
    static constexpr int kDividedEvents = 2;

    // On its way from a light, where a surface is hidden from shadow rays or from others. What a
    // shadow ray would go by, from where light is scattered to the lamp, is other than what a ray
    // by way of a mirror would; a photon goes by both until it is scattered. What is hidden from
    // shadow rays alone it meets, for rays of mirrors, and passes, for those of shadows: by
    // chance one, for both. Hidden from others alone it stops at it, but for mirrors beyond.
    bool passesHidden(PhotonStep& photon, const Surface& surface);
    static float probabilityOfAll(const Bsdf& bsdf);
    static bool isDiffuseOrStraight(const Bsdf& bsdf);

    // By one lobe, or by none. False: it ends here.
    bool goOn(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
              Waiting<PhotonStep>& waiting);
    // Corrections for shading normals multiply a photon's flux at every event, and after a hundred
    // of them all the flux is in a few photons that most renders don't have. So where they come to
    // less than half or more than twice, none, one or more photons of the mean flux go on (a weight
    // window). How many: of a photon whose flux has become that many times what it was.
    static int evenOut(PhotonStep& photon, float factor, Rgb& flux);
    // Russian roulette of what loses nothing on its way, for all copies. False: none goes on.
    bool outlives(PhotonStep& photon, float survival, int copies);
    bool mayLeave(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                  BsdfSample& sample) const;
    bool absorb(const PhotonStep& photon);
    bool lose(const PhotonStep& photon);

    // Of what is scattered diffusely where photons are aimed at a focus far away. False: nothing
    // goes on.
    bool aimScattered(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                      BsdfSample& sample) const;

    // At glass and nothing else, on the way to a caustic.
    bool divides(const PhotonStep& photon, const Bsdf& bsdf) const;

    // The reflected part waits, the refracted one takes the place of `photon`. The smaller of both
    // goes on with the probability of its share, or a little more, the larger always, but for what
    // tinted glass absorbs. False: the refracted one does not go on.
    bool divide(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                Waiting<PhotonStep>& waiting);

    // By a lobe, with the flux that it carries on. False: the photon is not of the share that is
    // followed.
    bool advance(PhotonStep& photon, Lobe lobe, Rgb& flux) const;

    // Nothing that comes after a diffuse scattering on this way is asked for.
    bool endsAtDiffuse(const PhotonStep& photon) const;

    // The same by a broad lobe: light that comes straight from there is no caustic.
    bool endsAtBroad(const PhotonStep& photon) const;

    // Stores a photon where its way is asked for. Returns its flux if so; of light that descends
    // from caustics 0.
    double land(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf);

    // Stores a photon where a lobe that is neither diffuse nor delta receives it as a caustic.
    // Returns its flux if so.
    double receive(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf);

    // What caustics send straight to a surface, or by broad lobes, is even: the share that is
    // followed carries it.
    void landDescended(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf);

    void storeOfChain(PhotonStep& photon, const Surface& surface, const Bsdf& bsdf,
                      std::vector<Photon>& photons);

    void store(const PhotonStep& photon, const Surface& surface, const Bsdf& bsdf, const Rgb& flux,
               std::vector<Photon>& photons);

    const Scene& m_scene;
    const PhotonTraceRequest& m_request;
    const AimedEmission* m_aim;
    const LongChains& m_chains;
    PhotonBatch& m_batch;
    double m_landed = 0;
    double m_before = 0;  // what the photon carried when it set out, W, over all channels
};

}  // namespace pm
