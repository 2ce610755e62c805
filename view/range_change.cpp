#include "view/range_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "bridge/environment/sweep_environment.h"
#include "bridge/environment/weather_from_message.h"
#include "core/environment/air.h"
#include "core/geo/viewpoint.h"
#include "view/moved_row.h"
#include "view/progress.h"
#include "view/sight_line.h"

namespace irsig {
namespace {

constexpr double kFewestLengths = 20;

// The air of homogeneous surroundings and of none does the same to whatever comes through it.
ViewEnvironment plain_view(const Air& air, double air_temperature_k, double range_m,
                           const std::vector<double>& node_um) {
  AirPath path = air_path(air, air_temperature_k, range_m, node_um);
  const std::vector<double> all(node_um.size(), 1.0);
  ViewEnvironment out;
  out.sun = all;
  out.sun_apparent = path.transmittance;
  out.around = LightAround::of_spectra({all, all}, {path.transmittance, path.transmittance});
  out.path_radiance = std::move(path.path_radiance_w_m2_sr_um);
  out.transmittance = std::move(path.transmittance);
  return out;
}

// The air of one stored sweep.
class SweepAir {
 public:
  static absl::StatusOr<SweepAir> make(StoredSweep sweep) {
    SweepAir out;
    out.sweep_ = std::move(sweep);
    const schema::ResolvedSweep& resolved = out.sweep_.resolved;
    const std::vector<double> breaks_um = spectral_breaks_um(resolved);
    for (const schema::Band& b : resolved.sweep().band()) {
      Band band{b.name(), b.lambda_min_um(), b.lambda_max_um(), b.step_um(), {}};
      for (const schema::SpectralPoint& p : b.response())
        band.response.push_back({p.lambda_um(), p.value()});
      auto grid = make_band_grid(band, breaks_um);
      if (!grid.ok()) return grid.status();
      out.offset_.push_back(out.node_um_.size());
      out.node_um_.insert(out.node_um_.end(), grid->node_um.begin(), grid->node_um.end());
      out.grid_.push_back(*std::move(grid));
    }
    if (!has_atmosphere(resolved)) return out;
    auto environment = environment_of(resolved, out.node_um_);
    if (!environment.ok()) return environment.status();
    out.environment_ = *std::move(environment);
    return out;
  }

  // Index of a row's condition or band; FAILED_PRECONDITION if the sweep has no such one any more.
  [[nodiscard]] absl::StatusOr<std::uint32_t> condition_of(const StoredSignature& s) const {
    const auto& conditions = sweep_.resolved.condition();
    const auto at = std::find_if(conditions.begin(), conditions.end(), [&](const auto& c) {
      return c.season() == s.season && c.time_utc() == s.time_utc;
    });
    if (s.superseded || at == conditions.end()) return outdated(s);
    return static_cast<std::uint32_t>(at - conditions.begin());
  }
  [[nodiscard]] absl::StatusOr<std::size_t> band_of(const StoredSignature& s) const {
    const auto& bands = sweep_.resolved.sweep().band();
    const auto at =
        std::find_if(bands.begin(), bands.end(), [&](const auto& b) { return b.name() == s.band; });
    if (at == bands.end()) return outdated(s);
    return static_cast<std::size_t>(at - bands.begin());
  }

  // All conditions asked for, from one aspect and range.
  [[nodiscard]] absl::StatusOr<std::vector<ViewEnvironment>> views(
      double aspect_azimuth_deg, double aspect_elevation_deg, double range_m,
      const std::vector<std::uint32_t>& conditions) const {
    if (environment_ == nullptr) {
      const auto air = air_from_message(sweep_.resolved.sweep().air());
      if (!air.ok()) return air.status();
      std::vector<ViewEnvironment> out;
      for (const std::uint32_t c : conditions) {
        const schema::Condition& condition = sweep_.resolved.condition(static_cast<int>(c));
        out.push_back(plain_view(*air, condition.air_temperature_k(), range_m, node_um_));
      }
      return out;
    }
    const Vec<Body> towards = body_from_aspect(aspect_azimuth_deg, aspect_elevation_deg);
    Environment::Line line =
        environment_->line({aspect_azimuth_deg, aspect_elevation_deg, range_m});
    line.behind = BehindNodes({static_cast<float>(-towards.z)}, std::atan2(-towards.y, -towards.x));
    return environment_->view(line, conditions);
  }

  [[nodiscard]] SightLine line(const ViewEnvironment& view, std::size_t band) const {
    return sight_line(view, environment_ ? environment_->nodes() : DirectionNodes(), grid_[band],
                      offset_[band]);
  }
  [[nodiscard]] const StoredSweep& sweep() const { return sweep_; }

 private:
  static absl::Status outdated(const StoredSignature& s) {
    return absl::FailedPreconditionError(fmt::format(
        "row {} (season {}, band {}) is of an earlier version of its sweep, whose air is no longer "
        "known: finish the sweep first",
        s.row, s.season, s.band));
  }

  StoredSweep sweep_;
  std::vector<BandGrid> grid_;
  std::vector<std::size_t> offset_;
  std::vector<double> node_um_;
  std::unique_ptr<const Environment> environment_;  // null: homogeneous air or none
};

absl::Status check_lengths(double range_m, const char* what, const std::string& sweep,
                           const TargetExtent& extent) {
  const double least_m = kFewestLengths * extent.length_m;
  if (range_m >= least_m) return absl::OkStatus();
  return absl::InvalidArgumentError(
      fmt::format("{} {:g} m is below {:g} lengths of the target of sweep \"{}\" ({:g} m long, so "
                  "{:g} m): there "
                  "a signature changes with range by more than its air",
                  what, range_m, kFewestLengths, sweep, extent.length_m, least_m));
}

// Rows of one viewpoint.
using ViewKey = std::tuple<std::string, double, double, double>;
ViewKey key_of(const StoredSignature& s) {
  return {s.sweep, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m};
}

absl::Status move_view(StoreReader& reader, const SweepAir& air, const TargetExtent& extent,
                       double range_m, std::vector<QueryRow*>& rows) {
  std::vector<std::uint32_t> conditions, condition_of_row;
  for (const QueryRow* row : rows) {
    const auto condition = air.condition_of(row->signature);
    if (!condition.ok()) return condition.status();
    condition_of_row.push_back(*condition);
    if (std::find(conditions.begin(), conditions.end(), *condition) == conditions.end())
      conditions.push_back(*condition);
  }
  const StoredSignature any = rows.front()->signature;
  if (absl::Status s = check_lengths(any.range_m, "the stored range", any.sweep, extent); !s.ok())
    return s;
  const auto at = [&](double m) {
    return air.views(any.aspect_azimuth_deg, any.aspect_elevation_deg, m, conditions);
  };
  const auto from = at(any.range_m);
  if (!from.ok()) return from.status();
  const auto to = at(range_m);
  if (!to.ok()) return to.status();
  const double perspective = perspective_bound(any.range_m, range_m, extent.reach_m);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    QueryRow& row = *rows[i];
    const auto band = air.band_of(row.signature);
    if (!band.ok()) return band.status();
    const auto spectrum = reader.spectrum(row.signature.signature_id);
    if (!spectrum.ok()) return spectrum.status();
    const auto c = static_cast<std::size_t>(
        std::find(conditions.begin(), conditions.end(), condition_of_row[i]) - conditions.begin());
    auto moved = moved_row(row.signature, *spectrum, air.line((*from)[c], *band),
                           air.line((*to)[c], *band), perspective);
    if (!moved.ok()) return moved.status();
    row.signature = std::move(moved->signature);
    row.signature.range_m = range_m;
    row.range_change =
        RangeChange{any.range_m, moved->range_bound_w_sr,
                    std::make_shared<const schema::Spectrum>(std::move(moved->spectrum))};
  }
  return absl::OkStatus();
}

}  // namespace

TargetExtent target_extent(std::span<const Vec<Body>> vertex) {
  TargetExtent out{0, 0};
  for (const double Vec<Body>::*axis : {&Vec<Body>::x, &Vec<Body>::y, &Vec<Body>::z}) {
    const auto [least, most] =
        std::minmax_element(vertex.begin(), vertex.end(),
                            [&](const auto& a, const auto& b) { return a.*axis < b.*axis; });
    if (least != vertex.end()) out.length_m = std::max(out.length_m, *most.*axis - *least.*axis);
  }
  for (const Vec<Body>& v : vertex) out.reach_m = std::max(out.reach_m, length(v));
  return out;
}

double perspective_bound(double from_range_m, double to_range_m, double reach_m) {
  double largest = 0;
  for (const double z : {-reach_m, reach_m}) {
    const double ratio = (1 - z / from_range_m) / (1 - z / to_range_m);
    largest = std::max(largest, std::abs(ratio * ratio - 1));
  }
  return largest;
}

absl::StatusOr<std::vector<QueryRow>> at_range(StoreReader& reader, std::vector<QueryRow> rows,
                                               double range_m, const ExtentOf& extent_of) {
  if (!(range_m > 0 && std::isfinite(range_m)))
    return absl::InvalidArgumentError(fmt::format("range {} m: expected more than 0", range_m));
  if (!extent_of)
    return absl::InvalidArgumentError("rows at another range need the target's extent");
  std::vector<StoredSignature> signatures;
  std::map<std::string, std::map<ViewKey, std::vector<QueryRow*>>> sweeps;
  for (QueryRow& row : rows) {
    if (row.interpolation)
      return absl::InvalidArgumentError("an interpolated row cannot be moved to another range");
    signatures.push_back(row.signature);
    sweeps[row.signature.sweep][key_of(row.signature)].push_back(&row);
  }
  if (absl::Status s = check_computed(signatures, SignatureQuantity::kContrastIntensity); !s.ok())
    return s;
  std::size_t count = 0;
  for (const auto& [name, views] : sweeps) count += views.size();
  LoopProgress progress("viewpoints moved", count);
  for (auto& [name, views] : sweeps) {
    auto stored = reader.sweep(name);
    if (!stored.ok()) return stored.status();
    const auto extent = extent_of(*stored);
    if (!extent.ok()) return extent.status();
    if (absl::Status s = check_lengths(range_m, "range", name, *extent); !s.ok()) return s;
    const auto air = SweepAir::make(*std::move(stored));
    if (!air.ok()) return air.status();
    for (auto& [key, of_view] : views) {
      if (absl::Status s = move_view(reader, *air, *extent, range_m, of_view); !s.ok()) return s;
      progress.step();
    }
  }
  return rows;
}

}  // namespace irsig
