#include "view/bands/band_population.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "core/base/status_macros.h"
#include "core/geo/frames.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

// How far away a direction may be of which a viewpoint is the nearest, as a cosine: somewhat more
// than its third neighbour is away, which lies behind the corner of its cell.
std::vector<double> reach_of(const std::vector<Vec<Body>>& unit, std::size_t count) {
  constexpr std::size_t kNeighbour = 3;
  constexpr double kBeyond = 1.25;
  std::vector<double> out(count, -1.0);
  if (unit.size() <= kNeighbour) return out;
  std::vector<double> cosine;
  for (std::size_t i = 0; i < count; ++i) {
    cosine.clear();
    for (std::size_t j = 0; j < unit.size(); ++j)
      if (j != i) cosine.push_back(dot(unit[i], unit[j]));
    std::nth_element(cosine.begin(), cosine.begin() + (kNeighbour - 1), cosine.end(),
                     std::greater<>());
    const double away = kBeyond * std::acos(std::clamp(cosine[kNeighbour - 1], -1.0, 1.0));
    out[i] = away < std::numbers::pi ? std::cos(away) : -1;
  }
  return out;
}

// Returns the weights of aspects: for each, the fraction of evenly spread directions that it is
// nearest to among all viewpoints of the sweep. The aspects are some of these viewpoints. A
// direction farther away than viewpoints lie apart counts for none of them.
std::vector<double> solid_angles(const std::vector<AspectDeg>& aspect,
                                 const schema::ResolvedSweep& sweep) {
  constexpr int kDirections = 20000;
  std::vector<Vec<Body>> unit;
  std::set<std::pair<double, double>> there;
  const auto add = [&](double azimuth_deg, double elevation_deg) {
    if (there.emplace(azimuth_deg, elevation_deg).second)
      unit.push_back(body_from_aspect(azimuth_deg, elevation_deg));
  };
  for (const AspectDeg& a : aspect) add(a.azimuth, a.elevation);
  const std::size_t count = unit.size();
  for (const schema::Viewpoint& v : sweep.viewpoint())
    add(v.aspect_azimuth_deg(), v.aspect_elevation_deg());
  double lowest = 1, highest = -1;
  for (const Vec<Body>& u : unit) {
    lowest = std::min(lowest, -u.z);  // z is down
    highest = std::max(highest, -u.z);
  }
  const bool zone = highest - lowest > 1e-6;
  const std::vector<double> farthest = reach_of(unit, count);
  std::vector<double> out(count, 0.0);
  for (int n = 0; n < kDirections; ++n) {
    const double share = (n + 0.5) / kDirections;
    const double z = zone ? lowest + (highest - lowest) * share : 2 * share - 1;
    const double c = std::sqrt(std::max(0.0, 1 - z * z)),
                 azimuth = n * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec<Body> where{c * std::cos(azimuth), c * std::sin(azimuth), -z};
    std::size_t nearest = 0;
    double most = -2;
    for (std::size_t i = 0; i < unit.size(); ++i)
      if (const double d = dot(where, unit[i]); d > most) {
        most = d;
        nearest = i;
      }
    if (nearest < count && most >= farthest[nearest]) out[nearest] += 1.0 / kDirections;
  }
  // The weight is at least half a direction's: there may be more aspects than directions.
  for (double& weight : out) weight = std::max(weight, 0.5 / kDirections);
  return out;
}

using Place = std::tuple<std::string, std::string, double, double, double>;
Place place_of(const StoredSignature& s) {
  return {s.season, s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m};
}

struct Contrast {
  TargetContrast target;
  std::vector<double> background_w_m2_sr_um;
};
absl::StatusOr<Contrast> stored_contrast(StoreReader& reader, const QueryRow& row,
                                         std::vector<double>& lambda_um) {
  if (row.interpolation)
    return absl::InvalidArgumentError("interpolated rows have no spectra whose errors are known");
  ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, row));
  const schema::Spectrum& s = got.spectrum;
  if (s.contrast_spectral_intensity_w_sr_um().empty())
    return absl::FailedPreconditionError(fmt::format(
        "row {} was stored by an older irsig, without a contrast spectrum: run the sweep again",
        row.signature.row));
  const std::vector<double> axis(s.lambda_um().begin(), s.lambda_um().end());
  if (lambda_um.empty()) lambda_um = axis;
  if (lambda_um != axis)
    return absl::InvalidArgumentError("the rows have not all the same wavelengths");
  const auto& stderrs = s.contrast_spectral_intensity_stderr_w_sr_um();
  ASSIGN_OR_RETURN(auto errors,
                   SumErrors::make({stderrs.data(), static_cast<std::size_t>(stderrs.size())},
                                   s.contrast_spectral_intensity_modes()));
  const Measured contrast = contrast_of(row.signature);
  const auto known = [](double value) { return std::isnan(value) ? 0 : value; };
  const auto& values = s.contrast_spectral_intensity_w_sr_um();
  const auto& behind = s.background_radiance_w_m2_sr_um();
  return Contrast{{{values.begin(), values.end()},
                   errors.modes(),
                   errors.rest(),
                   contrast.bias_bound(),
                   contrast.undersampling_stderr,
                   std::hypot(known(row.signature.contrast_model_error_w_sr),
                              known(row.signature.contrast_input_uncertainty_w_sr))},
                  {behind.begin(), behind.end()}};
}

// Returns the rows whose background was measured. INVALID_ARGUMENT: none of them.
absl::StatusOr<std::vector<QueryRow>> rows_with_clutter(StoreReader& reader,
                                                        std::span<const QueryRow> rows) {
  std::vector<QueryRow> out;
  for (const QueryRow& row : rows) {
    ASSIGN_OR_RETURN(const auto clutter, reader.clutter(row.signature.signature_id));
    if (clutter) out.push_back(row);
  }
  if (!out.empty() || rows.empty()) return out;
  return absl::InvalidArgumentError(fmt::format(
      "row {} has no clutter, nor has any other: neither [land] nor a sea that wind roughens lies "
      "behind its target, the sensor stands less than 0.6 deg above the target's horizontal, or an "
      "older irsig ran it; choose other views (--aspect), add [land] to the sweep file and run it "
      "again, or ask without --clutter",
      rows.front().signature.row));
}

// The background around a row's target. At another range than the stored one the air between the
// target and the sensor scales it, bin by bin: clutter stands near the target's range.
absl::StatusOr<TargetClutter> stored_clutter(StoreReader& reader, const QueryRow& row) {
  const StoredSignature& s = row.signature;
  ASSIGN_OR_RETURN(const auto stored, reader.clutter(s.signature_id));
  if (!stored) return absl::NotFoundError(fmt::format("row {} has no clutter any more", s.row));
  const auto& sigma = stored->patch_sigma_w_m2_sr_um();
  ASSIGN_OR_RETURN(
      const auto errors,
      SumErrors::make({sigma.data(), static_cast<std::size_t>(sigma.size())}, stored->modes()));
  TargetClutter out{errors.modes(), errors.rest(), 0};
  const std::int64_t id[] = {s.signature_id};
  ASSIGN_OR_RETURN(const auto found, reader.read(id));  // a moved row has no clutter of its own
  const double value = found.front().clutter_patch_sigma_w_m2_sr;
  if (value > 0) out.relative_stderr = found.front().clutter_patch_sigma_stderr_w_m2_sr / value;
  std::vector<double> factor(out.rest.size(), s.projected_area_m2);
  if (row.range_change) {
    ASSIGN_OR_RETURN(const auto from, reader.spectrum(s.signature_id));
    ASSIGN_OR_RETURN(const auto to, spectrum_of(reader, row));
    for (std::size_t i = 0; i < factor.size(); ++i) {
      const int k = static_cast<int>(i);
      const double before = from.path_transmittance(k), after = to.spectrum.path_transmittance(k);
      factor[i] *= before > 0 ? after / before : 0;
    }
  }
  for (std::size_t i = 0; i < factor.size(); ++i) {
    out.rest[i] *= factor[i];
    for (auto& mode : out.modes) mode[i] *= factor[i];
  }
  return out;
}

// Returns the weight of each row; the weights sum to 1. aspect_of: [row], index into `aspects`.
absl::StatusOr<std::vector<double>> weights_of(std::span<const QueryRow> rows,
                                               const std::vector<AspectDeg>& aspects,
                                               const std::vector<std::size_t>& aspect_of,
                                               AspectWeight weight,
                                               std::span<const RowWeights> own_weights,
                                               const schema::ResolvedSweep& sweep) {
  std::vector<double> of_aspect(aspects.size(), 1);
  bool shares = weight == AspectWeight::kSolidAngle;
  if (shares) of_aspect = solid_angles(aspects, sweep);
  for (const RowWeights& table : own_weights)
    if (table.of_aspects) {
      of_aspect = weights_of_aspects(table, aspects);
      shares = true;
    }
  std::vector<double> out(rows.size(), 1);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const RowWeights& table : own_weights) {
      if (table.of_aspects) continue;
      ASSIGN_OR_RETURN(const auto factor, weight_of(table, rows[i].signature));
      out[i] *= factor;
    }
  // Rows of one aspect share its weight.
  std::vector<double> of_rows(aspects.size(), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) of_rows[aspect_of[i]] += out[i];
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (out[i] > 0) out[i] *= of_aspect[aspect_of[i]] / (shares ? of_rows[aspect_of[i]] : 1);
  const double sum = std::accumulate(out.begin(), out.end(), 0.0);
  if (!(sum > 0)) return absl::InvalidArgumentError("the weights leave no row");
  for (double& w : out) w /= sum;
  return out;
}

}  // namespace

absl::StatusOr<BandPopulation> band_population(StoreReader& reader, std::span<const QueryRow> rows,
                                               StoreReader* other,
                                               std::span<const QueryRow> against,
                                               AspectWeight weight,
                                               std::span<const RowWeights> own_weights,
                                               bool clutter) {
  if (rows.empty()) return absl::InvalidArgumentError("no signature matches");
  BandPopulation out;
  std::vector<QueryRow> measured;
  if (clutter) {
    ASSIGN_OR_RETURN(measured, rows_with_clutter(reader, rows));
    out.without_clutter = rows.size() - measured.size();
    rows = measured;
  }
  std::map<std::pair<double, double>, std::size_t> aspects;
  std::vector<AspectDeg> aspect;
  std::vector<std::size_t> aspect_of;
  const StoredSignature& any = rows.front().signature;
  for (const QueryRow& row : rows) {
    const StoredSignature& s = row.signature;
    if (s.band != any.band || s.sweep != any.sweep)
      return absl::InvalidArgumentError(fmt::format(
          "rows of several {}s match, \"{}\" and \"{}\": choose one with --{}",
          s.band != any.band ? "band" : "sweep", s.band != any.band ? any.band : any.sweep,
          s.band != any.band ? s.band : s.sweep, s.band != any.band ? "band" : "sweep"));
    const auto [at, added] =
        aspects.try_emplace({s.aspect_azimuth_deg, s.aspect_elevation_deg}, aspects.size());
    if (added) aspect.push_back({s.aspect_azimuth_deg, s.aspect_elevation_deg});
    aspect_of.push_back(at->second);
  }
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(any.sweep, SweepFiles::kNone));
  ASSIGN_OR_RETURN(const auto weights,
                   weights_of(rows, aspect, aspect_of, weight, own_weights, sweep.resolved));
  std::map<Place, const QueryRow*> partner, own_place;
  for (const auto& [all, of] : {std::pair{rows, &own_place}, {against, &partner}})
    for (const QueryRow& row : all)
      if (const auto [at, added] = of->emplace(place_of(row.signature), &row); !added)
        return absl::InvalidArgumentError(fmt::format(
            "two rows, {} and {}, are of the same place, {} {}, aspect {:g},{:g} at {:g} m: choose "
            "one of the stored ranges (--at-range-m){}",
            at->second->signature.row, row.signature.row, row.signature.season,
            row.signature.time_utc, row.signature.aspect_azimuth_deg,
            row.signature.aspect_elevation_deg, row.signature.range_m,
            of == &partner ? ", or one sweep of the other target (--against-sweep)" : ""));
  std::map<std::tuple<double, double, double>, std::size_t> views;
  std::map<std::tuple<std::string, std::string, double, double>, std::size_t> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (weights[i] == 0) continue;
    const StoredSignature& s = rows[i].signature;
    ASSIGN_OR_RETURN(auto own, stored_contrast(reader, rows[i], out.lambda_um));
    BandCase made{weights[i],
                  0,
                  0,
                  s.season,
                  s.time_utc,
                  s.aspect_azimuth_deg,
                  s.aspect_elevation_deg,
                  s.range_m,
                  std::move(own.target),
                  std::nullopt,
                  std::move(own.background_w_m2_sr_um)};
    if (clutter) {
      ASSIGN_OR_RETURN(made.clutter, stored_clutter(reader, rows[i]));
    }
    if (other != nullptr) {
      const auto found = partner.find(place_of(s));
      if (found == partner.end())
        return absl::InvalidArgumentError(fmt::format(
            "the other target has no row for {} {}, aspect {:g},{:g} at {:g} m", s.season,
            s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m));
      ASSIGN_OR_RETURN(auto theirs, stored_contrast(*other, *found->second, out.lambda_um));
      made.against = std::move(theirs.target);
    }
    if (made.target.modes.empty() || (made.against && made.against->modes.empty()))
      ++out.without_modes;
    const double from_m = rows[i].range_change ? rows[i].range_change->stored_range_m : s.range_m;
    made.view =
        views.try_emplace({s.aspect_azimuth_deg, s.aspect_elevation_deg, from_m}, views.size())
            .first->second;
    made.place =
        places
            .try_emplace({s.season, s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg},
                         places.size())
            .first->second;
    out.row.push_back(std::move(made));
  }
  if (out.lambda_um.size() < 2) return absl::InvalidArgumentError("the band has one wavelength");
  ASSIGN_OR_RETURN(out.own_response, response_of(sweep, any.band));
  return out;
}

}  // namespace irsig
