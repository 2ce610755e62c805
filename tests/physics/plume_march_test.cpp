// Rationale: the march must be the integral of the field that is documented, not of a neighbour of it.
// Expected: against an integrator of other means (dense arrays, uniform steps, no tree, no segments)
// 1e-4; its stated error (coarser segments) holds; voxels turned or moved change a smooth plume's
// signature within what the voxels' size explains.
// Source: the definition of the interpolation (core/plume/plume_grids.h), integrated in 40 000 steps.
#include "core/plume/march.h"

#include <gmock/gmock.h>

#include <random>

#include "core/spectral/planck.h"
#include "tests/physics/plume_fixture.h"

namespace irsig {
namespace {

using namespace plume_fixture;
constexpr double kPressurePa = 101325, kR = 8.31446261815324;

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

// At index coordinates, by the definition.
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
    const double all = kPressurePa / (kR * g.temperature_k);
    out.co2 += w * g.co2 * all;
    out.h2o += w * g.h2o * all;
    weight += w * (g.co2 + g.h2o) * all;
    heat += w * (g.co2 + g.h2o) * all * g.temperature_k;
  }
  out.temperature_k = weight > 0 ? heat / weight : 300;
  return out;
}
Point constant_at(const DenseField& field, double x, double y, double z) {
  const Gas g = field.at(static_cast<int>(std::floor(x + 0.5)), static_cast<int>(std::floor(y + 0.5)),
                         static_cast<int>(std::floor(z + 0.5)));
  if (!(g.co2 > 0)) return {0, 0, 300};
  const double all = kPressurePa / (kR * g.temperature_k);
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
    if (tau > 0)
      out += std::exp(-in_front) * -std::expm1(-tau) * band.blackbody(g.temperature_k);
    in_front += tau;
  }
  return out;
}

GreyAbsorption grey(const Band& band) { return {{band.co2_m2_mol, band.h2o_m2_mol, 0, 0}}; }

PlumeRay random_ray(std::mt19937& random, double extent_m) {
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const Vec<Body> from{extent_m * (3 * uniform() - 1), extent_m * (3 * uniform() - 1), -2 * extent_m};
  const Vec<Body> to{extent_m * uniform(), extent_m * uniform(), extent_m * uniform()};
  return {from, normalized(to - from), 0, 6 * extent_m};
}

struct Worst {
  double error = 0, beyond_stated = 0;  // relative; beyond_stated: error / stated error
  double segments = 0;                  // mean
};

// Over rays and bands from thin to thick.
Worst compare(PlumeInterpolation interpolation, double noise, const SegmentSteps& how) {
  const double size_m = 0.25;
  Worst out;
  int count = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const DenseField dense = random_field(seed, noise);
    const auto field = field_of(
        volume_of({0, 0, 0}, {19, 19, 19}, cubes(size_m),
                  [&](int i, int j, int k) { return dense.at(i, j, k); }),
        interpolation);
    std::mt19937 random(seed);
    for (int n = 0; n < 8; ++n) {
      const PlumeRay ray = random_ray(random, 5);
      for (const double m2_mol : {1e-4, 0.1, 1.0, 10.0}) {
        const Band band{m2_mol, 0.3 * m2_mol, n % 2 == 0 ? b_43 : b_10};
        const double expected = reference(
            dense, ray, band, size_m,
            interpolation == PlumeInterpolation::kLinear ? linear_at : constant_at);
        if (expected == 0) continue;
        SegmentSteps steps = how;
        steps.grey = grey(band);
        const auto segments = march(*field, ray, steps);
        const double got = light(segments, grey(band), band.blackbody).emitted;
        const double stated =
            std::abs(light(coarser(segments), grey(band), band.blackbody).emitted - got);
        const double error = std::abs(got - expected);
        out.error = std::max(out.error, error / expected);
        // The reference itself is good to 1e-6 (kLinear).
        out.beyond_stated = std::max(out.beyond_stated, (error - 3e-6 * expected) / stated);
        out.segments += static_cast<double>(segments.size());
        ++count;
      }
    }
  }
  out.segments /= count;
  return out;
}

TEST(PlumeMarch, IsTheIntegralOfTheLinearField) {
  for (const double noise : {0.0, 0.5}) {
    const Worst worst = compare(PlumeInterpolation::kLinear, noise, {});
    EXPECT_LT(worst.error, 1e-4) << noise;
    EXPECT_LT(worst.beyond_stated, 1) << noise;
    std::printf("noise %g: worst %.2e, of stated %.2f, %.1f segments\n", noise, worst.error,
                worst.beyond_stated, worst.segments);
  }
}

// Uniform steps end somewhere in a voxel: the reference is good to 2e-3.
TEST(PlumeMarch, IsTheIntegralOfTheConstantField) {
  const Worst worst = compare(PlumeInterpolation::kConstant, 0.5, {});
  EXPECT_LT(worst.error, 2e-3);
  std::printf("worst %.2e, %.1f segments\n", worst.error, worst.segments);
}

}  // namespace
}  // namespace irsig
