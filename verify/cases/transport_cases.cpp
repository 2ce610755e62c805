#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/environment/air.h"
#include "core/scene/generate/generate_mesh.h"
#include "core/scene/mesh_measure.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"
#include "verify/cases/hard_materials.h"

namespace irsig {
namespace {

double cause(const SignatureResult& row, Cause c) {
  return row.cause_w_sr[static_cast<std::size_t>(c)].value;
}

// Through the simulator's own weights: what a source of unit spectral shape f(lambda) has in band.
template <typename Function>
double in_band(const Simulator& simulator, std::size_t band, Function&& f) {
  const BandGrid& grid = simulator.band_grids()[band];
  double sum = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    sum += grid.band_weight[i] * f(grid.node_um[i]);
  return sum;
}

double sun_irradiance_w_m2(const Simulator& simulator, std::size_t band = 0) {
  return in_band(simulator, band, solar_irradiance_w_m2_um);
}

absl::Status sound(const ViewResult& view, const std::string& what) {
  if (view.guarded_nonfinite == 0 && view.guarded_negative == 0) return absl::OkStatus();
  return absl::InternalError(absl::StrCat(what, ": ", view.guarded_nonfinite,
                                          " weights were not finite, ", view.guarded_negative,
                                          " negative"));
}

std::string printed(const Estimate& e, double expected) {
  return absl::StrCat(": ", e.value, " +- ", e.stderr_, ", expected ", expected);
}

// With the few wavelengths that a smooth spectrum needs: models whose reflectance depends on the
// wavelength take a second to prepare for many.
SceneSpec of_few_wavelengths(Mesh mesh, const MaterialSpec& spec) {
  SceneSpec scene = one_body(std::move(mesh), spec);
  scene.band = {{"LWIR", 8, 12, 2, {}}};
  return scene;
}

// Every model at every roughness as the wall of an open cavity in a world of its own temperature:
// nothing can be seen but Planck's law, whatever is reflected how often.
absl::StatusOr<Finding> isothermal_enclosure(Effort effort) {
  Worst worst(student_t_bound(31, 11 * kRoughness.size()));
  double sum = 0, rows = 0;
  // Above the sea: what is below the waterline would be the sea.
  const double height_m = 50, range_m = 1000;
  const Mesh wall = moved(spherical_cavity(50, 24, 32), {0, 0, -height_m});
  for (const double roughness : kRoughness)
    for (const HardMaterial& kind : every_material(roughness)) {
      // Ward's of 1992 exceeds 1 only beyond 89.9 deg, Duer's everywhere at grazing.
      if (!kind.bounded && !kind.name.starts_with("ward 1992")) continue;
      ASSIGN_OR_RETURN(const auto simulator,
                       Simulator::create(of_few_wavelengths(wall, kind.spec)));
      ViewRequest r =
          dark_view(*simulator, 0, std::asin(height_m / range_m) / kRadPerDeg, range_m, {300});
      r.condition[0].surroundings = {SurroundingsKind::kSea, 300, 0, 300, 1, 0};
      r.max_reflections = 400;
      r.accuracy.samples_per_replicate = effort == Effort::kFull ? 65536 : 4096;
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
      RETURN_IF_ERROR(sound(view, kind.name));
      const SignatureResult& row = view.row[0];
      const double expected =
          in_band(*simulator, 0,
                  [](double lambda_um) { return planck_radiance_w_m2_sr_um(lambda_um, 300); }) *
          row.projected_area_m2.value;
      // Emissivity and DHR tables are each within 5e-5; a path meets the wall about three times.
      worst.see(t_of(row.intensity_w_sr, expected, 3e-4 * expected),
                [&] { return kind.name + printed(row.intensity_w_sr, expected); });
      sum += (row.intensity_w_sr.value - expected) / row.intensity_w_sr.stderr_;
      ++rows;
    }
  // An error that all rows share shows in their sum, whose variance is Student's: 31 / 29.
  worst.see(std::abs(sum) / std::sqrt(rows * 31 / 29),
            [&] { return absl::StrCat("sum of t over ", rows, " rows: ", sum); });
  return worst.finding();
}

// A plate of 0 K in a uniform world returns its DHR, at every angle.
absl::StatusOr<Finding> white_furnace(Effort effort) {
  constexpr double kTheta[] = {10, 70};
  constexpr double kSome[] = {1e-4, 0.1, 1};
  Worst worst(student_t_bound(31, 11 * std::size(kSome) * std::size(kTheta)));
  for (const double roughness : kSome)
    for (const HardMaterial& kind : every_material(roughness)) {
      ASSIGN_OR_RETURN(const auto simulator,
                       Simulator::create(of_few_wavelengths(lying(plate(1, 1)), kind.spec)));
      const Material& material = simulator->materials()[0];
      const BandGrid& grid = simulator->band_grids()[0];
      std::vector<float> emissivity(grid.node_um.size());
      for (const double theta_deg : kTheta) {
        ViewRequest r = dark_view(*simulator, 30, 90 - theta_deg, 1e5, {0});
        r.condition[0].surroundings = {SurroundingsKind::kNone, -1, 10, 0, 1, 10};
        r.max_reflections = 1;
        r.accuracy.samples_per_replicate = effort == Effort::kFull ? 65536 : 4096;
        ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
        RETURN_IF_ERROR(sound(view, kind.name));
        const SignatureResult& row = view.row[0];
        // Some models reflect as the wavelength says, whatever their constants.
        const auto cos_o = static_cast<float>(std::cos(theta_deg * kRadPerDeg));
        material.spectral_emissivity(cos_o, emissivity.data());
        double world = 0, expected = 0;
        for (std::size_t i = 0; i < emissivity.size(); ++i) {
          const double radiance = grid.band_weight[i] * 10 * row.projected_area_m2.value;
          world += radiance;
          expected += radiance * (material.grey() ? material.dhr_max(cos_o) : 1.0 - emissivity[i]);
        }
        worst.see(t_of(row.intensity_w_sr, expected, 1e-4 * world), [&] {
          return absl::StrCat(kind.name, ", ", theta_deg, " deg",
                              printed(row.intensity_w_sr, expected));
        });
      }
    }
  return worst.finding();
}

// A diffuse isothermal sphere with an opening: eps / (1 - (1 - eps)(1 - opening / wall)).
absl::StatusOr<Finding> cavity_0999(Effort effort) {
  Worst worst(student_t_bound(31, 2));
  for (const double half_angle_deg : {5.0, 30.0}) {
    const Mesh wall = spherical_cavity(half_angle_deg, 400, 256);
    ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(wall, grey_paint(0.001))));
    ViewRequest r = dark_view(*simulator, 0, 0, 1000, {400});
    // The mean is 345 reflections; one path in 1e10 has more than this limit.
    r.max_reflections = 8000;
    r.accuracy.samples_per_replicate = effort == Effort::kFull ? 262144 : 16384;
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    RETURN_IF_ERROR(sound(view, "cavity"));
    const SignatureResult& row = view.row[0];
    const double opening = std::numbers::pi * std::pow(std::sin(half_angle_deg * kRadPerDeg), 2);
    const double kept = 1 - opening / measure(wall).area_m2;
    const double expected = row.projected_area_m2.value *
                            black_radiance_w_m2_sr(*simulator, 0, 400) * 0.001 / (1 - 0.999 * kept);
    worst.see(t_of(row.intensity_w_sr, expected, 2e-4 * expected), [&] {
      return absl::StrCat("half angle ", half_angle_deg, " deg",
                          printed(row.intensity_w_sr, expected));
    });
    worst.require(row.intensity_w_sr.stderr_ < 0.05 * expected, [&] {
      return "too coarse to prove anything" + printed(row.intensity_w_sr, expected);
    });
  }
  return worst.finding();
}

// The light after N reflections is less than the stated bound, and the bound vanishes with N.
absl::StatusOr<Finding> truncation(Effort effort) {
  Worst worst(1);
  const double emissivity = 0.1, half_angle_deg = 10;
  const Mesh wall = spherical_cavity(half_angle_deg, 400, 256);
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(wall, grey_paint(emissivity))));
  const double opening = std::numbers::pi * std::pow(std::sin(half_angle_deg * kRadPerDeg), 2);
  const double kept = 1 - opening / measure(wall).area_m2;
  const double black = black_radiance_w_m2_sr(*simulator, 0, 400);
  for (const std::uint32_t reflections : {0u, 1u, 3u, 10u, 30u, 100u, 300u}) {
    ViewRequest r = dark_view(*simulator, 0, 0, 1000, {400});
    r.max_reflections = reflections;
    r.accuracy.samples_per_replicate = effort == Effort::kFull ? 4096 : 256;
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const SignatureResult& row = view.row[0];
    const double limit =
        row.projected_area_m2.value * black * emissivity / (1 - (1 - emissivity) * kept);
    const double missing = limit - row.intensity_w_sr.value;
    const double allowed = row.truncation_bound_w_sr +
                           student_t_bound(31, 7) * row.intensity_w_sr.stderr_ + 2e-4 * limit;
    worst.see(missing / allowed, [&] {
      return absl::StrCat(reflections, " reflections: ", missing, " missing, bound ",
                          row.truncation_bound_w_sr);
    });
    if (reflections == 300)
      worst.require(row.truncation_bound_w_sr < 1e-3 * limit,
                    [] { return "the bound does not vanish"; });
  }
  return worst.finding();
}

// Emissivity 1: Planck and nothing else; emissivity 0: no light of its own.
absl::StatusOr<Finding> emissivity_0_and_1(Effort) {
  Worst worst(2e-6);
  for (const double emissivity : {0.0, 1.0}) {
    ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(spherical_cavity(50, 24, 32),
                                                                      grey_paint(emissivity))));
    ViewRequest r = dark_view(*simulator, 0, 0, 1e4, {300});
    r.condition[0].surroundings = {SurroundingsKind::kNone, 250, 0, 0, 1, 5};
    r.max_reflections = 50;
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const SignatureResult& row = view.row[0];
    const double own = cause(row, Cause::kEmitted), all = row.intensity_w_sr.value,
                 black = row.projected_area_m2.value * black_radiance_w_m2_sr(*simulator, 0, 300);
    const auto where = [&] { return absl::StrCat("emissivity ", emissivity); };
    worst.see(std::abs(own - emissivity * black) / black, where);
    if (emissivity == 1) {
      worst.require(own == all, where);
    } else {
      worst.require(own == 0 && cause(row, Cause::kPartsReflected) == 0 && all > 0, where);
    }
    worst.require(view.guarded_nonfinite == 0, where);
  }
  return worst.finding();
}

// A mirror of slopes 1e-4 shows the sun's disk, 15 to 46 times wider than its lobe, at the sun's
// own radiance; a degree beside the mirror direction it shows nothing.
absl::StatusOr<Finding> mirror_and_sun(Effort effort) {
  Worst worst(student_t_bound(31, 6));
  for (const double roughness : {1e-4, 3e-4})
    for (const double elevation_deg : {50.0, 5.0}) {
      CookTorrance mirror;
      mirror.constants = {{0, 1.2, 5}};
      mirror.roughness = roughness;
      ASSIGN_OR_RETURN(const auto simulator,
                       Simulator::create(one_body(lying(plate(1, 1)), {"mirror", mirror})));
      for (const double beside_deg : {0.0, 1.0}) {
        ViewRequest r = dark_view(*simulator, 0, elevation_deg, 1e5, {300});
        put_sun(r.condition[0], body_from_aspect(180, elevation_deg + beside_deg));
        r.max_reflections = 2;
        r.accuracy.samples_per_replicate = effort == Effort::kFull ? 32768 : 2048;
        ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
        RETURN_IF_ERROR(sound(view, "mirror"));
        const SignatureResult& row = view.row[0];
        const Estimate& sun = row.cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)];
        const double rho = std::sin(0.266 * kRadPerDeg);
        const double disk = sun_irradiance_w_m2(*simulator) / (std::numbers::pi * rho * rho);
        const double sine = std::sin(elevation_deg * kRadPerDeg);
        const double shown = row.projected_area_m2.value * disk *
                             simulator->materials()[0].dhr_max(static_cast<float>(sine));
        const auto where = [&] {
          return absl::StrCat("roughness ", roughness, ", elevation ", elevation_deg, " deg, ",
                              beside_deg, " deg beside", printed(sun, shown));
        };
        if (beside_deg > 0) {
          // exp(-(tan(0.5 deg) / 3e-4)^2) and less.
          worst.require(sun.value <= 1e-9 * shown, where);
        } else {
          // The disk is sampled on its tangent plane: 1e-5; the DHR's table: 1e-4.
          worst.see(t_of(sun, shown, 2e-4 * shown), where);
          worst.require(sun.stderr_ < 0.02 * shown, where);
        }
      }
    }
  return worst.finding();
}

// A plate seen from 1e-4 deg above its plane, and the sun there.
absl::StatusOr<Finding> grazing_view(Effort effort) {
  Worst worst(student_t_bound(31, 6));
  CookTorrance rough;
  rough.constants = {{0, 1.2, 5}};
  for (const MaterialSpec& spec : {grey_paint(0.5), MaterialSpec{"rough", rough}}) {
    ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(lying(plate(1, 1)), spec)));
    for (const double elevation_deg : {1.0, 1e-2, 1e-4}) {
      ViewRequest r = dark_view(*simulator, 20, elevation_deg, 1e5, {300});
      r.accuracy.samples_per_replicate = effort == Effort::kFull ? 16384 : 1024;
      put_sun(r.condition[0], body_from_aspect(200, elevation_deg));
      r.max_reflections = 1;
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
      RETURN_IF_ERROR(sound(view, spec.name));
      const SignatureResult& row = view.row[0];
      const double sine = std::sin(elevation_deg * kRadPerDeg);
      const Estimate& own = row.cause_w_sr[static_cast<std::size_t>(Cause::kEmitted)];
      const double expected = sine *
                              simulator->materials()[0].emissivity(static_cast<float>(sine)) *
                              black_radiance_w_m2_sr(*simulator, 0, 300);
      // The emissivity's table is linear in sqrt(cos); floats of 1 m at 1e-4 deg: 6e-8 / 1.7e-6.
      worst.see(t_of(own, expected, 0.04 * 1e-4 / elevation_deg * expected + 1e-4 * expected), [&] {
        return absl::StrCat(spec.name, " from ", elevation_deg, " deg", printed(own, expected));
      });
      const double sun = cause(row, Cause::kSunReflected);
      worst.require(std::isfinite(sun) && sun >= 0 && row.intensity_w_sr.value >= own.value,
                    [&] { return absl::StrCat(spec.name, ": sun ", sun); });
    }
  }
  return worst.finding();
}

// 5 cm at 1500 K on 100 m at 300 K, 100 km away: a 1e-7 of the area, half a microradian.
absl::StatusOr<Finding> sub_pixel_hot_spot(Effort effort) {
  Worst worst(student_t_bound(31, 1));
  SceneSpec scene =
      one_body(joined(plate(100, 100, 10), moved(plate(0.05, 0.05), {0.02, 31, -23}), "spot/"),
               grey_paint(0.8));
  scene.mesh.group = {"wall", "spot"};
  scene.part = {{"wall", {"wall"}, 0, false, false}, {"spot", {"spot"}, 0, false, true}};
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  ViewRequest r = dark_view(*simulator, 10, 5, 1e5, {300, 1500});
  r.accuracy.samples_per_replicate = effort == Effort::kFull ? 16384 : 1024;
  ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
  const Estimate& spot = view.row[0].part_w_sr[1];
  const double cosine = std::cos(10 * kRadPerDeg) * std::cos(5 * kRadPerDeg);
  const double expected = 0.0025 * cosine * 0.8 * black_radiance_w_m2_sr(*simulator, 0, 1500);
  // Floats at 40 m from the centre are 3.8e-6 m apart: 1.5e-4 of two 5 cm edges; range: 31 m / 1e5.
  worst.see(t_of(spot, expected, 6e-4 * expected), [&] { return printed(spot, expected); });
  worst.require(spot.stderr_ < 0.01 * expected,
                [&] { return "standard error above 1 %" + printed(spot, expected); });
  return worst.finding();
}

// A small hot disk above a grey plate, seen in the plate alone: few paths would find it by chance.
// Either the estimate is right within its error, or it does not claim to be.
absl::StatusOr<Finding> hidden_hot_spot(Effort effort) {
  Worst worst(student_t_bound(31, 40));
  const double height = 0.5, side = 20, edge = 0.02;
  Mesh hot = moved(inside_out(lying(plate(edge, edge))), {0, 0, -height});
  SceneSpec scene = one_body(joined(lying(plate(side, side, 4)), hot, "hot/"), grey_paint(0.6));
  scene.mesh.group = {"plate", "hot"};
  scene.material.push_back(grey_paint(1));
  scene.part = {{"plate", {"plate"}, 0, false, false}, {"hot", {"hot"}, 1, false, true}};
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(scene));
  const double x = 0.5 * side / height, root = std::sqrt(1 + x * x);
  // A small facet over the middle of a parallel square.
  const double factor = 4 / (2 * std::numbers::pi) * 2 * (x / root * std::atan(x / root));
  const double elevation_deg = 30;
  const double expected = std::sin(elevation_deg * kRadPerDeg) * 0.4 * edge * edge * factor *
                          black_radiance_w_m2_sr(*simulator, 0, 1500);
  constexpr std::uint64_t kSeeds = 20;
  for (const bool pilot : {false, true})
    for (std::uint64_t seed = 1; seed <= (pilot || effort == Effort::kFull ? kSeeds : 3); ++seed) {
      ViewRequest r = dark_view(*simulator, 0, elevation_deg, 1e5, {0, 1500});
      r.seed = seed;
      r.max_reflections = 3;
      r.accuracy.samples_per_replicate = pilot ? 0 : effort == Effort::kFull ? 16384 : 2048;
      r.accuracy.relative_error = pilot ? 0.02 : 0;
      r.accuracy.max_samples_per_replicate = 1 << 15;
      ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
      const SignatureResult& row = view.row[0];
      const Estimate& e = row.part_w_sr[0];
      const auto where = [&] {
        return absl::StrCat(pilot ? "to 2 %" : "fixed samples", ", seed ", seed,
                            printed(e, expected));
      };
      // The disk is not a point (edge^2 / height^2 / 6) and hides 1e-5 of the plate.
      worst.see(t_of(e, expected, 1e-3 * expected), where);
      // A run that has met the disk's light too seldom knows it.
      worst.require(
          row.numerical_error_w_sr > 0.2 * (std::abs(e.value - expected) - 1e-3 * expected), where);
      worst.require(!pilot || e.stderr_ < 0.2 * expected, where);
      if (pilot && row.stop_reason == StopReason::kTargetReached)
        worst.require(std::abs(e.value - expected) < 5 * 0.02 * expected, where);
    }
  return worst.finding();
}

// Two rows that differ by 1 mK share their paths: the difference keeps its own relative error.
absl::StatusOr<Finding> contrast_through_zero(Effort) {
  Worst worst(student_t_bound(31, 3));
  ASSIGN_OR_RETURN(auto frigate, generate_mesh({"frigate", 20000}));
  ASSIGN_OR_RETURN(const auto simulator,
                   Simulator::create(one_body(std::move(frigate), grey_paint(0.7))));
  ViewRequest r = dark_view(*simulator, 40, 10, 5000, {300});
  for (const double step : {1e-3, -1e-3, 1e-6}) {
    ConditionSpec other = r.condition[0];
    other.part_temperature_k = {300 + step};
    r.condition.push_back(other);
    r.selected_condition.push_back(static_cast<std::uint32_t>(r.condition.size() - 1));
  }
  ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
  const SignatureResult& base = view.row[0];
  for (std::size_t i = 1; i < r.condition.size(); ++i) {
    const double step = r.condition[i].part_temperature_k[0] - 300;
    const double difference = view.row[i].intensity_w_sr.value - base.intensity_w_sr.value;
    const double expected = 0.7 * base.projected_area_m2.value *
                            planck_band_radiance_derivative_w_m2_sr_k(8, 12, 300) * step *
                            (1 + 0.5 * step / 300);  // the next term is of this order
    // Its error is the area's, relative to the difference; rounding of both rows: 1e-15 of them.
    const double relative = base.projected_area_m2.stderr_ / base.projected_area_m2.value;
    const double error = relative * std::abs(expected);
    const double rounding =
        1e-15 * base.intensity_w_sr.value + 1e-4 * relative * std::abs(expected);
    const auto where = [&] {
      return absl::StrCat("step ", step, " K: ", difference, " W/sr, expected ", expected,
                          ", of rows of ", base.intensity_w_sr.value);
    };
    worst.see(std::max(0.0, std::abs(difference - expected) - rounding) / error, where);
    // Without common random numbers the difference would drown.
    worst.require(base.intensity_w_sr.stderr_ > 10 * std::abs(difference), where);
  }
  return worst.finding();
}

// A table that multiplies light by 3e30 at each reflection: after the second no float holds the
// weight. All of them are counted, none enters the result.
absl::StatusOr<Finding> guards_count(Effort) {
  Worst worst(0);
  TabulatedBrdf absurd;
  absurd.lambda_um = {10};
  absurd.theta_i_deg = absurd.theta_r_deg = {0, 90};
  absurd.phi_deg = {0, 180};
  absurd.brdf_per_sr.assign(8, 1e30f);
  ASSIGN_OR_RETURN(const auto simulator,
                   Simulator::create(one_body(spherical_cavity(50, 24, 32), {"absurd", absurd})));
  worst.require(simulator->energy_gain(), [] { return "not flagged"; });
  ViewRequest r = dark_view(*simulator, 0, 0, 1e4, {0});  // of finite weights, 0 K makes nothing
  r.max_reflections = 4;
  ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
  const auto where = [&] {
    return absl::StrCat(view.guarded_nonfinite, " counted on ", view.target_paths, " paths");
  };
  // Every path that meets the wall twice more; two in three do.
  worst.require(view.guarded_nonfinite > view.target_paths / 4, where);
  worst.require(view.row[0].intensity_w_sr.value == 0 && view.row[0].numerical_error_w_sr >= 0,
                [&] { return absl::StrCat("intensity ", view.row[0].intensity_w_sr.value); });
  Finding out = worst.finding();
  if (out.worst_error == 0) out.where = where();
  return out;
}

// Bouguer's law and the air's own light over sixteen decades of optical depth.
absl::StatusOr<Finding> optical_depth(Effort) {
  Worst worst(4);
  const std::vector<double> lambda_um = {4, 10};
  const double temperature_k = 288;
  for (int i = -120; i <= 40; ++i) {
    const double depth = std::pow(10.0, i / 10.0);
    Air air;
    air.model = AirModel::kHomogeneous;
    air.pressure_pa = 101325;
    air.gas_constant_j_kg_k = 287;
    air.path_emission = true;
    const double range_m = 5000;
    air.absorption_m2_kg =
        depth * air.gas_constant_j_kg_k * temperature_k / (air.pressure_pa * range_m);
    // The depth that these doubles stand for.
    const long double exact = static_cast<long double>(air.absorption_m2_kg) * air.pressure_pa *
                              range_m /
                              (static_cast<long double>(air.gas_constant_j_kg_k) * temperature_k);
    const AirPath path = air_path(air, temperature_k, range_m, lambda_um);
    constexpr double kUlp = std::numeric_limits<double>::epsilon();
    for (std::size_t k = 0; k < lambda_um.size(); ++k) {
      const auto where = [&] { return absl::StrCat("depth ", depth, ", ", lambda_um[k], " um"); };
      const long double transmittance = expl(-exact);
      // Four roundings of the depth, magnified by it; one of the result.
      worst.see(static_cast<double>(fabsl(path.transmittance[k] - transmittance) /
                                    (kUlp * (1 + exact) * std::max(transmittance, 1e-290L))),
                where);
      const double black = planck_radiance_w_m2_sr_um(lambda_um[k], temperature_k);
      worst.see(
          static_cast<double>(
              fabsl(path.path_radiance_w_m2_sr_um[k] / (-expm1l(-exact) * black) - 1) / (2 * kUlp)),
          where);
    }
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> transport_cases() {
  const std::string kT =
      "Student's t of the case's rows, 31 degrees of freedom (a false alarm in 1000 suites), after "
      "the tables' 5e-5 a reflection";
  return {
      {"transport", "isothermal_enclosure",
       "every model, roughness 1e-4 to 1, an open cavity in a world of its temperature: Planck [t]",
       kT, isothermal_enclosure},
      {"transport", "white_furnace",
       "every model, roughness 1e-4, 0.1 and 1, 0 K in a uniform world [t]", kT, white_furnace},
      {"transport", "cavity_0999",
       "spherical cavities of reflectance 0.999: effective emissivity [t]",
       "Student's t of 2 rows after 2e-4 for the facets", cavity_0999},
      {"transport", "truncation", "cavity, 0 to 300 reflections: what is missing / what is allowed",
       "the stated bound is one: the missing part stays below it and five standard errors",
       truncation},
      {"transport", "emissivity_0_and_1", "cavities of emissivity 0 and 1: emission, relative",
       "each weight is rounded to a float a few times: 6e-8 each, correlated at worst 2e-6",
       emissivity_0_and_1},
      {"transport", "mirror_and_sun", "slopes of 1e-4 and 3e-4 show the sun's disk, or nothing [t]",
       "Student's t of 6 rows; 2 % standard error at most", mirror_and_sun},
      {"transport", "grazing_view", "a plate seen from 89 to 89.9999 deg: emission [t], finite sun",
       "Student's t of 6 rows after 4 % (floats of 1 m) at 89.9999 deg", grazing_view},
      {"transport", "sub_pixel_hot_spot", "5 cm at 1500 K on 100 m, 100 km away [t]",
       "Student's t; a standard error above 1 % breaks it", sub_pixel_hot_spot},
      {"transport", "hidden_hot_spot", "2 cm at 1500 K seen in a 20 m plate alone [t]",
       "Student's t of 40 rows, each a seed; a stated error below a fifth of the true one, or "
       "above 20 % "
       "at 32768 samples, breaks it",
       hidden_hot_spot},
      {"transport", "contrast_through_zero", "rows 1 mK and 1 uK apart: their difference [t]",
       "common random numbers: its relative error is the projected area's", contrast_through_zero},
      {"transport", "guards_count", "weights beyond any float: not counted, or in the result",
       "what is dropped is counted, and nothing of it stays", guards_count},
      {"transport", "optical_depth",
       "transmittance and 1 - transmittance, depth 1e-12 to 1e4 [roundings]",
       "the depth is the product and quotient of four doubles: two units in the last place, and as "
       "much in reserve",
       optical_depth},
  };
}

}  // namespace irsig
