#include "view/moved/range_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "core/base/status_macros.h"
#include "core/environment/air.h"
#include "core/environment/line_horizon.h"
#include "core/environment/surroundings.h"
#include "core/geo/sun.h"
#include "core/geo/viewpoint.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"
#include "messages/environment/surroundings_from_message.h"
#include "messages/environment/sweep_environment.h"
#include "messages/environment/weather_from_message.h"
#include "view/base/on_all_cores.h"
#include "view/moved/arriving_reflected.h"
#include "view/moved/moved_row.h"
#include "view/moved/shape_change.h"
#include "view/moved/sight_line.h"
#include "view/moved/silhouette.h"
#include "view/rows/signature_quantity.h"

namespace irsig {
namespace {

constexpr double kFewestLengths = 20;
// The limit of ranges in sweep files: farther away, double precision no longer tells a target's
// sides apart.
constexpr double kFarthestM = 1e9;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;

// Light of a condition without the embedded atmosphere, on the band's nodes.
struct PlainLight {
  double air_temperature_k;
  std::vector<double> sky, lower;
};

absl::StatusOr<PlainLight> plain_light(const schema::ResolvedSweep& sweep,
                                       const schema::Condition& condition,
                                       const std::vector<double>& node_um) {
  ASSIGN_OR_RETURN(const auto surroundings, surroundings_from_message(condition.surroundings()));
  double sun_scale = 0, cos_zenith = 0;
  if (sweep.sweep().transport().sun()) {
    ASSIGN_OR_RETURN(const auto time, parse_rfc3339(condition.time_utc()));
    const schema::Place& place = sweep.sweep().place();
    ASSIGN_OR_RETURN(const auto sun, sun_position(time, place.latitude_deg(), place.longitude_deg(),
                                                  place.height_m()));
    cos_zenith = std::cos(sun.zenith_deg * kRadiansPerDegree);
    sun_scale = condition.sun_irradiance_from_distance()
                    ? 1 / (sun.distance_au * sun.distance_au)
                    : condition.sun_irradiance_w_m2() / kSolarConstantWM2;
    if (cos_zenith <= -std::sin(sun.angular_radius_deg * kRadiansPerDegree)) sun_scale = 0;
  }
  PlainLight out{condition.air_temperature_k(), {}, {}};
  for (const double um : node_um) {
    const double sun = sun_scale > 0 ? sun_scale * solar_irradiance_w_m2_um(um) : 0;
    out.sky.push_back(sky_radiance_w_m2_sr_um(surroundings, um));
    out.lower.push_back(lower_radiance_w_m2_sr_um(surroundings, um, sun, cos_zenith));
  }
  return out;
}

// The air of homogeneous surroundings and of none does the same to whatever comes through it.
ViewEnvironment plain_view(const Air& air, const PlainLight& light, double range_m,
                           const std::vector<double>& node_um) {
  AirPath path = air_path(air, light.air_temperature_k, range_m, node_um);
  const std::vector<double> all(node_um.size(), 1.0);
  ViewEnvironment out;
  out.sun = all;
  out.sun_apparent = path.transmittance;
  out.around = IncidentRadiance::of_spectra({all, all}, {path.transmittance, path.transmittance});
  out.background_apparent = {light.sky, light.lower};
  for (std::vector<double>& behind : out.background_apparent)
    for (std::size_t i = 0; i < behind.size(); ++i) behind[i] *= path.transmittance[i];
  out.path_radiance = std::move(path.path_radiance_w_m2_sr_um);
  out.transmittance = std::move(path.transmittance);
  return out;
}

// The background directions behind a target from one viewpoint.
struct Behind {
  BackgroundDirections nodes;
  Silhouette::Fractions before;
};

// The air of one band of a stored sweep; the other bands do not matter to it.
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
    ASSIGN_OR_RETURN(out.grid_, make_band_grid(band, spectral_breaks_um(resolved)));
    if (!has_atmosphere(resolved)) {
      ASSIGN_OR_RETURN(out.air_, air_from_message(resolved.sweep().air()));
      for (const schema::Condition& condition : resolved.condition()) {
        ASSIGN_OR_RETURN(auto light, plain_light(resolved, condition, out.grid_.node_um));
        out.plain_.push_back(std::move(light));
        out.waterline_ = condition.surroundings().kind() != "none";
      }
      return out;
    }
    ASSIGN_OR_RETURN(out.environment_, environment_of(resolved, out.grid_.node_um));
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

  // Returns the z at which the radiance behind the target jumps, for each weather.
  [[nodiscard]] std::vector<float> horizons_z(const Viewpoint& v) const {
    if (environment_ != nullptr) return environment_->horizons_z(environment_->line(v));
    if (!waterline_) return {0.0f};
    const GrazingRay straight;
    return {LineHorizon(straight, 0, plain_line(v), 0).z()};
  }
  // Returns true if sea or ground hides the part of the target below body z = 0.
  [[nodiscard]] bool waterline() const { return waterline_; }
  // Returns true if the Earth hides the waterline of the target.
  [[nodiscard]] bool hides_waterline(const Viewpoint& v) const {
    if (!waterline_) return false;
    const double lift_rad =
        environment_ == nullptr ? 0 : environment_->horizon(environment_->line(v)).lift_rad;
    return v.aspect_elevation_deg * kRadiansPerDegree + std::max(0.0, lift_rad) < -1e-6;
  }

  // silhouette: null or without area means that the target reaches `reach_m` anywhere. As much of
  // the target as its bound states then stands before another direction than its reference point
  // does.
  [[nodiscard]] Behind behind(const Viewpoint& v, const Silhouette* silhouette,
                              double reach_m) const {
    const std::vector<float> horizon = horizons_z(v);
    const Vec<Body> towards = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    const double elevation = v.aspect_elevation_deg * kRadiansPerDegree,
                 reach = std::asin(std::min(1.0, reach_m / v.range_m));
    const bool known = silhouette != nullptr && silhouette->area_m2() > 0;
    const double least = known ? silhouette->least_z()
                               : std::sin(std::max(elevation - reach, -std::numbers::pi / 2)),
                 most = known ? silhouette->most_z()
                              : std::sin(std::min(elevation + reach, std::numbers::pi / 2));
    Behind out;
    if (environment_ == nullptr)
      out.nodes = BackgroundDirections({horizon.front(), horizon.front()});
    else
      out.nodes =
          BackgroundDirections::spanning(least, most, horizon, std::atan2(-towards.y, -towards.x));
    if (known) {
      out.before = silhouette->before(out.nodes);
      return out;
    }
    out.before.value.assign(out.nodes.count(), 0.0);
    out.before.error.assign(out.nodes.count(), 0.0);
    BackgroundDirections::Share share[2];
    const int count = out.nodes.shares(static_cast<float>(-towards.z), share);
    for (int i = 0; i < count; ++i)
      out.before.value[share[i].node] += static_cast<double>(share[i].weight);
    const auto z = static_cast<double>(horizon.front());
    if (environment_ != nullptr || (least < z && z <= most))
      out.before.error.front() = out.before.error.back() = 1;
    return out;
  }

  // All conditions asked for, from one aspect and range. around: as Environment::view has it; what
  // is reflected is not known without it. behind: null where what stands behind is not wanted.
  [[nodiscard]] absl::StatusOr<std::vector<SightLine>> lines(
      const Viewpoint& v, const std::vector<std::uint32_t>& conditions, bool around,
      const Behind* behind) const {
    std::vector<SightLine> out;
    if (environment_ == nullptr) {
      for (const std::uint32_t c : conditions)
        out.push_back(sight_line(
            plain_view(air_, plain_[c], v.range_m, grid_.node_um), DirectionNodes(), grid_,
            behind != nullptr ? behind->before : Silhouette::Fractions{{1, 0}, {0, 0}}));
      return out;
    }
    const Vec<Body> towards = body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg);
    Environment::Line line = environment_->line(v);
    line.behind = behind != nullptr ? behind->nodes
                                    : BackgroundDirections({static_cast<float>(-towards.z)},
                                                           std::atan2(-towards.y, -towards.x));
    ASSIGN_OR_RETURN(const auto views, environment_->view(line, conditions, around));
    for (const ViewEnvironment& view : views)
      out.push_back(
          sight_line(view, around ? environment_->nodes() : DirectionNodes(), grid_,
                     behind != nullptr ? behind->before : Silhouette::Fractions{{1}, {0}}));
    return out;
  }

  // Refuses to move a row nearer if homogeneous air lets too little of the background through at
  // the stored range.
  [[nodiscard]] absl::Status check_nearer(const SightLine& from, const SightLine& to) const {
    if (environment_ != nullptr) return absl::OkStatus();
    for (std::size_t k = 0; k < grid_.lambda_um.size(); ++k)
      // Stored values have 24 bits: a transmittance of 1e-3 leaves four digits of the background.
      if (const double before = from.bin.transmittance[k];
          before < 1e-3 && to.bin.transmittance[k] > before)
        return absl::FailedPreconditionError(fmt::format(
            "at {:g} um the air lets only {:.1e} of the background through at the stored range: it "
            "cannot be brought nearer",
            grid_.lambda_um[k], before));
    return absl::OkStatus();
  }

  // Returns the light of a row by part.
  [[nodiscard]] std::vector<PartLight> part_light(const StoredSignature& row,
                                                  std::uint32_t condition,
                                                  const std::vector<StoredPart>& stored) const {
    const schema::Sweep& sweep = sweep_.resolved.sweep();
    const schema::Condition& c = sweep_.resolved.condition(static_cast<int>(condition));
    const double reflected = std::abs(row.sun_reflected_w_sr) + std::abs(row.sky_reflected_w_sr) +
                             std::abs(row.surface_reflected_w_sr) +
                             std::abs(row.interreflected_w_sr);
    const double all = reflected + std::abs(row.emitted_w_sr);
    std::vector<PartLight> out;
    for (int p = 0; p < sweep.part_size(); ++p) {
      const schema::Part& part = sweep.part(p);
      double light = row.intensity_w_sr;
      if (sweep.part_size() > 1) {
        const auto at = std::find_if(stored.begin(), stored.end(),
                                     [&](const StoredPart& s) { return s.part == part.name(); });
        light = at == stored.end() ? 0 : at->intensity_w_sr;
      }
      const auto& field = c.temperature_field().part();
      const bool stated =
          std::find(field.begin(), field.end(), static_cast<std::uint32_t>(p)) == field.end() &&
          p < c.part_temperature_k_size() && c.part_temperature_k(p) > 0;
      const auto material =
          std::find_if(sweep.material().begin(), sweep.material().end(),
                       [&](const auto& m) { return m.name() == part.material(); });
      const bool diffuse = material != sweep.material().end() && material->kind() == "lambert";
      double blackbody = std::nan("");
      if (stated) {
        blackbody = 0;
        for (std::size_t i = 0; i < grid_.node_um.size(); ++i)
          blackbody += grid_.band_weight[i] *
                       planck_radiance_w_m2_sr_um(grid_.node_um[i], c.part_temperature_k(p));
      }
      out.push_back({light, blackbody, stated && diffuse && all > 0 ? reflected / all : 1});
    }
    return out;
  }
  // Returns true if the surroundings of the target make lines of sight expensive, and a table of
  // them fits into memory.
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
  Air air_;                        // homogeneous or none
  std::vector<PlainLight> plain_;  // [condition] of such air
  bool waterline_ = true;
  std::unique_ptr<const Environment> environment_;  // null: homogeneous air or none

  static Environment::Line plain_line(const Viewpoint& v) {
    return {v.range_m, v.aspect_elevation_deg,
            body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg), BackgroundDirections()};
  }
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

// From one of the ranges nothing of the target is seen, or much more of it than from the other.
absl::Status check_seen(const Silhouette& before, const Silhouette& after,
                        const StoredSignature& any, double range_m) {
  constexpr double kMostChange = 2;
  const double least = std::min(before.area_m2(), after.area_m2()),
               most = std::max(before.area_m2(), after.area_m2());
  if (most <= kMostChange * least) return absl::OkStatus();
  return absl::FailedPreconditionError(fmt::format(
      "row {}: the target shows {:.3g} m2 from {:g} m and {:.3g} m2 from {:g} m, other faces from "
      "each: run the sweep with the other range in viewpoints.ranges_m",
      any.row, before.area_m2(), any.range_m, after.area_m2(), range_m));
}

// Rows of one viewpoint and band.
using ViewKey = std::tuple<std::string, std::string, double, double, double>;
ViewKey view_key(const StoredSignature& s) {
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
    std::vector<std::vector<StoredPart>> parts;  // of each row, where the target has several
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
  struct Seen {
    Viewpoint viewpoint;
    std::optional<Silhouette> silhouette;
    Behind behind;
  };
  const auto seen = [&](double range_m) {
    Seen out{{any.aspect_azimuth_deg, any.aspect_elevation_deg, range_m}, {}, {}};
    if (extent.shape)
      out.silhouette.emplace(*extent.shape, out.viewpoint, air.waterline(),
                             air.horizons_z(out.viewpoint));
    out.behind =
        air.behind(out.viewpoint, out.silhouette ? &*out.silhouette : nullptr, extent.reach_m);
    return out;
  };
  const auto lines = [&](const Seen& from, bool around) {
    return air.lines(from.viewpoint, conditions, around, &from.behind);
  };
  const bool tabulated = air.wants_table(ranges_m.size());
  const Seen here = seen(any.range_m);
  auto from = lines(here, !tabulated);
  if (!from.ok()) return from.status();
  for (std::size_t r = 0; r < ranges_m.size(); ++r) {
    const bool own = ranges_m[r] == any.range_m;
    const Seen there = own ? here : seen(ranges_m[r]);
    auto to = lines(there, !tabulated);
    if (!to.ok()) return to.status();
    if (!own)
      for (const Seen* one : {&here, &there})
        if (air.hides_waterline(one->viewpoint))
          return absl::FailedPreconditionError(
              fmt::format("row {}: from {:g} m at an elevation of {:g} deg the Earth hides a part "
                          "of the target, "
                          "another one at each range: run the sweep with the other range in "
                          "viewpoints.ranges_m",
                          any.row, one->viewpoint.range_m, any.aspect_elevation_deg));
    std::optional<ShapeAtRanges> shape;
    if (!own && here.silhouette) {
      RETURN_IF_ERROR(check_seen(*here.silhouette, *there.silhouette, any, ranges_m[r]));
      if (here.silhouette->area_m2() > 0)
        shape.emplace(*extent.shape, here.viewpoint, ranges_m[r], air.waterline(), *here.silhouette,
                      *there.silhouette);
    }
    std::vector<ReflectedSpread> spread(conditions.size());
    bool known = tabulated;
    for (std::size_t c = 0; known && c < conditions.size(); ++c) {
      auto found = arriving.complete(any.aspect_elevation_deg, any.range_m, ranges_m[r],
                                     conditions[c], (*from)[c], (*to)[c]);
      known = found.has_value();
      if (known) spread[c] = *std::move(found);
    }
    if (tabulated && !known) {
      if (from = lines(here, true); !from.ok()) return from.status();
      if (to = lines(there, true); !to.ok()) return to.status();
    }
    for (std::size_t c = 0; !known && c < conditions.size(); ++c)
      spread[c] = spread_of((*from)[c], (*to)[c]);
    for (std::size_t c = 0; c < conditions.size(); ++c) {
      RETURN_IF_ERROR(air.check_nearer((*from)[c], (*to)[c]));
      // An error that both lines share is no error of a row that is not moved.
      if (own)
        for (SightLine* line : {&(*from)[c], &(*to)[c]})
          for (SightLine::Integrals* of : {&line->bin, &line->band})
            of->background_fraction_bound = of->background_between_bound = {};
    }
    const double perspective = perspective_bound(any.range_m, ranges_m[r], extent.reach_m);
    for (std::size_t i = 0; i < view.rows.size(); ++i) {
      const auto c = static_cast<std::size_t>(
          std::find(conditions.begin(), conditions.end(), view.condition[i]) - conditions.begin());
      const ShapeChange change =
          own ? ShapeChange{}
          : shape
              ? shape->of(air.part_light(view.rows[i]->signature, view.condition[i], view.parts[i]))
              : ShapeChange{1, 1, perspective, perspective};
      ASSIGN_OR_RETURN(auto moved, moved_row(view.rows[i]->signature, view.spectra[i], (*from)[c],
                                             (*to)[c], spread[c], change));
      moved.signature.range_m = ranges_m[r];
      *view.out[i * ranges_m.size() + r] = {
          std::move(moved.signature), std::nullopt,
          RangeChange{any.range_m, moved.range_bound_w_sr,
                      std::make_shared<const schema::Spectrum>(std::move(moved.spectrum))}};
    }
    if (own && (from = lines(here, !tabulated), !from.ok())) return from.status();
  }
  return absl::OkStatus();
}

RangeChanger::RangeChanger(StoreReader& reader, std::vector<double> ranges_m, ExtentOf extent_of)
    : reader_(reader), ranges_m_(std::move(ranges_m)), extent_of_(std::move(extent_of)) {}
RangeChanger::~RangeChanger() = default;

absl::StatusOr<RangeChanger::Air*> RangeChanger::air_of(const StoredSignature& any) {
  const std::pair key(any.sweep, any.band);
  if (const auto known = air_.find(key); known != air_.end()) return known->second.get();
  ASSIGN_OR_RETURN(auto stored, reader_.sweep(any.sweep));
  ASSIGN_OR_RETURN(const auto extent, extent_of_(stored));
  for (const double range_m : ranges_m_)
    RETURN_IF_ERROR(check_lengths(range_m, "range", any.sweep, extent));
  ASSIGN_OR_RETURN(auto air, BandAir::make(std::move(stored), any));
  return (air_[key] = std::make_unique<Air>(Air{std::move(air), extent, {}})).get();
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
    Air::View& view = views[view_key(row.signature)];
    view.rows.push_back(&row);
    for (std::size_t r = 0; r < ranges_m_.size(); ++r)
      view.out.push_back(&out[i * ranges_m_.size() + r]);
  }
  RETURN_IF_ERROR(check_computed(signatures, SignatureQuantity::kContrastIntensity));
  // The database is read by this thread alone.
  std::vector<std::pair<Air*, const Air::View*>> list;
  for (auto& [key, view] : views) {
    ASSIGN_OR_RETURN(const auto air, air_of(view.any()));
    RETURN_IF_ERROR(
        check_lengths(view.any().range_m, "the stored range", view.any().sweep, air->extent));
    for (const QueryRow* row : view.rows) {
      ASSIGN_OR_RETURN(const auto condition, air->air.condition_of(row->signature));
      view.condition.push_back(condition);
      ASSIGN_OR_RETURN(auto spectrum, reader_.spectrum(row->signature.signature_id));
      view.spectra.push_back(std::move(spectrum));
      view.parts.emplace_back();
      if (air->extent.shape == nullptr || air->extent.shape->two_sided.size() < 2) continue;
      ASSIGN_OR_RETURN(auto parts, reader_.parts(row->signature.signature_id));
      view.parts.back() = std::move(parts);
    }
    list.emplace_back(air, &view);
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
      return air.lines({0, elevation_deg, range_m}, conditions, true, nullptr);
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
