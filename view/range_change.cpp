#include "view/range_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "bridge/environment/sweep_environment.h"
#include "bridge/environment/weather_from_message.h"
#include "core/environment/air.h"
#include "core/geo/viewpoint.h"
#include "view/arriving_reflected.h"
#include "view/moved_row.h"
#include "view/on_all_cores.h"
#include "view/sight_line.h"

namespace irsig {
namespace {

constexpr double kFewestLengths = 20;
// As of ranges in sweep files: farther, double precision no longer tells a target's sides apart.
constexpr double kFarthestM = 1e9;

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

// The air of one band of a stored sweep: what the other bands are does not matter to it.
class BandAir {
 public:
  static absl::StatusOr<BandAir> make(StoredSweep sweep, const StoredSignature& any) {
    BandAir out;
    out.sweep_ = std::move(sweep);
    const schema::ResolvedSweep& resolved = out.sweep_.resolved;
    const auto& bands = resolved.sweep().band();
    const auto b = std::find_if(bands.begin(), bands.end(),
                                [&](const auto& of) { return of.name() == any.band; });
    if (b == bands.end()) return outdated(any);
    Band band{b->name(), b->lambda_min_um(), b->lambda_max_um(), b->step_um(), {}};
    for (const schema::SpectralPoint& p : b->response())
      band.response.push_back({p.lambda_um(), p.value()});
    auto grid = make_band_grid(band, spectral_breaks_um(resolved));
    if (!grid.ok()) return grid.status();
    out.grid_ = *std::move(grid);
    if (!has_atmosphere(resolved)) return out;
    auto environment = environment_of(resolved, out.grid_.node_um);
    if (!environment.ok()) return environment.status();
    out.environment_ = *std::move(environment);
    return out;
  }

  // Index of a row's condition; FAILED_PRECONDITION if the sweep has no such one any more.
  [[nodiscard]] absl::StatusOr<std::uint32_t> condition_of(const StoredSignature& s) const {
    const auto& conditions = sweep_.resolved.condition();
    const auto at = std::find_if(conditions.begin(), conditions.end(), [&](const auto& c) {
      return c.season() == s.season && c.time_utc() == s.time_utc;
    });
    if (s.superseded || at == conditions.end()) return outdated(s);
    return static_cast<std::uint32_t>(at - conditions.begin());
  }

  // All conditions asked for, from one aspect and range. around: as Environment::view has it; what
  // is reflected is not known without it.
  [[nodiscard]] absl::StatusOr<std::vector<SightLine>> lines(
      double aspect_azimuth_deg, double aspect_elevation_deg, double range_m,
      const std::vector<std::uint32_t>& conditions, bool around) const {
    std::vector<SightLine> out;
    if (environment_ == nullptr) {
      const auto air = air_from_message(sweep_.resolved.sweep().air());
      if (!air.ok()) return air.status();
      for (const std::uint32_t c : conditions) {
        const schema::Condition& condition = sweep_.resolved.condition(static_cast<int>(c));
        out.push_back(
            sight_line(plain_view(*air, condition.air_temperature_k(), range_m, grid_.node_um),
                       DirectionNodes(), grid_));
      }
      return out;
    }
    const Vec<Body> towards = body_from_aspect(aspect_azimuth_deg, aspect_elevation_deg);
    Environment::Line line =
        environment_->line({aspect_azimuth_deg, aspect_elevation_deg, range_m});
    line.behind = BehindNodes({static_cast<float>(-towards.z)}, std::atan2(-towards.y, -towards.x));
    const auto views = environment_->view(line, conditions, around);
    if (!views.ok()) return views.status();
    for (const ViewEnvironment& view : *views)
      out.push_back(sight_line(view, around ? environment_->nodes() : DirectionNodes(), grid_));
    return out;
  }
  // Whether lines take their time from what is around the target, and there is room for a table.
  [[nodiscard]] bool wants_table(std::size_t ranges) const {
    constexpr double kMostBytes = 1e9;
    const auto conditions = static_cast<std::size_t>(sweep_.resolved.condition_size());
    return environment_ != nullptr &&
           ArrivingTable::bytes(conditions, ranges, grid_.lambda_um.size()) <= kMostBytes;
  }

 private:
  static absl::Status outdated(const StoredSignature& s) {
    return absl::FailedPreconditionError(fmt::format(
        "row {} (season {}, band {}) is of an earlier version of its sweep, whose air is no longer "
        "known: finish the sweep first",
        s.row, s.season, s.band));
  }

  StoredSweep sweep_;
  BandGrid grid_;
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

// Rows of one viewpoint and band.
using ViewKey = std::tuple<std::string, std::string, double, double, double>;
ViewKey key_of(const StoredSignature& s) {
  return {s.sweep, s.band, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m};
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

struct RangeChanger::Air {
  BandAir air;
  TargetExtent extent;
  ArrivingTable arriving;  // of what is around the target

  // Rows of one viewpoint and band with their spectra; out: [row][range].
  struct View {
    std::vector<const QueryRow*> rows;
    std::vector<schema::Spectrum> spectra;
    std::vector<QueryRow*> out;
    std::vector<std::uint32_t> condition;  // [row]
    [[nodiscard]] const StoredSignature& any() const { return rows.front()->signature; }
    [[nodiscard]] std::vector<std::uint32_t> conditions() const {
      const std::set<std::uint32_t> all(condition.begin(), condition.end());
      return {all.begin(), all.end()};
    }
  };
  [[nodiscard]] absl::Status move(const View& view, const std::vector<double>& ranges_m) const;
};

absl::Status RangeChanger::Air::move(const View& view, const std::vector<double>& ranges_m) const {
  const std::vector<std::uint32_t> conditions = view.conditions();
  const StoredSignature& any = view.any();
  const auto at = [&](double m, bool around) {
    return air.lines(any.aspect_azimuth_deg, any.aspect_elevation_deg, m, conditions, around);
  };
  const bool tabulated = air.wants_table(ranges_m.size());
  auto from = at(any.range_m, !tabulated);
  if (!from.ok()) return from.status();
  for (std::size_t r = 0; r < ranges_m.size(); ++r) {
    auto to = at(ranges_m[r], !tabulated);
    if (!to.ok()) return to.status();
    std::vector<ReflectedSpread> spread(conditions.size());
    bool known = tabulated;
    for (std::size_t c = 0; known && c < conditions.size(); ++c) {
      auto found = arriving.complete(any.aspect_elevation_deg, any.range_m, ranges_m[r],
                                     conditions[c], (*from)[c], (*to)[c]);
      known = found.has_value();
      if (known) spread[c] = *std::move(found);
    }
    if (tabulated && !known) {
      if (from = at(any.range_m, true); !from.ok()) return from.status();
      if (to = at(ranges_m[r], true); !to.ok()) return to.status();
    }
    for (std::size_t c = 0; !known && c < conditions.size(); ++c)
      spread[c] = spread_of((*from)[c], (*to)[c]);
    for (std::size_t i = 0; i < view.rows.size(); ++i) {
      const auto c = static_cast<std::size_t>(
          std::find(conditions.begin(), conditions.end(), view.condition[i]) - conditions.begin());
      auto moved =
          moved_row(view.rows[i]->signature, view.spectra[i], (*from)[c], (*to)[c], spread[c],
                    perspective_bound(any.range_m, ranges_m[r], extent.reach_m));
      if (!moved.ok()) return moved.status();
      moved->signature.range_m = ranges_m[r];
      *view.out[i * ranges_m.size() + r] = {
          std::move(moved->signature), std::nullopt,
          RangeChange{any.range_m, moved->range_bound_w_sr,
                      std::make_shared<const schema::Spectrum>(std::move(moved->spectrum))}};
    }
  }
  return absl::OkStatus();
}

RangeChanger::RangeChanger(StoreReader& reader, std::vector<double> ranges_m, ExtentOf extent_of)
    : reader_(reader), ranges_m_(std::move(ranges_m)), extent_of_(std::move(extent_of)) {}
RangeChanger::~RangeChanger() = default;

absl::StatusOr<RangeChanger::Air*> RangeChanger::air_of(const StoredSignature& any) {
  const std::pair key(any.sweep, any.band);
  if (const auto known = air_.find(key); known != air_.end()) return known->second.get();
  auto stored = reader_.sweep(any.sweep);
  if (!stored.ok()) return stored.status();
  const auto extent = extent_of_(*stored);
  if (!extent.ok()) return extent.status();
  for (const double range_m : ranges_m_)
    if (absl::Status s = check_lengths(range_m, "range", any.sweep, *extent); !s.ok()) return s;
  auto air = BandAir::make(*std::move(stored), any);
  if (!air.ok()) return air.status();
  return (air_[key] = std::make_unique<Air>(Air{*std::move(air), *extent, {}})).get();
}

absl::StatusOr<std::vector<QueryRow>> RangeChanger::moved(const std::vector<QueryRow>& rows) {
  for (const double range_m : ranges_m_)
    if (!(range_m > 0 && std::isfinite(range_m)))
      return absl::InvalidArgumentError(fmt::format("range {} m: expected more than 0", range_m));
  for (const double range_m : ranges_m_)
    if (range_m > kFarthestM)
      return absl::InvalidArgumentError(
          fmt::format("range {:g} m is too far: expected from {:g} lengths of the target to {:g} m",
                      range_m, kFewestLengths, kFarthestM));
  if (!extent_of_)
    return absl::InvalidArgumentError("rows at another range need the target's extent");
  std::vector<StoredSignature> signatures;
  std::map<ViewKey, Air::View> views;
  std::vector<QueryRow> out(rows.size() * ranges_m_.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const QueryRow& row = rows[i];
    if (row.interpolation)
      return absl::InvalidArgumentError("an interpolated row cannot be moved to another range");
    signatures.push_back(row.signature);
    Air::View& view = views[key_of(row.signature)];
    view.rows.push_back(&row);
    for (std::size_t r = 0; r < ranges_m_.size(); ++r)
      view.out.push_back(&out[i * ranges_m_.size() + r]);
  }
  if (absl::Status s = check_computed(signatures, SignatureQuantity::kContrastIntensity); !s.ok())
    return s;
  // What is read is read by this thread alone.
  std::vector<std::pair<Air*, const Air::View*>> list;
  for (auto& [key, view] : views) {
    const auto air = air_of(view.any());
    if (!air.ok()) return air.status();
    if (absl::Status s =
            check_lengths(view.any().range_m, "the stored range", view.any().sweep, (*air)->extent);
        !s.ok())
      return s;
    for (const QueryRow* row : view.rows) {
      const auto condition = (*air)->air.condition_of(row->signature);
      if (!condition.ok()) return condition.status();
      view.condition.push_back(*condition);
      auto spectrum = reader_.spectrum(row->signature.signature_id);
      if (!spectrum.ok()) return spectrum.status();
      view.spectra.push_back(*std::move(spectrum));
    }
    list.emplace_back(*air, &view);
  }
  if (ranges_m_.empty()) return out;
  std::vector<std::pair<const Air*, ArrivingTable::Task>> tasks;
  for (const auto& [air, view] : list)
    if (air->air.wants_table(ranges_m_.size()))
      for (auto& task : air->arriving.lacking(view->any().aspect_elevation_deg, view->any().range_m,
                                              ranges_m_, view->conditions()))
        tasks.emplace_back(air, std::move(task));
  absl::Status status = on_all_cores(tasks.size(), [&](std::size_t i) {
    const BandAir& air = tasks[i].first->air;
    ArrivingTable::compute(tasks[i].second, [&](double elevation_deg, double range_m,
                                                const std::vector<std::uint32_t>& conditions) {
      return air.lines(0, elevation_deg, range_m, conditions, true);
    });
    return absl::OkStatus();
  });
  if (status.ok())
    status = on_all_cores(list.size(), [&](std::size_t i) {
      return list[i].first->move(*list[i].second, ranges_m_);
    });
  if (!status.ok()) return status;
  return out;
}

}  // namespace irsig
