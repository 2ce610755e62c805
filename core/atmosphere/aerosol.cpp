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

// Heights have their particles by the level of the table below which they are.
enum class Region { kBoundaryLayer, kTroposphere, kStratosphere, kUpperAir };

Region region_of_level(double height_km) {
  if (height_km <= kBoundaryLayerKm) return Region::kBoundaryLayer;
  if (height_km <= kTropopauseKm) return Region::kTroposphere;
  return height_km <= kStratopauseKm ? Region::kStratosphere : Region::kUpperAir;
}

double level_extinction_per_km(const AerosolSpec& spec, std::size_t row, double visibility_km) {
  const auto& table = height_table().extinction_per_km;
  switch (region_of_level(height_table().height_km[row])) {
    case Region::kBoundaryLayer:
      return boundary_extinction_per_km(row, visibility_km);
    case Region::kTroposphere: {
      const auto& clear = table[spec.summer_troposphere ? kSummer50 : kWinter50];
      const auto& hazy = table[spec.summer_troposphere ? kSummer23 : kWinter23];
      return std::max(
          1e-6, between_classes(std::max(visibility_km, 23.0), 50, clear[row], 23, hazy[row]));
    }
    case Region::kStratosphere:
      return table[spec.summer_troposphere ? kStratosphereSummer : kStratosphereWinter][row];
    case Region::kUpperAir:
      return table[kUpper][row];
  }
  return 0;
}

// The particles of one region at one height, by their extinction at 0.55 um.
struct Share {
  Region region;
  double per_km;
};

// Between two levels of one region, or of the same particles, the extinction is exponential; from
// one region to the next each one's particles fade linearly to nothing at the other's level.
// So LOWTRAN7 has it, whose amounts of the other region's particles are 0 at either level.
std::array<Share, 2> fractions_at(const AerosolSpec& spec, double height_km, double visibility_km) {
  const HeightTable& t = height_table();
  if (height_km >= t.height_km.back()) return {};
  const TablePosition at = locate(t.height_km, std::max(height_km, 0.0));
  const double low = level_extinction_per_km(spec, at.index, visibility_km);
  const double high = level_extinction_per_km(spec, at.index + 1, visibility_km);
  const Region below = region_of_level(t.height_km[at.index]);
  const Region above = region_of_level(t.height_km[at.index + 1]);
  const bool same =
      below == above || (spec.kind == AerosolKind::kTropospheric && above == Region::kTroposphere);
  if (same) return {{{below, low * std::pow(high / low, at.fraction)}, {above, 0}}};
  return {{{below, low * (1 - at.fraction)}, {above, high * at.fraction}}};
}

const ModelOptics& model_of(AerosolKind kind, Region region) {
  static const std::map<std::string_view, ModelOptics> models = read_models();
  switch (region) {
    case Region::kTroposphere:
      return models.at("tropospheric");
    case Region::kStratosphere:
      return models.at("stratospheric");
    case Region::kUpperAir:
      return models.at("meteoric");
    case Region::kBoundaryLayer:
      break;
  }
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

// The Navy model's amount, where no visibility is stated.
bool by_wind(const AerosolSpec& spec) {
  return spec.kind == AerosolKind::kNavyMaritime && spec.visibility_m == 0;
}

// Returns the visibility with which the height table is read.
double visibility_km(const AerosolSpec& spec, double surface_humidity_percent) {
  if (!by_wind(spec)) return 1e-3 * spec.visibility_m;
  return 3.912 / (navy_visible_per_km(navy_mix(spec, surface_humidity_percent)) +
                  kMolecularExtinctionPerKm);
}

// Relative to the extinction at 0.55 um.
struct RelativeOptics {
  AirSpectrum extinction = AirSpectrum(kAirBandCount, 0.0);
  AirSpectrum absorption = AirSpectrum(kAirBandCount, 0.0);
};

RelativeOptics navy_optics(const AerosolSpec& spec, double humidity_percent,
                           const BandChoice& bands) {
  RelativeOptics out;
  const NavyMix mix = navy_mix(spec, humidity_percent);
  const double visible_per_km = navy_visible_per_km(mix);
  AirSpectrum of_mode(kAirBandCount, 0.0);
  for (std::size_t m = 0; m < 3; ++m) {
    const double amount = mix.per_km[m] / visible_per_km;
    for (const auto& [curves, sum] : {std::pair{&navy_modes()[m].ln_extinction, &out.extinction},
                                      std::pair{&navy_modes()[m].ln_absorption, &out.absorption}}) {
      exp_of_curves(*curves, mix.at[m], bands, of_mode);
      for (std::size_t b = 0; b < kAirBandCount; ++b) (*sum)[b] += amount * of_mode[b];
    }
  }
  return out;
}

}  // namespace

double aerosol_depth_550(const AerosolSpec& spec, double surface_humidity_percent) {
  if (spec.kind == AerosolKind::kNone) return 0;
  const double visible_km = visibility_km(spec, surface_humidity_percent);
  constexpr double kStepKm = 0.05, kTopKm = 100;
  double depth = 0;
  for (double z = 0.5 * kStepKm; z < kTopKm; z += kStepKm) {
    for (const Share& share : fractions_at(spec, z, visible_km)) depth += kStepKm * share.per_km;
  }
  return depth;
}

absl::Status check_aerosol(const AerosolSpec& spec) {
  if (spec.kind == AerosolKind::kNone) return absl::OkStatus();
  if (!by_wind(spec) && !(spec.visibility_m >= 100 && spec.visibility_m <= 100e3)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("visibility_m %g: expected 100 to 100000", spec.visibility_m));
  }
  if (spec.kind != AerosolKind::kNavyMaritime) return absl::OkStatus();
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
  for (const Share& share :
       fractions_at(spec, 1e-3 * height_m, visibility_km(spec, surface_humidity_percent))) {
    if (share.per_km <= 0) continue;
    const double per_m = 1e-3 * share.per_km;
    const ModelOptics& model = model_of(spec.kind, share.region);
    const bool navy =
        spec.kind == AerosolKind::kNavyMaritime && share.region == Region::kBoundaryLayer;
    const TablePosition at = humidity_position(
        model.humidity_percent, navy ? surface_humidity_percent : relative_humidity_percent);
    RelativeOptics optics;
    if (navy) {
      optics = navy_optics(spec, surface_humidity_percent, bands);
    } else {
      exp_of_curves(model.ln_extinction, at, bands, optics.extinction);
      exp_of_curves(model.ln_absorption, at, bands, optics.absorption);
    }
    const auto [from, to] = at_position(model.asymmetry, at);
    for (const BandChoice::Range& r : bands.ranges()) {
      for (std::size_t b = r.first; b < r.last; ++b) {
        const double absorbed = std::min(optics.extinction[b], optics.absorption[b]);
        const double scattered = per_m * (optics.extinction[b] - absorbed);
        out.absorption_per_m[b] += per_m * absorbed;
        out.scattering_per_m[b] += scattered;
        const double g = from[b] + at.fraction * (to[b] - from[b]);
        const double all = out.scattering_per_m[b];
        out.asymmetry[b] += (g - out.asymmetry[b]) * (all > 0 ? scattered / all : 1);
      }
    }
  }
  return out;
}

}  // namespace irsig
