#pragma once

namespace irsig {

// Returns the Fresnel reflectance of unpolarised light at a plane interface between vacuum and n +
// ik.
//   cos_theta  cosine of the angle of incidence, [0, 1]
// Exact for complex indices [born_wolf1999, 14.2]; Schlick's form is F0 + (1 - F0)(1 - cos)^5
// [schlick1994] with F0 = |(n + ik - 1)/(n + ik + 1)|^2.
[[nodiscard]] double fresnel_exact(double cos_theta, double n, double k);
[[nodiscard]] double fresnel_schlick(double cos_theta, double n, double k);

}  // namespace irsig
