#include "schema/store/find_signatures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/sweep_table.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;
// A viewpoint on the edge of the cap belongs to it, whatever the last bits of both directions are.
constexpr double kEdge_deg = 1e-9;

// Where the columns of signature_view are, by name: found once for all rows.
class SignatureReader {
 public:
  [[nodiscard]] absl::StatusOr<StoredSignature> read(Rows& rows) {
    rows_ = &rows;
    if (!placed_) IRSIG_STORE_TRY(find_places());
    StoredSignature s{};
    for (std::size_t i = 0; i < kQuantities.size(); ++i) {
      rows.read_at(quantity_[i]);
      s.*kQuantityMember[i] = rows.is_null() ? kNotComputed : rows.real();
    }
    next_ = 0;
    s.signature_id = at().integer();
    s.row = at().count();
    for (std::string* text : {&s.sweep, &s.season, &s.time_utc, &s.band}) *text = at().text();
    s.mean_solar_time = text_if_known();
    for (double* number :
         {&s.lambda_min_um, &s.lambda_max_um, &s.aspect_azimuth_deg, &s.aspect_elevation_deg,
          &s.range_m, &s.sun_azimuth_deg, &s.sun_zenith_deg})
      *number = at().real();
    s.dominant_inputs = text_if_known();
    s.reflections = count_if_known();
    s.stop_reason = at().text();
    s.limiting_bound = text_if_known();
    s.energy_gain = at().integer() != 0;
    s.warning = at().text();
    s.samples = at().count();
    s.replicates = static_cast<std::uint32_t>(at().integer());
    s.target_paths = at().count();
    s.rays = at().count();
    s.seconds = at().real();
    s.guarded_backface_hits = at().count();
    s.guarded_nonfinite = at().count();
    s.truncated_paths = at().count();
    s.guarded_negative = count_if_known();
    s.job_key = at().text();
    s.superseded = at().integer() != 0;
    s.seed_hex = at().text();
    s.physics_version = static_cast<std::uint32_t>(at().integer());
    s.determinism_class = at().text();
    s.build_id = at().text();
    const UnitVector unit = unit_vector(s.aspect_azimuth_deg, s.aspect_elevation_deg);
    s.unit_x = unit.x;
    s.unit_y = unit.y;
    s.unit_z = unit.z;
    return s;
  }

 private:
  // Columns of signature_view, in the order in which read() takes them.
  static constexpr auto kOthers = std::to_array<std::string_view>({"signature_id",
                                                                   "row",
                                                                   "sweep",
                                                                   "season",
                                                                   "time_utc",
                                                                   "band",
                                                                   "mean_solar_time",
                                                                   "lambda_min_um",
                                                                   "lambda_max_um",
                                                                   "aspect_azimuth_deg",
                                                                   "aspect_elevation_deg",
                                                                   "range_m",
                                                                   "sun_azimuth_deg",
                                                                   "sun_zenith_deg",
                                                                   "dominant_inputs",
                                                                   "reflections",
                                                                   "stop_reason",
                                                                   "limiting_bound",
                                                                   "energy_gain",
                                                                   "warning",
                                                                   "samples",
                                                                   "replicates",
                                                                   "target_paths",
                                                                   "rays",
                                                                   "seconds",
                                                                   "guarded_backface_hits",
                                                                   "guarded_nonfinite",
                                                                   "truncated_paths",
                                                                   "guarded_negative",
                                                                   "job_key",
                                                                   "superseded",
                                                                   "seed_hex",
                                                                   "physics_version",
                                                                   "determinism_class",
                                                                   "build_id"});

  absl::Status find_places() {
    for (std::size_t i = 0; i < kQuantities.size(); ++i)
      quantity_[i] = rows_->place_of(kQuantities[i].name);
    for (std::size_t i = 0; i < kOthers.size(); ++i) other_[i] = rows_->place_of(kOthers[i]);
    for (const int place : quantity_)
      if (place < 0) return absl::InternalError("signature_view lacks a quantity");
    for (const int place : other_)
      if (place < 0) return absl::InternalError("signature_view lacks a column");
    placed_ = true;
    return absl::OkStatus();
  }

  Rows& at() {
    rows_->read_at(other_[next_++]);
    return *rows_;
  }
  std::string text_if_known() {
    Rows& rows = at();
    return rows.is_null() ? std::string() : rows.text();
  }
  std::optional<std::uint64_t> count_if_known() {
    Rows& rows = at();
    if (rows.is_null()) return std::nullopt;
    return rows.count();
  }

  Rows* rows_ = nullptr;
  bool placed_ = false;
  std::array<int, kQuantities.size()> quantity_{};
  std::array<int, kOthers.size()> other_{};
  std::size_t next_ = 0;
};

using Ids = std::vector<std::int64_t>;

absl::Status append_ids(absl::StatusOr<Rows> rows, Ids& out) {
  if (!rows.ok()) return rows.status();
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, rows->next());
    if (!found) return absl::OkStatus();
    out.push_back(rows->integer());
  }
}

absl::Status append_viewpoint(Database& database, const SignatureFilter& filter,
                              std::int64_t viewpoint_id, Ids& out) {
  return append_ids(
      database.query(sql::find_signatures_of_viewpoint, filter.sweep, filter.season.json(),
                     filter.time_utc, filter.band, filter.max_relative_error, filter.row,
                     static_cast<int>(filter.error_of), filter.range_m, viewpoint_id),
      out);
}

struct Candidate {
  double angle_deg;
  std::string sweep;
  std::int64_t viewpoint_index;
  std::int64_t viewpoint_id;
};

// Accurate at every angle, unlike the arc cosine near 0 and 180 degrees.
double angle_between_deg(const UnitVector& a, const UnitVector& b) {
  const double x = a.y * b.z - a.z * b.y;
  const double y = a.z * b.x - a.x * b.z;
  const double z = a.x * b.y - a.y * b.x;
  return std::atan2(std::sqrt(x * x + y * y + z * z), a.x * b.x + a.y * b.y + a.z * b.z) *
         kDegPerRad;
}

// The viewpoints within a cap, nearest first: step one takes a box around the cap from the tree,
// step two the angle.
absl::StatusOr<std::vector<Candidate>> viewpoints_within(Database& database,
                                                         const std::string& sweep,
                                                         const UnitVector& center,
                                                         double radius_deg) {
  // The chord, widened by what the tree's float32 boxes and the vectors' rounding may hide.
  const double reach = 2 * std::sin(std::min(radius_deg, 180.0) / 2 / kDegPerRad) + 1e-6;
  ASSIGN_OR_RETURN(Rows rows, database.query(sql::viewpoints_in_box, center.x - reach,
                                             center.x + reach, center.y - reach, center.y + reach,
                                             center.z - reach, center.z + reach, sweep));
  std::vector<Candidate> found;
  for (;;) {
    ASSIGN_OR_RETURN(const bool next, rows.next());
    if (!next) break;
    Candidate candidate{};
    candidate.viewpoint_id = rows.integer();
    candidate.viewpoint_index = rows.integer();
    candidate.sweep = rows.text();
    UnitVector unit{};
    unit.x = rows.real();
    unit.y = rows.real();
    unit.z = rows.real();
    candidate.angle_deg = angle_between_deg(center, unit);
    if (candidate.angle_deg <= radius_deg + kEdge_deg) found.push_back(std::move(candidate));
  }
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.angle_deg, a.sweep, a.viewpoint_index) <
           std::tie(b.angle_deg, b.sweep, b.viewpoint_index);
  });
  return found;
}

absl::StatusOr<Ids> find_within(Database& database, const SignatureFilter& filter,
                                const UnitVector& center, double radius_deg) {
  ASSIGN_OR_RETURN(const std::vector<Candidate> candidates,
                   viewpoints_within(database, filter.sweep, center, radius_deg));
  Ids out;
  for (const Candidate& candidate : candidates) {
    IRSIG_STORE_TRY(append_viewpoint(database, filter, candidate.viewpoint_id, out));
  }
  return out;
}

// The nearest viewpoints that have a signature passing the other filters: the cap grows until it
// holds enough of them. Whatever lies outside a cap is farther away than all inside, so the first
// cap that suffices is certain.
absl::StatusOr<Ids> find_nearest(Database& database, const SignatureFilter& filter,
                                 const UnitVector& center) {
  ASSIGN_OR_RETURN(const std::int64_t viewpoints, database.integer(sql::viewpoints_at_most));
  // Radius of a cap that holds four times as many as wanted if they lie evenly on the sphere: its
  // share of the sphere is sin^2(radius / 2).
  const double share = 4.0 * filter.nearest / std::max(1.0, static_cast<double>(viewpoints));
  double radius_deg = 2 * std::asin(std::sqrt(std::min(1.0, share))) * kDegPerRad;
  Ids out;
  std::uint32_t hits = 0;
  double searched_deg = -1;  // candidates up to here were looked at in an earlier, smaller cap
  for (;;) {
    ASSIGN_OR_RETURN(const std::vector<Candidate> candidates,
                     viewpoints_within(database, filter.sweep, center, radius_deg));
    for (const Candidate& candidate : candidates) {
      if (candidate.angle_deg <= searched_deg) continue;
      const std::size_t before = out.size();
      IRSIG_STORE_TRY(append_viewpoint(database, filter, candidate.viewpoint_id, out));
      if (out.size() > before && ++hits == filter.nearest) return out;
    }
    if (radius_deg >= 180) return out;
    searched_deg = radius_deg + kEdge_deg;
    radius_deg = std::min(180.0, radius_deg * 2);
  }
}

absl::StatusOr<Ids> find_row(Database& database, const SignatureFilter& filter) {
  Ids viewpoint_ids;
  IRSIG_STORE_TRY(
      append_ids(database.query(sql::viewpoints_at_row, filter.sweep, *filter.row), viewpoint_ids));
  Ids out;
  for (const std::int64_t id : viewpoint_ids)
    IRSIG_STORE_TRY(append_viewpoint(database, filter, id, out));
  return out;
}

}  // namespace

absl::StatusOr<std::vector<std::int64_t>> find_signature_ids(Database& database,
                                                             const SignatureFilter& filter) {
  if (filter.nearest > 0 && filter.within_deg) {
    return absl::InvalidArgumentError(
        "either the nearest viewpoints or those within an angle, not both");
  }
  if (!filter.direction) {
    if (filter.nearest > 0 || filter.within_deg) {
      return absl::InvalidArgumentError("nearest and within need a direction");
    }
    if (filter.row) return find_row(database, filter);
    Ids out;
    IRSIG_STORE_TRY(
        append_ids(database.query(sql::find_signatures, filter.sweep, filter.season.json(),
                                  filter.time_utc, filter.band, filter.max_relative_error,
                                  filter.row, static_cast<int>(filter.error_of), filter.range_m),
                   out));
    return out;
  }
  const auto [azimuth_deg, elevation_deg] = *filter.direction;
  if (!std::isfinite(azimuth_deg) || !(std::abs(elevation_deg) <= 90)) {
    return absl::InvalidArgumentError(
        "a direction has a finite azimuth and an elevation from -90 to 90 degrees");
  }
  const UnitVector center = unit_vector(azimuth_deg, elevation_deg);
  if (filter.nearest > 0) return find_nearest(database, filter, center);
  const double radius_deg = filter.within_deg.value_or(180);
  if (!(radius_deg >= 0))
    return absl::InvalidArgumentError("within: expected an angle of 0 degrees or more");
  return find_within(database, filter, center, radius_deg);
}

absl::StatusOr<std::vector<StoredSignature>> read_signatures(Database& database,
                                                             std::span<const std::int64_t> ids) {
  std::vector<StoredSignature> out;
  out.reserve(ids.size());
  SignatureReader reader;
  for (const std::int64_t id : ids) {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::signature_by_id, id));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return absl::NotFoundError(absl::StrCat("no signature ", id));
    ASSIGN_OR_RETURN(StoredSignature signature, reader.read(row));
    out.push_back(std::move(signature));
  }
  return out;
}

}  // namespace irsig
