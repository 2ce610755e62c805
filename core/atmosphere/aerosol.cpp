#include "core/atmosphere/aerosol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/atmosphere/band_loops.h"
#include "core/atmosphere/embedded.h"
#include "core/base/check.h"
#include "core/base/table.h"

namespace irsig {
namespace {

constexpr double kMolecularExtinctionPerKm = 0.01159;  // of clean air at 0.55 um
constexpr double kBoundaryLayerKm = 2, kTropopauseKm = 10, kStratopauseKm = 30;

double per_band(std::size_t band, const std::vector<double>& lambda_um,
                const std::vector<double>& value) {
  return interpolate(value, locate(lambda_um, air_band_lambda_um(band)));
}

// One model on the air's grid: a curve per tabulated humidity.
struct ModelOptics {
  std::vector<double> humidity_percent;
  std::vector<AirSpectrum> ln_extinction, ln_absorption, asymmetry;
};

std::map<std::string_view, ModelOptics> read_models() {
  struct Curve {
    std::vector<double> lambda_um, extinction, absorption, asymmetry;
  };
  std::map<std::string_view, std::map<double, Curve>> curves;
  for (const auto& row : csv_rows(embedded_aerosol_optics())) {
    Curve& curve = curves[row[0]][number(row[1])];
    curve.lambda_um.push_back(number(row[2]));
    curve.extinction.push_back(std::log(std::max(number(row[3]), 1e-12)));
    curve.absorption.push_back(std::log(std::max(number(row[4]), 1e-12)));
    curve.asymmetry.push_back(number(row[5]));
  }
  std::map<std::string_view, ModelOptics> models;
  for (const auto& [name, by_humidity] : curves) {
    ModelOptics& model = models[name];
    for (const auto& [humidity, curve] : by_humidity) {
      model.humidity_percent.push_back(humidity);
      AirSpectrum extinction, absorption, asymmetry;
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        extinction.push_back(per_band(b, curve.lambda_um, curve.extinction));
        absorption.push_back(per_band(b, curve.lambda_um, curve.absorption));
        asymmetry.push_back(per_band(b, curve.lambda_um, curve.asymmetry));
      }
      model.ln_extinction.push_back(std::move(extinction));
      model.ln_absorption.push_back(std::move(absorption));
      model.asymmetry.push_back(std::move(asymmetry));
    }
  }
  return models;
}

// The Navy model's three modes: ln of the cross sections, and at 0.55 um the extinction alone.
struct NavyMode {
  std::vector<double> humidity_percent;
  std::vector<AirSpectrum> ln_extinction, ln_absorption;
  std::vector<double> ln_extinction_visible;
};

std::array<NavyMode, 3> read_navy_modes() {
  constexpr double kLn10 = 2.302585092994046;
  struct Curve {
    std::vector<double> lambda_um, extinction, absorption;
  };
  std::array<std::map<double, Curve>, 3> curves;
  for (const auto& row : csv_rows(embedded_aerosol_navy())) {
    Curve& curve = curves[static_cast<std::size_t>(number(row[0])) - 1][number(row[1])];
    curve.lambda_um.push_back(number(row[2]));
    curve.extinction.push_back(kLn10 * number(row[3]));
    curve.absorption.push_back(kLn10 * number(row[4]));
  }
  std::array<NavyMode, 3> modes;
  for (std::size_t m = 0; m < 3; ++m) {
    for (const auto& [humidity, curve] : curves[m]) {
      modes[m].humidity_percent.push_back(humidity);
      IRSIG_CHECK(curve.lambda_um.front() == 0.55);
      modes[m].ln_extinction_visible.push_back(curve.extinction.front());
      AirSpectrum extinction, absorption;
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        extinction.push_back(per_band(b, curve.lambda_um, curve.extinction));
        absorption.push_back(per_band(b, curve.lambda_um, curve.absorption));
      }
      modes[m].ln_extinction.push_back(std::move(extinction));
      modes[m].ln_absorption.push_back(std::move(absorption));
    }
  }
  return modes;
}

// Position of a humidity among the tabulated ones, linear in ln(100 - humidity).
TablePosition humidity_position(const std::vector<double>& tabulated_percent, double percent) {
  if (tabulated_percent.size() == 1) return {0, 0};
  std::vector<double> x;
  for (const double h : tabulated_percent) x.push_back(-std::log(100 - h));
  return locate(x, std::clamp(-std::log(std::max(100 - percent, 0.01)), x.front(), x.back()));
}

// The curves on either side; at the last, that one twice.
struct Neighbours {
  const AirSpectrum &from, &to;
};
Neighbours at_position(const std::vector<AirSpectrum>& curves, TablePosition at) {
  return {curves[at.index], curves[at.fraction == 0 ? at.index : at.index + 1]};
}

// exp of what lies between them.
void exp_of_curves(const std::vector<AirSpectrum>& curves, TablePosition at,
                   const BandChoice& bands, AirSpectrum& out) {
  const auto [from, to] = at_position(curves, at);
  for (const BandChoice::Range& r : bands.ranges()) {
    blended_exp(r.size(), &from[r.first], &to[r.first], at.fraction, &out[r.first]);
  }
}

// Columns of aerosol_heights.csv.
enum HeightColumn {
  kBoundary50,
  kBoundary23,
  kBoundary10,
  kBoundary5,
  kBoundary2,
  kWinter50,
  kWinter23,
  kSummer50,
  kSummer23,
  kStratosphereWinter,
  kStratosphereSummer,
  kUpper,
  kHeightColumns
};

struct HeightTable {
  std::vector<double> height_km;
  std::array<std::vector<double>, kHeightColumns> extinction_per_km;
};

const HeightTable& height_table() {
  static const HeightTable table = [] {
    HeightTable t;
    for (const auto& row : csv_rows(embedded_aerosol_heights())) {
      t.height_km.push_back(number(row[0]));
      for (std::size_t c = 0; c < kHeightColumns; ++c) {
        t.extinction_per_km[c].push_back(number(row[c + 1]));
      }
    }
    return t;
  }();
  return table;
}

// Linear in 1 / visibility between two classes, as LOWTRAN7 does.
double between_classes(double visibility_km, double class_a_km, double a, double class_b_km,
                       double b) {
  return a + (b - a) * (1 / visibility_km - 1 / class_a_km) / (1 / class_b_km - 1 / class_a_km);
}

double boundary_extinction_per_km(std::size_t row, double visibility_km) {
  constexpr double kClassKm[] = {50, 23, 10, 5, 2};
  const auto& table = height_table().extinction_per_km;
  std::size_t i = 0;
  while (i < 3 && visibility_km < kClassKm[i + 1]) ++i;
  return std::max(1e-6, between_classes(visibility_km, kClassKm[i], table[i][row], kClassKm[i + 1],
                                        table[i + 1][row]));
}

double level_extinction_per_km(const AerosolSpec& spec, std::size_t row, double visibility_km) {
  const HeightTable& t = height_table();
  const double z = t.height_km[row];
  if (z <= kBoundaryLayerKm) return boundary_extinction_per_km(row, visibility_km);
  if (z <= kTropopauseKm) {
    const auto& clear = t.extinction_per_km[spec.summer_troposphere ? kSummer50 : kWinter50];
    const auto& hazy = t.extinction_per_km[spec.summer_troposphere ? kSummer23 : kWinter23];
    return std::max(1e-6,
                    between_classes(std::max(visibility_km, 23.0), 50, clear[row], 23, hazy[row]));
  }
  if (z <= kStratopauseKm) {
    return t.extinction_per_km[spec.summer_troposphere ? kStratosphereSummer : kStratosphereWinter]
                              [row];
  }
  return t.extinction_per_km[kUpper][row];
}

// Extinction at 0.55 um, exponential between the levels.
double extinction_per_km(const AerosolSpec& spec, double height_km, double visibility_km) {
  const HeightTable& t = height_table();
  if (height_km >= t.height_km.back()) return 0;
  const TablePosition at = locate(t.height_km, std::max(height_km, 0.0));
  const double low = level_extinction_per_km(spec, at.index, visibility_km);
  const double high = level_extinction_per_km(spec, at.index + 1, visibility_km);
  return low * std::pow(high / low, at.fraction);
}

const ModelOptics& model_of(AerosolKind kind, double height_km) {
  static const std::map<std::string_view, ModelOptics> models = read_models();
  if (height_km > kStratopauseKm) return models.at("meteoric");
  if (height_km > kTropopauseKm) return models.at("stratospheric");
  if (height_km > kBoundaryLayerKm) return models.at("tropospheric");
  switch (kind) {
    case AerosolKind::kUrban:
      return models.at("urban");
    case AerosolKind::kMaritime:
    case AerosolKind::kNavyMaritime:
      return models.at("maritime");
    case AerosolKind::kTropospheric:
      return models.at("tropospheric");
    case AerosolKind::kAdvectionFog:
      return models.at("advection_fog");
    case AerosolKind::kRadiationFog:
      return models.at("radiation_fog");
    default:
      return models.at("rural");
  }
}

// beta = (pi / 1000) / F x sum over the modes of A_i 10^Q_i                     [gathman1983]
struct NavyMix {
  std::array<double, 3> per_km;  // (pi / 1000) A_i / F
  std::array<TablePosition, 3> at;
};

const std::array<NavyMode, 3>& navy_modes() {
  static const std::array<NavyMode, 3> modes = read_navy_modes();
  return modes;
}

NavyMix navy_mix(const AerosolSpec& spec, double humidity_percent) {
  const double rh = std::clamp(humidity_percent, 50.0, 98.0);
  const double growth = std::cbrt((2 - rh / 100) / (6 * (1 - rh / 100)));
  const std::array<double, 3> amount = {2000 * spec.air_mass * spec.air_mass,
                                        std::max(5.866 * (spec.wind_speed_24h_m_s - 2.2), 0.5),
                                        std::pow(10, 0.06 * spec.wind_speed_m_s - 2.8)};
  NavyMix mix{};
  for (std::size_t m = 0; m < 3; ++m) {
    mix.per_km[m] = 3.141592653589793e-3 / growth * amount[m];
    // Linear in humidity, unlike the other models: so LOWTRAN7 has it, and so the visibility that
    // MODTRAN prints for a wind comes out (66.33 km; linear in log(100 - humidity) it would be 74).
    const std::vector<double>& tabulated = navy_modes()[m].humidity_percent;
    mix.at[m] = locate(tabulated, std::clamp(rh, tabulated.front(), tabulated.back()));
  }
  return mix;
}

double navy_visible_per_km(const NavyMix& mix) {
  double sum = 0;
  for (std::size_t m = 0; m < 3; ++m) {
    sum += mix.per_km[m] * std::exp(interpolate(navy_modes()[m].ln_extinction_visible, mix.at[m]));
  }
  return sum;
}

double visibility_km_of(double extinction_km) {
  return 3.912 / (extinction_km + kMolecularExtinctionPerKm);
}

// What the height table is asked with; and what the Navy model's cross sections are scaled by.
struct ScaledVisibility {
  double visibility_km, navy_scale;
};
ScaledVisibility scaled_visibility(const AerosolSpec& spec, double surface_humidity_percent) {
  ScaledVisibility out{1e-3 * spec.visibility_m, 1};
  if (spec.kind != AerosolKind::kNavyMaritime) return out;
  const double surface_km = navy_visible_per_km(navy_mix(spec, surface_humidity_percent));
  if (spec.visibility_m == 0)
    out.visibility_km = visibility_km_of(surface_km);
  else
    out.navy_scale =
        std::max(0.0, 3.912 / out.visibility_km - kMolecularExtinctionPerKm) / surface_km;
  return out;
}

}  // namespace

double aerosol_depth_550(const AerosolSpec& spec, double surface_humidity_percent) {
  if (spec.kind == AerosolKind::kNone) return 0;
  // The Navy model's lowest 2 km have the extinction that its visibility means.
  const auto [visibility_km, navy_scale] = scaled_visibility(spec, surface_humidity_percent);
  constexpr double kStepKm = 0.05, kTopKm = 100;
  double depth = 0;
  for (double z = 0.5 * kStepKm; z < kTopKm; z += kStepKm)
    depth += kStepKm * extinction_per_km(spec, z, visibility_km);
  return depth;
}

absl::Status check_aerosol(const AerosolSpec& spec) {
  if (spec.kind == AerosolKind::kNone) return absl::OkStatus();
  const bool navy = spec.kind == AerosolKind::kNavyMaritime;
  const bool by_wind = navy && spec.visibility_m == 0;
  if (!by_wind && !(spec.visibility_m >= 100 && spec.visibility_m <= 100e3)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("visibility_m %g: expected 100 to 100000", spec.visibility_m));
  }
  if (!navy) return absl::OkStatus();
  if (!(spec.air_mass >= 1 && spec.air_mass <= 10)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("air_mass %g: expected 1 to 10", spec.air_mass));
  }
  for (const double wind : {spec.wind_speed_m_s, spec.wind_speed_24h_m_s}) {
    if (!(wind >= 0 && wind <= 20)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("wind speed %g m/s: the Navy aerosol model holds from 0 to 20", wind));
    }
  }
  return absl::OkStatus();
}

AerosolOptics aerosol_optics(const AerosolSpec& spec, double height_m,
                             double relative_humidity_percent, double surface_humidity_percent,
                             const BandChoice& bands) {
  AerosolOptics out{AirSpectrum(kAirBandCount, 0.0), AirSpectrum(kAirBandCount, 0.0),
                    AirSpectrum(kAirBandCount, 0.0)};
  if (spec.kind == AerosolKind::kNone) return out;
  const double height_km = 1e-3 * height_m;
  const bool navy = spec.kind == AerosolKind::kNavyMaritime;
  const auto [visibility_km, navy_scale] = scaled_visibility(spec, surface_humidity_percent);

  const ModelOptics& model = model_of(spec.kind, height_km);
  const TablePosition at = humidity_position(model.humidity_percent, relative_humidity_percent);
  const auto [from, to] = at_position(model.asymmetry, at);
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t b = r.first; b < r.last; ++b) {
      out.asymmetry[b] = from[b] + at.fraction * (to[b] - from[b]);
    }
  }
  // Extinction first, then what of it is scattered.
  AirSpectrum &absorption = out.absorption_per_m, &extinction = out.scattering_per_m;
  double per_m = 1e-3 * navy_scale;
  if (navy && height_km <= kBoundaryLayerKm) {
    const NavyMix mix = navy_mix(spec, relative_humidity_percent);
    AirSpectrum of_mode(kAirBandCount, 0.0);
    for (std::size_t m = 0; m < 3; ++m) {
      for (const auto& [curves, sum] : {std::pair{&navy_modes()[m].ln_extinction, &extinction},
                                        std::pair{&navy_modes()[m].ln_absorption, &absorption}}) {
        exp_of_curves(*curves, mix.at[m], bands, of_mode);
        for (std::size_t b = 0; b < kAirBandCount; ++b) (*sum)[b] += mix.per_km[m] * of_mode[b];
      }
    }
  } else {
    per_m = 1e-3 * extinction_per_km(spec, height_km, visibility_km);
    exp_of_curves(model.ln_extinction, at, bands, extinction);
    exp_of_curves(model.ln_absorption, at, bands, absorption);
  }
  for (const BandChoice::Range& r : bands.ranges()) {
    for (std::size_t b = r.first; b < r.last; ++b) {
      const double absorbed = std::min(extinction[b], absorption[b]);
      absorption[b] = per_m * absorbed;
      extinction[b] = per_m * (extinction[b] - absorbed);
    }
  }
  return out;
}

}  // namespace irsig
