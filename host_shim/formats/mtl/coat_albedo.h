// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm::host {

// The exponent of a Phong lobe about the mirror direction that is as wide as a coat of microfacets
// (GGX, alpha = roughness^2). roughness: [0, 1].
double exponentOfRoughness(double roughness);

// What such a coat, of a dielectric that reflects f0 at normal incidence, reflects of light that
// comes evenly from everywhere. f0: [0, .11]; within .004.
double meanOfCoat(double f0, double roughness);

// The same of that Phong lobe with reflectance 1 at normal incidence.
double meanOfLobe(double roughness);

}  // namespace pm::host
