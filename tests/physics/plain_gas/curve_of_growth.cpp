#include "tests/physics/plain_gas/curve_of_growth.h"

namespace irsig::plain {
namespace {

// 1 - ln(1 + s) / s. Below 1e-300 s has no digits left, and nothing depends on it.
Step doppler_deficit(Step s) {
  if (!(s.from > 1e-300)) return {0, s.to() > 1e-300 ? 1 - std::log1p(s.to()) / s.to() : 0};
  return constant(1) - log1p(s) / s;
}

// depth / X, of X > 0
Step fraction_of_weak_depth(Step x, Step lorentz, Step doppler) {
  const Step yc = x / (4 * lorentz + x);
  const Step z = x / (1.7 * doppler);
  const Step yd = doppler_deficit(z * z);
  const Step ratio = yd / yc;
  // Y^(-1/2), the two deficits joined
  const Step joined = yd / sqrt(constant(1) - yd * yd + ratio * ratio);
  return sqrt(constant(1) - joined);
}

}  // namespace

Step CurveOfGrowth::add(double weak_depth, double lorentz, double doppler) {
  const double before = depth_;
  // Less has lost digits to underflow, and is nobody's light.
  if (!(weak_depth > 1e-280)) return {before, 0};
  const bool first = !(weak_ > 0);
  const Step x = first ? Step{weak_depth, 0} : Step{weak_, weak_depth};
  const Step lorentz_sum =
      first ? Step{lorentz * weak_depth, 0} : Step{lorentz_, lorentz * weak_depth};
  const Step doppler_sum =
      first ? Step{doppler * weak_depth, 0} : Step{doppler_, doppler * weak_depth};
  const Step depth = x * fraction_of_weak_depth(x, lorentz_sum / x, doppler_sum / x);
  weak_ += weak_depth;
  lorentz_ += lorentz * weak_depth;
  doppler_ += doppler * weak_depth;
  const double by = first ? depth.from : depth.by;
  depth_ = before + by;
  return {before, by};
}

}  // namespace irsig::plain
