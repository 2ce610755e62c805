// Rationale: the march must be the integral of the field that is documented, not of a neighbour of
// it. Expected: against an integrator of other means (dense arrays, uniform steps, no tree, no
// segments) 1e-4; its stated error (coarser segments) holds; voxels turned or moved change a smooth
// plume's signature within what the voxels' size explains. Source: the definition of the
// interpolation (core/plume/plume_grids.h), integrated in 40 000 steps.
#include <gmock/gmock.h>

#include <random>

#include "core/plume/march.h"
#include "core/spectral/planck.h"
#include "tests/physics/plume_fixture.h"

namespace irsig {
namespace {

using namespace plume_fixture;
constexpr double kMarchPressurePa = 101325, kMarchR = 8.31446261815324;

double b_43(double t) { return planck_radiance_w_m2_sr_um(4.3, t); }
double b_10(double t) { return planck_radiance_w_m2_sr_um(10, t); }

// Voxels 0 .. size-1 of each axis, some of them empty; values as floats, as a file has them.
struct DenseField {
  int size;
  std::vector<Gas> voxel;

  [[nodiscard]] Gas at(int i, int j, int k) const {
    if (i < 0 || j < 0 || k < 0 || i >= size || j >= size || k >= size) return {};
    return voxel[static_cast<std::size_t>((i * size + j) * size + k)];
  }
};

// Smooth temperatures with noise, gas and holes.
DenseField random_field(unsigned seed, double noise) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  DenseField out{20, {}};
  const double phase = 6 * uniform();
  for (int i = 0; i < out.size; ++i)
    for (int j = 0; j < out.size; ++j)
      for (int k = 0; k < out.size; ++k) {
        Gas g{};
        if (uniform() > 0.1) {
          const double wave = std::sin(0.5 * i + phase) * std::cos(0.4 * j) * std::sin(0.3 * k + 1);
          g.temperature_k =
              static_cast<float>(900 * std::exp(0.6 * wave + noise * (uniform() - 0.5)));
          g.co2 = static_cast<float>(0.02 + 0.1 * uniform());
          g.h2o = static_cast<float>(0.1 * uniform());
        }
        out.voxel.push_back(g);
      }
  return out;
}

struct Point {
  double co2 = 0, h2o = 0, temperature_k = 0;  // mol/m3, K
};

// Returns the value at index coordinates, by the definition.
Point linear_at(const DenseField& field, double x, double y, double z) {
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y)),
            k = static_cast<int>(std::floor(z));
  Point out;
  double weight = 0, heat = 0;
  for (int n = 0; n < 8; ++n) {
    const int a = i + (n & 1), b = j + (n >> 1 & 1), c = k + (n >> 2);
    const Gas g = field.at(a, b, c);
    if (!(g.co2 > 0)) continue;
    const double w = (1 - std::abs(x - a)) * (1 - std::abs(y - b)) * (1 - std::abs(z - c));
    const double all = kMarchPressurePa / (kMarchR * g.temperature_k);
    out.co2 += w * g.co2 * all;
    out.h2o += w * g.h2o * all;
    weight += w * (g.co2 + g.h2o) * all;
    heat += w * (g.co2 + g.h2o) * all * g.temperature_k;
  }
  out.temperature_k = weight > 0 ? heat / weight : 300;
  return out;
}
Point constant_at(const DenseField& field, double x, double y, double z) {
  const Gas g =
      field.at(static_cast<int>(std::floor(x + 0.5)), static_cast<int>(std::floor(y + 0.5)),
               static_cast<int>(std::floor(z + 0.5)));
  if (!(g.co2 > 0)) return {0, 0, 300};
  const double all = kMarchPressurePa / (kMarchR * g.temperature_k);
  return {g.co2 * all, g.h2o * all, g.temperature_k};
}

struct Band {
  double co2_m2_mol, h2o_m2_mol;
  double (*blackbody)(double);
};

// Emitted radiance in uniform steps, the gas of a step taken at its middle.
double reference(const DenseField& field, const PlumeRay& ray, const Band& band, double size_m,
                 Point (*gas_at)(const DenseField&, double, double, double)) {
  constexpr int kSteps = 40000;
  const double step = (ray.end_m - ray.start_m) / kSteps;
  double in_front = 0, out = 0;
  for (int n = 0; n < kSteps; ++n) {
    const Vec<Body> p = ray.origin + (ray.start_m + (n + 0.5) * step) * ray.direction;
    const Point g = gas_at(field, p.x / size_m, p.y / size_m, p.z / size_m);
    const double tau = step * (band.co2_m2_mol * g.co2 + band.h2o_m2_mol * g.h2o);
    if (tau > 0) out += std::exp(-in_front) * -std::expm1(-tau) * band.blackbody(g.temperature_k);
    in_front += tau;
  }
  return out;
}

GreyAbsorption grey(const Band& band) { return {{band.co2_m2_mol, band.h2o_m2_mol, 0, 0}}; }

PlumeRay random_ray(std::mt19937& random, double extent_m) {
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const Vec<Body> from{extent_m * (3 * uniform() - 1), extent_m * (3 * uniform() - 1),
                       -2 * extent_m};
  const Vec<Body> to{extent_m * uniform(), extent_m * uniform(), extent_m * uniform()};
  return {from, normalized(to - from), 0, 6 * extent_m};
}

// Returns the closed form for voxels that are homogeneous, from face to face.
double exact_constant(const DenseField& field, const PlumeRay& ray, const Band& band,
                      double size_m) {
  std::vector<double> at{ray.start_m, ray.end_m};
  const double from[] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const double step[] = {ray.direction.x, ray.direction.y, ray.direction.z};
  for (int a = 0; a < 3; ++a)
    for (int face = 0; face <= field.size; ++face) {
      const double t = (size_m * (face - 0.5) - from[a]) / step[a];
      if (t > ray.start_m && t < ray.end_m) at.push_back(t);
    }
  std::sort(at.begin(), at.end());
  double in_front = 0, out = 0;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const Vec<Body> p = ray.origin + 0.5 * (at[i] + at[i + 1]) * ray.direction;
    const Point g = constant_at(field, p.x / size_m, p.y / size_m, p.z / size_m);
    const double tau = (at[i + 1] - at[i]) * (band.co2_m2_mol * g.co2 + band.h2o_m2_mol * g.h2o);
    out += std::exp(-in_front) * -std::expm1(-tau) * band.blackbody(g.temperature_k);
    in_front += tau;
  }
  return out;
}

struct Worst {
  double error = 0, beyond_stated = 0, rms_of_stated = 0;  // relative; error / stated error
  double segments = 0;                                     // mean
};

// Over rays and bands from thin to thick.
Worst compare(PlumeInterpolation interpolation, double noise, const SegmentSteps& how) {
  // The floor is the error of the reference and of floats. In steps between voxels it includes
  // shares that change with the temperature, whose error is not estimated.
  const double floor = interpolation == PlumeInterpolation::kLinear ? 3e-6 : 3e-5;
  const double size_m = 0.25;
  Worst out;
  int count = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DenseField dense = random_field(seed, noise);
    const auto field = field_of(volume_of({0, 0, 0}, {19, 19, 19}, cubes(size_m),
                                          [&](int i, int j, int k) { return dense.at(i, j, k); }),
                                interpolation);
    std::mt19937 random(seed);
    for (int n = 0; n < 8; ++n) {
      const PlumeRay ray = random_ray(random, 5);
      for (const double m2_mol : {1e-4, 0.1, 1.0, 10.0}) {
        const Band band{m2_mol, 0.3 * m2_mol, n % 2 == 0 ? b_43 : b_10};
        const double expected = interpolation == PlumeInterpolation::kLinear
                                    ? reference(dense, ray, band, size_m, linear_at)
                                    : exact_constant(dense, ray, band, size_m);
        if (expected == 0) continue;
        SegmentSteps steps = how;
        steps.grey = grey(band);
        const auto segments = march(*field, ray, steps);
        const double got = light(segments, grey(band), band.blackbody).emitted;
        const double stated = stated_error(segments, grey(band), band.blackbody);
        const double error = std::abs(got - expected);
        out.error = std::max(out.error, error / expected);
        const double of_stated = std::max(0.0, error - floor * expected) / stated;
        if (of_stated > 0) out.beyond_stated = std::max(out.beyond_stated, of_stated);
        if (of_stated > 0) out.rms_of_stated += of_stated * of_stated;
        out.segments += static_cast<double>(segments.size());
        ++count;
      }
    }
  }
  out.segments /= count;
  out.rms_of_stated = std::sqrt(out.rms_of_stated / count);
  return out;
}

void expect_good(const Worst& worst) {
  EXPECT_LT(worst.error, 1e-4);
  EXPECT_LT(worst.rms_of_stated, 1);
  EXPECT_LT(worst.beyond_stated, 5);
  std::printf("worst %.2e; of stated: worst %.2f, rms %.2f; %.1f segments\n", worst.error,
              worst.beyond_stated, worst.rms_of_stated, worst.segments);
}

TEST(PlumeMarch, IsTheIntegralOfTheLinearField) {
  expect_good(compare(PlumeInterpolation::kLinear, 0, {}));
  expect_good(compare(PlumeInterpolation::kLinear, 0.5, {}));
}

TEST(PlumeMarch, IsTheIntegralOfTheConstantField) {
  expect_good(compare(PlumeInterpolation::kConstant, 0, {}));
  // No segments are merged: the result is exact.
  const Worst exact = compare(PlumeInterpolation::kConstant, 0.5, {.temperature_step = 0});
  EXPECT_LT(exact.error, 1e-6);
}

// Symmetric about the middle of the ray, so that two segments merge into one of the same mean and
// spread: the error is stated all the same.
TEST(PlumeMarch, SymmetricCoursesHaveAStatedError) {
  const auto gas = [](double s) {
    GasSums out;
    out.amount[0] = out.weight = std::exp(-s * s);
    out.weight_temperature = out.weight * (300 + 350 * std::exp(-s * s));
    out.weight_pressure = out.weight * kMarchPressurePa;
    return out;
  };
  for (const double step : {0.1, 0.2, 0.4, 1.0}) {
    const auto emitted = [&](double temperature_step) {
      SegmentSteps steps;
      steps.temperature_step = temperature_step;
      SegmentBuilder builder(steps);
      for (int n = -40; n < 40; ++n) add_interval(gas, 0.1 * n, 0.1 * (n + 1), steps, builder);
      return builder.take();
    };
    const GreyAbsorption thin = grey_co2(1e-3);
    const double exact = light(emitted(0.001), thin, b_43).emitted;
    const auto segments = emitted(step);
    const double error = std::abs(light(segments, thin, b_43).emitted - exact);
    const double stated = stated_error(segments, thin, b_43);
    EXPECT_LT(error, 2 * stated) << step;
    EXPECT_LT(stated, 0.25 * exact) << step;
  }
}

// A smooth plume along x, sampled on a lattice that is turned about z and moved.
std::shared_ptr<const PlumeField> smooth_plume(double size_m, double turned_deg, double moved,
                                               PlumeInterpolation interpolation,
                                               std::int32_t far = 0) {
  const double c = std::cos(turned_deg * M_PI / 180), s = std::sin(turned_deg * M_PI / 180);
  std::array<double, 12> lattice{size_m * c, -size_m * s, 0, 0, size_m * s, size_m * c,
                                 0,          0,           0, 0, size_m,     0};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t col = 0; col < 3; ++col) lattice[4 * r + 3] += moved * lattice[4 * r + col];
  // Far indices of the same places.
  auto shifted = lattice;
  for (std::size_t r = 0; r < 3; ++r)
    shifted[4 * r + 3] -= far * (lattice[4 * r] + lattice[4 * r + 1] + lattice[4 * r + 2]);
  const int n = static_cast<int>(std::ceil(4.5 / size_m));
  const auto gas = [&](int i, int j, int k) {
    i -= far, j -= far, k -= far;
    const double x = lattice[0] * i + lattice[1] * j + lattice[2] * k + lattice[3];
    const double y = lattice[4] * i + lattice[5] * j + lattice[6] * k + lattice[7];
    const double z = lattice[8] * i + lattice[9] * j + lattice[10] * k + lattice[11];
    const double f = std::exp(-(x * x / 4 + y * y / 1.5 + z * z));
    return f < 1e-4 ? Gas{} : Gas{290 + 400 * f, 0.1 * f, 0.08 * f};
  };
  return field_of(volume_of({far - n, far - n, far - n}, {far + n, far + n, far + n}, shifted, gas),
                  interpolation);
}

double picture(const PlumeField& field, double m2_mol) {
  const GreyAbsorption grey{{m2_mol, 0.3 * m2_mol, 0, 0}};
  SegmentSteps steps;
  steps.grey = grey;
  steps.temperature_step = 0.05;
  const Vec<Body> to = normalized(Vec<Body>{0.2, 1, 0.35});
  const Vec<Body> up = normalized(cross(to, Vec<Body>{1, 0, 0})), side = cross(to, up);
  double sum = 0;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j) {
      const Vec<Body> at = (0.2 * (i - 24.5)) * side + (0.2 * (j - 24.5)) * up - 20.0 * to;
      sum += light(march(field, {at, to, 0, 40}, steps), grey, b_43).emitted;
    }
  return sum;
}

// Second order in the voxels' size: 0.5 h^2 (h in widths of the plume, 1 m), whatever their place;
// which place, and that they are turned by 17 degrees, changes 1e-3 at most.
TEST(PlumeMarch, VoxelsTurnedAndMovedChangeLittle) {
  using enum PlumeInterpolation;
  for (const double m2_mol : {1e-3, 1.0}) {
    const double fine = (4 * picture(*smooth_plume(0.0625, 0, 0, kLinear), m2_mol) -
                         picture(*smooth_plume(0.125, 0, 0, kLinear), m2_mol)) /
                        3;
    for (const PlumeInterpolation interpolation : {kLinear, kConstant})
      for (const double size_m : {0.25, 0.125}) {
        const double as_is = picture(*smooth_plume(size_m, 0, 0, interpolation), m2_mol);
        const double moved = picture(*smooth_plume(size_m, 0, 0.5, interpolation), m2_mol);
        const double turned = picture(*smooth_plume(size_m, 17, 0, interpolation), m2_mol);
        EXPECT_NEAR(as_is / fine, 1, 0.5 * size_m * size_m) << m2_mol << " " << size_m;
        EXPECT_NEAR(moved / as_is, 1, 1e-3) << m2_mol << " " << size_m;
        EXPECT_NEAR(turned / as_is, 1, 1e-3) << m2_mol << " " << size_m;
      }
  }
}

// Segment by segment the same gas at a million voxels from the lattice's origin, and from 50 km
// away.
TEST(PlumeMarch, FarFromTheOrigin) {
  const auto near = smooth_plume(0.125, 17, 0, PlumeInterpolation::kLinear);
  const auto far = smooth_plume(0.125, 17, 0, PlumeInterpolation::kLinear, 1'000'000);
  const Vec<Body> to = normalized(Vec<Body>{0.2, 1, 0.35});
  for (const double from_m : {20.0, 50'000.0}) {
    const PlumeRay ray{Vec<Body>{0.3, 0.1, -0.2} - from_m * to, to, 0, 2 * from_m};
    const auto expected = march(*near, {Vec<Body>{0.3, 0.1, -0.2} - 20.0 * to, to, 0, 40}, {});
    const auto got = march(*far, ray, {});
    ASSERT_GT(expected.size(), 20U);
    double amount[2] = {}, heat[2] = {};
    for (int which = 0; which < 2; ++which)
      for (const GasSegment& s : which == 0 ? expected : got) {
        amount[which] += s.amount[0];
        heat[which] += s.weight * s.temperature_k;
      }
    EXPECT_NEAR(amount[1], amount[0], 1e-8 * amount[0]) << from_m;
    EXPECT_NEAR(heat[1], heat[0], 1e-8 * heat[0]);
    EXPECT_NEAR(got.front().start_m - from_m, expected.front().start_m - 20, 1e-6);
  }
}

// Pieces that are appended keep amounts, mean, change, spread and skew as merging their segments
// does, whatever temperatures they count from.
TEST(GasPiece, AppendsAsSegmentsMerge) {
  std::mt19937 random(7);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const auto point = [&](double kelvin) {
    const double mol = 0.1 + uniform();
    return GasPoint({mol, mol * kelvin, mol * 1e5, {0.3 * mol, 0.5 * mol, 0.2 * mol, 0}});
  };
  for (int n = 0; n < 100; ++n) {
    std::array<GasPoint, 5> at;
    for (GasPoint& p : at) p = point(600 + 800 * uniform());
    GasPiece a = GasPiece::between(1, at[0], at[1], 2, at[2]);
    const GasPiece b = GasPiece::between(2, at[2], at[3], 2.5, at[4]);
    const GasSegment expected = merged(a.segment(), b.segment());
    a.append(b);
    const GasSegment found = a.segment();
    EXPECT_NEAR(found.weight, expected.weight, 1e-12 * expected.weight);
    EXPECT_NEAR(found.temperature_k, expected.temperature_k, 1e-9);
    EXPECT_NEAR(found.temperature_change_k, expected.temperature_change_k, 1e-8);
    EXPECT_NEAR(found.temperature_spread_k, expected.temperature_spread_k, 1e-8);
    EXPECT_NEAR(found.temperature_skew_k3, expected.temperature_skew_k3, 1e-3);
  }
}

// Rationale: what absorbs must be as hot as the rest of its segment.
// Expected: gas of another composition is a segment of its own if it is hotter, too, whether the
// share of one species changes most by falling or by rising.
TEST(GasPiece, HotterGasOfAnotherCompositionIsNotAppended) {
  using Shares = std::array<double, kPlumeSpecies>;
  const auto piece = [](double start_m, double kelvin, const Shares& shares) {
    const GasPoint p({1, kelvin, 1e5, shares});
    return GasPiece::between(start_m, p, p, start_m + 1, p);
  };
  const auto segments_of = [&](double second_k, const Shares& first, const Shares& second) {
    const SegmentSteps steps;  // shares may change by 0.02 where the temperature does by 1 %
    SegmentBuilder builder(steps);
    builder.add(piece(0, 700, first));
    builder.add(piece(1, second_k, second));
    return builder.take().size();
  };
  const Shares one = {0.6, 0.2, 0.2, 0}, near = {0.59, 0.205, 0.205, 0},
               other = {0.57, 0.215, 0.215, 0};
  EXPECT_EQ(segments_of(707, one, near), 1U);
  EXPECT_EQ(segments_of(700, one, other), 1U);
  EXPECT_EQ(segments_of(707, one, other), 2U);
  EXPECT_EQ(segments_of(707, other, one), 2U);
}

}  // namespace
}  // namespace irsig
