// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/photon_integrator.h"

#include "integrator/transport/photon/photon_path.h"

namespace pm {

SampleRadiance PhotonIntegrator::sample(const View& view, const Sampler& sampler,
                                        NearestPhotons& scratch) const {
    PhotonPath path(m_scene, m_lights, m_maps, m_lampSamples, view, scratch);
    PhotonBranch first(view.ray, view.footprint, sampler);
    first.last.direction = view.ray.direction;
    first.lampSamples = m_lampSamples;
    walk(m_scene, path, first);
    return path.result();
}

}  // namespace pm
