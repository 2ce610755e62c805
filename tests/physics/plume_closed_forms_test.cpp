// Rationale: homogeneous slabs, spheres and cylinders, a Gaussian plume and layers have closed
// forms from optical depths of 1e-12 to 1e4; a march and a formula that lose digits at either end
// cannot meet them. Expected: all rows to 1e-6. Slabs are voxels (kConstant: the exact field); what
// is round is given to the same marcher as a function, and as voxels it converges. Source:
// values/08_plume.csv.
#include <gmock/gmock.h>

#include <numbers>

#include "core/spectral/planck.h"
#include "tests/physics/plume_fixture.h"
#include "tests/physics/reference_table.h"

namespace irsig {
namespace {

using namespace plume_fixture;
constexpr double kPressurePa = 101325, kR = 8.31446261815324;

double b_mwir(double t) { return planck_band_radiance_w_m2_sr(3, 5, t); }
double unity(double) { return 1; }

// Mole fraction 0.1 of CO2 at that temperature, [mol/m3].
double density(double t) { return 0.1 * kPressurePa / (kR * t); }

std::function<GasSums(double)> constant_gas(double t, double co2_mol_m3) {
  return [=](double) {
    GasSums out;
    out.amount[0] = out.weight = co2_mol_m3;
    out.weight_temperature = co2_mol_m3 * t;
    out.weight_pressure = co2_mol_m3 * kPressurePa;
    return out;
  };
}

// Absorptance of a chord of gas of so much CO2 a length, through the marcher.
GasLight chord(double length_m, double t, double m2_mol, const std::function<double(double)>& b) {
  const SegmentSteps steps{.grey = grey_co2(m2_mol)};
  SegmentBuilder builder(steps);
  if (length_m > 0) add_interval(constant_gas(t, density(t)), 7, 7 + length_m, steps, builder);
  return light(builder.take(), grey_co2(m2_mol), b);
}

// Mean over [0, 1] of f, whose structure may lie close to 1 (grazing chords): panels halved there.
double towards_one(const std::function<double(double)>& f) {
  static const Nodes nodes = legendre(20);
  double sum = 0, low = 0;
  for (int panel = 0; panel < 40; ++panel) {
    const double high = panel == 39 ? 1 : 1 - std::ldexp(1, -panel - 1);
    for (std::size_t i = 0; i < nodes.at.size(); ++i)
      sum += (high - low) * nodes.weight[i] * f(low + (high - low) * nodes.at[i]);
    low = high;
  }
  return sum;
}

// tau: along the diameter 2 R.
double sphere(double tau, double t, const std::function<double(double)>& b) {  // of pi R^2
  const double m2_mol = tau / (2 * density(t));
  return towards_one([&](double y) {
    return 2 * y * chord(2 * std::sqrt((1 - y) * (1 + y)), t, m2_mol, b).emitted;
  });
}
double cylinder(double tau, double t, const std::function<double(double)>& b) {  // of 2 R length
  const double m2_mol = tau / (2 * density(t));
  return towards_one(
      [&](double y) { return chord(2 * std::sqrt((1 - y) * (1 + y)), t, m2_mol, b).emitted; });
}

// 16 voxels of 0.25 m thick, at its temperature everywhere; 4 m from face to face.
std::shared_ptr<const PlumeField> slab_field(double t) {
  static std::map<double, std::shared_ptr<const PlumeField>> made;
  auto& field = made[t];
  if (!field)
    field = field_of(volume_of({0, -40, -40}, {15, 40, 40}, cubes(0.25),
                               [&](int, int, int) {
                                 return Gas{t, 0.1, 0.05};
                               }),
                     PlumeInterpolation::kConstant);
  return field;
}

GasLight slab(double tau, double mu, double t, const std::function<double(double)>& b,
              double background = 0) {
  const GreyAbsorption grey = grey_co2(tau / (4 * density(t)));
  const PlumeRay ray{{-3, -9.01, 0.03}, {mu, std::sqrt(1 - mu * mu), 0}, 0, 100};
  return light(march(*slab_field(t), ray, {.grey = grey}), grey, b, background);
}

double gaussian(double tau, double t) {  // side-on, a = 0.5 m, 4 m long
  constexpr double kA = 0.5;
  const double m2_mol = tau / (density(t) * kA * std::sqrt(std::numbers::pi));
  const SegmentSteps steps{.grey = grey_co2(m2_mol)};
  static const Nodes nodes = legendre(40);
  double sum = 0;
  for (std::size_t i = 0; i < nodes.at.size(); ++i) {
    const double y = 6 * kA * nodes.at[i];
    SegmentBuilder builder(steps);
    const auto gas = [&](double s) {
      return constant_gas(t, density(t) * std::exp(-(y * y + s * s) / (kA * kA)))(s);
    };
    for (int n = -60; n < 60; ++n) add_interval(gas, 0.05 * n, 0.05 * (n + 1), steps, builder);
    sum += 2 * 6 * kA * nodes.weight[i] * light(builder.take(), grey_co2(m2_mol), b_mwir).emitted;
  }
  return 4 * sum;
}

// Near layer of one temperature, far layer of another.
double two_layers(double near_tau, double near_k, double far_tau, double far_k) {
  const double depth[] = {near_tau, far_tau};
  const SegmentSource source[] = {{b_mwir(near_k), 0}, {b_mwir(far_k), 0}};
  return light_through(depth, source).emitted;
}

double value_of(const std::string& name, double tau) {
  const auto has = [&](const char* text) { return name.find(text) != std::string::npos; };
  if (has("normal emissivity")) return slab(tau, 1, 900, unity).emitted;
  if (has("viewed at mu=0.5")) return slab(tau, 0.5, 900, unity).emitted;
  if (has("homogeneous gray sphere")) return sphere(tau, 900, unity);
  if (has("uniform-density cylinder")) return cylinder(tau, 900, unity);
  if (has("sphere thin limit")) return sphere(1e-12, 900, unity);
  if (has("cylinder thin limit")) return cylinder(1e-12, 900, unity);
  if (has("gray gas sphere")) return std::numbers::pi * sphere(tau, 1500, b_mwir);
  if (has("gaussian plume")) return gaussian(tau, 900);
  if (has("tau=1 T=1500")) return two_layers(0.5, 600, 1, 1500);
  if (has("tau=10 T=1500")) return two_layers(2, 600, 10, 1500);
  if (has("contrast radiance")) return slab(tau, 1, 900, b_mwir, b_mwir(300)).contrast;
  if (has("300 K blackbody")) {
    const GasLight out = slab(tau, 1, 900, b_mwir);
    return out.emitted + out.transmittance * b_mwir(300);
  }
  if (has("source linear in path")) {
    const double depth[] = {tau};
    const SegmentSource source[] = {
        {0.5 * (b_mwir(600) + b_mwir(1200)), b_mwir(600) - b_mwir(1200)}};
    return light_through(depth, source).emitted;
  }
  throw std::runtime_error("no such case: " + name);
}

TEST(PlumeClosedForms, AllRowsOfTheTable) {
  const ReferenceTable table("08_plume.csv");
  ASSERT_GE(table.size(), 60U);
  for (std::size_t row = 0; row < table.size(); ++row) {
    const std::string name = table.text(row, "description");
    const double tau = table.text(row, "tau") == "-" ? 0 : table.number(row, "tau");
    const double expected = table.number(row, "value");
    EXPECT_NEAR(value_of(name, tau), expected, 1e-6 * expected)
        << table.text(row, "case") << " " << name << " at " << tau;
  }
}

// Series and closed form of a linear source meet, and keep their digits.
TEST(PlumeClosedForms, LinearSourceFromThinToThick) {
  for (const double tau : {1e-300, 1e-12, 1e-6}) {
    EXPECT_NEAR(linear_source_fraction(tau), -tau * tau / 12 * (1 - tau / 2), 1e-12 * tau * tau);
  }
  EXPECT_NEAR(linear_source_fraction(0.7), linear_source_fraction(std::nextafter(0.7, 1)), 1e-16);
  EXPECT_NEAR(linear_source_fraction(1), 0.5 - 1.5 / std::numbers::e, 1e-15);
  EXPECT_NEAR(linear_source_fraction(1e4), 1e-4 - 0.5, 1e-15);
  EXPECT_EQ(linear_source_fraction(0), 0);
}

// Voxels of a sphere: the share of 6^3 points inside. What a picture of it sends, against 8.4.
double voxel_sphere_error(double size_m, PlumeInterpolation interpolation) {
  constexpr double kTau = 1, kT = 900;
  const int reach = static_cast<int>(std::ceil(1 / size_m)) + 1;
  const auto gas = [&](int i, int j, int k) {
    constexpr int points = 6;
    int in = 0;
    for (int n = 0; n < points * points * points; ++n) {
      const auto at = [&](int c, int m) { return size_m * (c + (m + 0.5) / points - 0.5); };
      const double x = at(i, n % points), y = at(j, n / points % points),
                   z = at(k, n / points / points);
      in += x * x + y * y + z * z < 1;
    }
    return Gas{kT, 0.1 * in / (points * points * points), 0};
  };
  const auto field =
      field_of(volume_of({-reach, -reach, -reach}, {reach, reach, reach}, cubes(size_m), gas),
               interpolation);
  const GreyAbsorption grey = grey_co2(kTau / (2 * density(kT)));
  constexpr int kRays = 120;
  double sum = 0;
  for (int i = 0; i < kRays; ++i)
    for (int j = 0; j < kRays; ++j) {
      const double y = 2.4 * ((i + 0.5) / kRays - 0.5), z = 2.4 * ((j + 0.5) / kRays - 0.5);
      // Aslant, so that rays meet voxels in many ways.
      const Vec<Body> to = normalized(Vec<Body>{1, 0.3, 0.2});
      const Vec<Body> up = normalized(cross(to, Vec<Body>{0, 0, 1})), side = cross(to, up);
      const PlumeRay ray{y * up + z * side - 5.0 * to, to, 0, 10};
      sum += light(march(*field, ray, {.grey = grey}), grey, unity).emitted;
    }
  return std::abs(sum * 2.4 * 2.4 / (kRays * kRays) / std::numbers::pi / 0.47151776468576929 - 1);
}

TEST(PlumeClosedForms, SphereOfVoxelsConverges) {
  using enum PlumeInterpolation;
  // The rim, where chords fall as the root of the distance, is smeared over a voxel: order 1.5.
  double before[2] = {};
  for (const double size_m : {0.2, 0.1, 0.05})
    for (const PlumeInterpolation interpolation : {kLinear, kConstant}) {
      const double error = voxel_sphere_error(size_m, interpolation);
      EXPECT_LT(error, 0.27 * std::pow(size_m, 1.5)) << size_m;
      double& coarse = before[interpolation == kLinear ? 0 : 1];
      EXPECT_LT(error, coarse == 0 ? 1 : coarse / 2.5) << size_m;
      coarse = error;
    }
}

}  // namespace
}  // namespace irsig
