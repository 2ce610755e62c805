// Rationale: an implicit scheme is stable whatever it computes; only closed forms tell whether its
// fluxes, layers and faces are right, and at which rate it gets there. Expected: within 1e-3 of the
// temperature change at the default accuracy, within 1e-5 with a smaller tolerance, and the stated
// error covers the true one. Source: tests/physics/values/heat.csv.
#include <cmath>
#include <complex>
#include <map>
#include <numbers>

#include "core/base/constants.h"
#include "tests/physics/reference_table.h"
#include "tests/physics/wall_run.h"

namespace irsig {
namespace {

using namespace wall;

Layer concrete(double thickness_m) { return {thickness_m, 1.4, 2300, 880}; }
Layer steel(double thickness_m) { return {thickness_m, 50, 7850, 460}; }
Layer soil(double thickness_m) { return {thickness_m, 0.5, 1900, 1500}; }
// Returns a layer of one temperature from face to face.
Layer plate(double capacity_j_m2_k) { return {0.01, 1e9, capacity_j_m2_k / 0.01, 1}; }

constexpr double kStartK = 300;

struct Answer {
  double value, error;
};

struct Asked {
  std::string setup;
  std::string quantity;
  double x, t;
};

// A wall down to `depth_m` with a boundary at x, so that its temperature is an output.
std::vector<Layer> cut_at(const std::function<Layer(double)>& material, double x, double depth_m) {
  if (x <= 0) return {material(depth_m)};
  return {material(x), material(depth_m - x)};
}

Layer material_of(const std::string& setup, double thickness_m) {
  if (setup.ends_with("concrete")) return concrete(thickness_m);
  return setup.ends_with("steel") ? steel(thickness_m) : soil(thickness_m);
}

double depth_of(const std::string& setup, double t) {
  const Layer m = material_of(setup, 1);
  return 12 * std::sqrt(m.conductivity_w_m_k / (m.density_kg_m3 * m.specific_heat_j_kg_k) * t);
}

Answer last_of(const HeatResult& r, std::size_t boundary) {
  const std::size_t i = r.at(r.temperature_k.size() / r.boundaries - 1, boundary, 0);
  return {r.temperature_k[i], r.error_k[i]};
}

// Rises in a wall under a constant exposure.
Answer rise(const Asked& a, HeatAccuracy accuracy) {
  const auto material = [&](double d) { return material_of(a.setup, d); };
  const bool slab = a.setup.starts_with("slab");
  std::vector<Layer> layers = cut_at(material, a.x, slab ? 0.1 : a.x + depth_of(a.setup, a.t));
  Weather outer, inner;
  InnerSide side = InnerSide::kAdiabatic;
  std::size_t boundary = a.x > 0 ? 1 : 0;
  if (a.setup.starts_with("flux") || slab) outer.absorbed_w_m2 = a.setup == "flux_soil" ? 300 : 500;
  if (a.setup.starts_with("air")) outer.forced_h_w_m2_k = 15;
  outer.fluid_k = kStartK + 20;
  if (a.setup.starts_with("step")) {  // from the inner side
    std::ranges::reverse(layers);
    side = InnerSide::kFixedTemperature;
    inner.fluid_k = kStartK + 20;
  }
  HeatRequest request = request_of(layers, side, kStartK, {0, a.t}, accuracy);
  const Answer at = last_of(
      solved(request, continuous(request.knot_s, constant(outer), constant(inner))), boundary);
  return {at.value - kStartK, at.error};
}

// The settled wave under a flux of 400 cos(w t), at all depths of the table: complex amplitudes,
// each with the largest error of its temperatures.
struct Wave {
  std::map<double, std::complex<double>> amplitude_k;
  double error_k = 0;
};

// The wave as seen at `knots` times a period under a forcing that is linear between them, over that
// under the cosine: its harmonics m = 1 + k knots are (sin(half) / (half m))^2 of it, and look like
// the fundamental at the knots. A half-space answers with m^(-1/2) exp(-(1 + i) x / depth m^(1/2)).
std::complex<double> seen_at_knots(std::size_t knots, double depths) {
  const auto answer = [&](double m) {
    const std::complex<double> root = std::sqrt(std::complex<double>(0, 2 * m));
    return std::exp(-root * depths) / root;
  };
  const double n = static_cast<double>(knots), half = std::numbers::pi / n;
  std::complex<double> sum = 0;
  for (double k = -50; k <= 50; ++k) sum += answer(1 + k * n) / std::pow(1 + k * n, 2);
  return sum / answer(1) * std::pow(std::sin(half) / half, 2);
}

Wave settled_wave(const std::string& setup, double period_s, HeatAccuracy accuracy) {
  constexpr std::size_t kKnots = 24;
  std::vector<double> knot_s;
  for (std::size_t i = 0; i <= kKnots; ++i) {
    knot_s.push_back(period_s * static_cast<double>(i) / kKnots);
  }
  const std::vector<double> depth_m =
      setup == "wave_steel" ? std::vector<double>{0, 0.02, 0.1} : std::vector<double>{0, 0.05, 0.2};
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < 2; ++i) {
    layers.push_back(material_of(setup, depth_m[i + 1] - depth_m[i]));
  }
  const double penetration_m = depth_of(setup, period_s / (144 * std::numbers::pi));
  layers.push_back(material_of(setup, 7 * penetration_m));
  HeatRequest request = request_of(layers, InnerSide::kFixedTemperature, kStartK, knot_s, accuracy);
  request.start = PeriodicStart{kStartK, kKnots, 0.1 * accuracy.tolerance_k, 60};
  const auto flux = [&](std::size_t, double t) {
    return Weather{400 * std::cos(2 * std::numbers::pi * t / period_s)};
  };
  const HeatResult r = solved(request, continuous(knot_s, flux, constant({0, 0, kStartK, 0})));
  Wave wave;
  const double half = std::numbers::pi / kKnots;
  for (std::size_t b = 0; b < 3; ++b) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < kKnots; ++i) {
      const double angle = 2 * half * static_cast<double>(i);
      sum += std::polar(2.0 / kKnots, -angle) * r.temperature_k[r.at(i, b, 0)];
      wave.error_k = std::max(wave.error_k, r.error_k[r.at(i, b, 0)]);
    }
    wave.amplitude_k[depth_m[b]] = sum / seen_at_knots(kKnots, depth_m[b] / penetration_m);
  }
  return wave;
}

Answer wave(const Asked& a, HeatAccuracy accuracy) {
  static std::map<std::pair<std::string, double>, Wave> solved_before;
  const double period_s = a.setup == "wave_steel" ? 3600 : 86400;
  const auto [at, missing] = solved_before.try_emplace({a.setup, accuracy.tolerance_k});
  if (missing) at->second = settled_wave(a.setup, period_s, accuracy);
  const std::complex<double> amplitude = at->second.amplitude_k.at(a.x);
  const double error = at->second.error_k;
  if (a.quantity == "amplitude_k") return {std::abs(amplitude), error};
  double lag = -std::arg(amplitude);
  if (lag < 0) lag += 2 * std::numbers::pi;
  const double unit = (a.quantity == "lag_deg" ? 360 : period_s) / (2 * std::numbers::pi);
  return {lag * unit, error / std::abs(amplitude) * unit};
}

Answer wall_of_two(const Asked& a, HeatAccuracy accuracy) {
  HeatRequest request = request_of({concrete(0.2), {0.08, 0.035, 30, 1400}}, InnerSide::kAir, 290,
                                   {0, 3e5, 3e6}, accuracy);
  const double outside_k = a.setup == "wall_cold" ? 273.15 : 297.15;
  const HeatResult r = solved(request, continuous(request.knot_s, constant({0, 0, outside_k, 25}),
                                                  constant({0, 0, 293.15, 8})));
  const Answer outer = last_of(r, 0);
  if (a.quantity == "interface_k") return last_of(r, 1);
  if (a.quantity == "inner_face_k") return last_of(r, 2);
  const double sign = a.quantity == "outward_w_m2" ? 1 : -1;
  return {sign * 25 * (outer.value - outside_k), 25 * outer.error};
}

Answer slab_of_biot(const Asked& a, HeatAccuracy accuracy) {
  constexpr double kHalf = 0.1;
  const Layer m = concrete(kHalf);
  const double biot = std::stod(a.setup.substr(8));
  const double capacity = m.density_kg_m3 * m.specific_heat_j_kg_k;
  const double time_s = a.t * kHalf * kHalf * capacity / m.conductivity_w_m_k;
  HeatRequest request = request_of({concrete(kHalf / 2), concrete(kHalf / 2)},
                                   InnerSide::kAdiabatic, kStartK + 1, {0, time_s}, accuracy);
  const double h = biot * m.conductivity_w_m_k / kHalf;
  // x counts from the middle.
  const Answer at = last_of(
      solved(request, continuous(request.knot_s, constant({0, 0, kStartK, h}), constant({}))),
      a.x == 1 ? 0 : 1);
  return {at.value - kStartK, at.error};
}

Answer surface(const Asked& a, HeatAccuracy accuracy) {
  const auto black = [](double t) { return kStefanBoltzmannWM2K4 * std::pow(t, 4); };
  std::vector<Layer> layers = {plate(1000)};
  double emissivity = 0, start_k = kStartK, time_s = a.t;
  Weather w;
  if (a.setup.starts_with("plate")) {
    const std::size_t i = static_cast<std::size_t>(a.setup.back() - '1');
    constexpr double kAbsorbed[] = {900, 900, 0, 0}, kSky[] = {260, 260, 240, 220},
                     kH[] = {10, 25, 5, 0}, kAir[] = {300, 300, 280, 280};
    emissivity = i == 3 ? 0.95 : 0.9;
    w = {kAbsorbed[i], black(kSky[i]), kAir[i], kH[i]};
    time_s = 1e6;
  } else if (a.setup == "lumped_plate") {
    layers = {plate(3611)};
    w = {500, 0, 300, 20};
  } else if (a.setup == "contact") {
    layers = {concrete(0.3), steel(1.5)};
    time_s = 600;
  } else {
    layers = {plate(36110)};
    emissivity = 0.8;
    start_k = 400;
    if (a.setup == "radiating_plate_300") w.incoming_w_m2 = black(300);
  }
  HeatRequest request = request_of(layers, InnerSide::kAdiabatic, start_k, {0, time_s}, accuracy);
  request.outer[0].emissivity = emissivity;
  if (a.setup == "contact") request.start = StatedStart{{300, 280}, 0};
  return last_of(solved(request, continuous(request.knot_s, constant(w), constant({}))),
                 a.setup == "contact" ? 1 : 0);
}

// 1e-3: default accuracy; 1e-5: a tolerance for it.
class ClosedForms : public ::testing::TestWithParam<double> {};

TEST_P(ClosedForms, HeatCsv) {
  const double wanted = GetParam();
  const ReferenceTable table("heat.csv");
  for (std::size_t row = 0; row < table.size(); ++row) {
    Asked a{table.text(row, "case"), table.text(row, "quantity"), table.number(row, "x"),
            table.number(row, "t")};
    double value = table.number(row, "value");
    // The temperature change of the setup at that time, in the quantity's unit over kelvin.
    double change = 20, unit = 1;
    std::function<Answer(const Asked&, HeatAccuracy)> by = surface;
    if (a.setup.starts_with("wave")) {
      by = wave;
      const Layer m = material_of(a.setup, 1);
      const double omega = 2 * std::numbers::pi / (a.setup == "wave_steel" ? 3600 : 86400);
      const double effusivity =
          std::sqrt(m.conductivity_w_m_k * m.density_kg_m3 * m.specific_heat_j_kg_k);
      change = 400 / (effusivity * std::sqrt(omega));
      if (a.quantity != "amplitude_k") {
        const double depth = std::sqrt(2 * m.conductivity_w_m_k /
                                       (m.density_kg_m3 * m.specific_heat_j_kg_k) / omega);
        unit = (a.quantity == "lag_deg" ? 180 / std::numbers::pi : 1 / omega) /
               (change * std::exp(-a.x / depth));
      }
    } else if (a.setup.starts_with("wall")) {
      by = wall_of_two;
      if (a.quantity.ends_with("w_m2")) unit = 25;
      if (a.setup == "wall_warm") change = 4;
    } else if (a.setup.starts_with("slab_bi")) {
      by = slab_of_biot;
      change = 1;
    } else if (a.setup.starts_with("flux") || a.setup.starts_with("slab")) {
      by = rise;
      change = rise({a.setup, a.quantity, 0, a.t}, {}).value;
    } else if (a.setup.starts_with("step") || a.setup.starts_with("air")) {
      by = rise;
    } else if (a.setup == "radiating_plate_300") {  // the time at which it has come to x
      a.t = value;
      value = a.x;
      change = 400 - a.x;
    } else if (a.setup != "contact") {
      change = a.setup == "plate_4" ? 80 : std::abs(value - kStartK);
    }
    HeatAccuracy accuracy;
    if (wanted < 1e-3) accuracy = {2 * wanted * change, 10};  // stated is three times true
    const Answer got = by(a, accuracy);
    // A third of the default tolerance is more than 1e-3 of changes below 3.3 K.
    const double allowed_k =
        wanted < 1e-3 ? wanted * change : std::max(wanted * change, accuracy.tolerance_k / 3);
    EXPECT_NEAR(got.value, value, allowed_k * unit)
        << a.setup << ", " << a.quantity << ", x " << a.x << ", t " << a.t;
    EXPECT_LE(std::abs(got.value - value), got.error) << a.setup << " x " << a.x << " t " << a.t;
  }
}
INSTANTIATE_TEST_SUITE_P(Accuracies, ClosedForms, ::testing::Values(1e-3, 1e-5));

}  // namespace
}  // namespace irsig
