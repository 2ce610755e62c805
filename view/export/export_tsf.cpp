// STK's target signature file (.tsf), as far as its public description goes
// (docs/reference/export.md).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/base/progress.h"
#include "view/export/export.h"

namespace irsig {
namespace {

// Off the body's z axis, which points down, and around it from the x axis: aspects all around and
// at several elevations are a grid of these two angles.
struct TsfDirection {
  double rho_deg = 0, theta_deg = 0;
  auto operator<=>(const TsfDirection&) const = default;
};

TsfDirection tsf_direction(const StoredSignature& s) {
  const double azimuth = std::fmod(s.aspect_azimuth_deg, 360.0);
  const double theta = azimuth > 180 ? azimuth - 360 : azimuth;
  return {90 + s.aspect_elevation_deg, theta};
}

struct TsfSpectrum {
  std::vector<double> lambda_um;
  std::vector<float> value;  // W/(sr um)
};
using TsfInstant = std::map<TsfDirection, TsfSpectrum>;

// At a pole of rho all theta are one direction, and -180 and 180 are one theta: each is written as
// often as the grid has places for it.
void complete(TsfInstant& rows) {
  std::vector<std::pair<TsfDirection, TsfSpectrum>> seam;
  for (const auto& [at, spectrum] : rows)
    if (at.theta_deg == 180) seam.emplace_back(TsfDirection{at.rho_deg, -180}, spectrum);
  for (auto& [at, spectrum] : seam) rows.try_emplace(at, std::move(spectrum));
  std::set<double> rho, theta;
  for (const auto& [at, spectrum] : rows) {
    const bool pole = at.rho_deg < 1e-9 || at.rho_deg > 180 - 1e-9;
    (pole ? rho : theta).insert(pole ? at.rho_deg : at.theta_deg);
  }
  for (const double pole : rho) {
    const TsfSpectrum of = rows.lower_bound({pole, -1000})->second;
    for (const double t : theta) rows.try_emplace({pole, t}, of);
  }
}

bool is_grid(const TsfInstant& rows) {
  std::map<double, std::set<double>> theta_of;
  for (const auto& [at, spectrum] : rows) theta_of[at.rho_deg].insert(at.theta_deg);
  return std::ranges::all_of(
      theta_of, [&](const auto& entry) { return entry.second == theta_of.begin()->second; });
}

}  // namespace

absl::Status write_tsf(StoreReader& reader, QueryRows& rows, const std::string& path) {
  std::map<double, TsfInstant> instants;  // by seconds since 1970
  std::map<double, std::string> time_of;
  std::optional<StoredSignature> first;
  LoopProgress progress("spectra read, rows", rows.count());
  for (;;) {
    ASSIGN_OR_RETURN(const auto some, rows.next());
    if (some.empty()) break;
    for (const QueryRow& row : some) {
      const StoredSignature& s = row.signature;
      if (!first) first = s;
      const auto differs = [&](const char* what, const std::string& a, const std::string& b,
                               const char* option) {
        return absl::InvalidArgumentError(
            fmt::format("a target signature file has one {}, but there are \"{}\" and \"{}\": "
                        "choose one with {}",
                        what, a, b, option));
      };
      if (s.sweep != first->sweep) return differs("sweep", first->sweep, s.sweep, "--sweep");
      if (s.season != first->season) return differs("season", first->season, s.season, "--season");
      if (s.band != first->band) return differs("band", first->band, s.band, "--band");
      if (s.range_m != first->range_m)
        return differs("range", fmt::format("{} m", first->range_m), fmt::format("{} m", s.range_m),
                       "--at-range-m");
      ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, row));
      ASSIGN_OR_RETURN(const auto time, parse_rfc3339(s.time_utc));
      const schema::Spectrum& spectrum = got.spectrum;
      time_of.try_emplace(unix_seconds(time), s.time_utc);
      if (!instants[unix_seconds(time)]
               .try_emplace(tsf_direction(s),
                            TsfSpectrum{{spectrum.lambda_um().begin(), spectrum.lambda_um().end()},
                                        {spectrum.spectral_intensity_w_sr_um().begin(),
                                         spectrum.spectral_intensity_w_sr_um().end()}})
               .second)
        return absl::InvalidArgumentError(
            fmt::format("row {} has the time and direction of another row: choose rows with "
                        "--aspect, --time or --row",
                        s.row));
      progress.step();
    }
  }
  if (!first) return absl::NotFoundError("nothing to export: no signature matches the filters");
  bool grid = true;
  for (auto& [time, instant] : instants) {
    complete(instant);
    grid = grid && is_grid(instant);
  }
  const double epoch = instants.begin()->first;
  const bool turns =
      std::ranges::any_of(instants, [](const auto& instant) { return instant.second.size() > 1; });
  const absl::Status written = replace_file(path, [&](const std::string& beside) -> absl::Status {
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    if (turns) file << "RhoAxis RhoFromZ\nThetaAxis ThetaFromX\n";
    for (const auto& [time, instant] : instants) {
      if (instants.size() > 1) file << fmt::format("TIME {:.9g}\n", time - epoch);
      double rho_deg = -1;
      for (const auto& [at, spectrum] : instant) {
        if (turns && at.rho_deg != rho_deg) file << fmt::format("RHO {:.9g}\n", at.rho_deg);
        rho_deg = at.rho_deg;
        if (turns) file << fmt::format("THETA {:.9g}\n", at.theta_deg);
        for (std::size_t i = 0; i < spectrum.lambda_um.size(); ++i)
          file << fmt::format("INTENSITY {:.9g} {:.9g}\n", spectrum.lambda_um[i],
                              spectrum.value[i]);
      }
    }
    file.close();
    return file ? absl::OkStatus() : write_failure(path);
  });
  if (!written.ok()) return written;
  if (instants.size() > 1)
    print_note("irsig: {}: TIME 0 is {}: set the scenario's epoch to it\n", path,
               time_of.begin()->second);
  if (!grid)
    print_note(
        "irsig: {}: its directions are no grid of rho and theta: STK may not interpolate between "
        "them; viewpoints of kind \"ring\" are a grid\n",
        path);
  return absl::OkStatus();
}

}  // namespace irsig
