#include "view/query/query.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"
#include "core/geo/viewpoint.h"
#include "view/base/progress.h"
#include "view/moved/range_change.h"
#include "view/query/interpolate_rows.h"

namespace irsig {
namespace {

absl::Status check(const Query& query) {
  const int ways = (query.nearest > 0) + query.within_deg.has_value() + query.interpolate;
  if (query.aspect && ways != 1) {
    return absl::InvalidArgumentError(
        "--aspect needs exactly one of --nearest N, --within DEG and --interpolate");
  }
  if (!query.aspect && ways > 0) {
    return absl::InvalidArgumentError("--nearest, --within and --interpolate need --aspect AZ,EL");
  }
  if (query.aspect) {
    const auto [azimuth, elevation] = *query.aspect;
    if (!(std::abs(azimuth) <= 360) || !(std::abs(elevation) <= 90)) {
      return absl::InvalidArgumentError(
          fmt::format("aspect {},{}: expected azimuth in [-360, 360] and elevation in [-90, 90] "
                      "deg",
                      azimuth, elevation));
    }
  }
  if (query.within_deg && !(*query.within_deg > 0 && *query.within_deg <= 180)) {
    return absl::InvalidArgumentError(
        fmt::format("within {} deg: expected more than 0, at most 180", *query.within_deg));
  }
  if (query.max_relative_error && !(*query.max_relative_error > 0)) {
    return absl::InvalidArgumentError(
        fmt::format("max relative error {}: expected more than 0", *query.max_relative_error));
  }
  if (!query.range_m.empty() && query.interpolate) {
    return absl::InvalidArgumentError(
        "an interpolated row cannot be moved to another range: give one of the two");
  }
  if (query.row && query.interpolate) {
    return absl::InvalidArgumentError("a row cannot be interpolated: give the row or an aspect");
  }
  return absl::OkStatus();
}

// Rows whose error the query accepts.
void keep_exact(std::vector<QueryRow>& rows, const Query& query) {
  if (!query.max_relative_error) return;
  const QuantityColumns& q = columns_of(query.quantity);
  std::erase_if(rows, [&](const QueryRow& r) {
    return !(r.signature.*q.numerical_error <=
             *query.max_relative_error * std::abs(r.signature.*q.value));
  });
}

// "; did you mean "lwir"?" of "LWIR".
std::string in_other_case(const std::string& name, const std::set<std::string>& known) {
  for (const std::string& k : known)
    if (absl::EqualsIgnoreCase(name, k)) return fmt::format("; did you mean \"{}\"?", k);
  return "";
}

absl::Status check_known(std::string_view what, const NameSet& asked,
                         const std::set<std::string>& known) {
  for (const std::string& name : asked.names())
    if (!known.contains(name))
      return absl::NotFoundError(fmt::format("no {} \"{}\" in this database; there is: {}{}", what,
                                             name, absl::StrJoin(known, ", "),
                                             in_other_case(name, known)));
  return absl::OkStatus();
}

}  // namespace

std::vector<std::string> notes_on(const std::vector<QueryRow>& rows) {
  std::vector<std::string> out;
  std::size_t old = 0, behind = 0;
  double largest_fraction = 0;
  std::string back_faces;
  for (const QueryRow& row : rows) {
    const StoredSignature& s = row.signature;
    if (std::isnan(s.contrast_intensity_w_sr)) ++old;
    if (s.warning.empty()) continue;
    std::vector<std::string> lines = absl::StrSplit(s.warning, '\n');
    if (s.backface_fraction > 0) {
      // The view's, not the condition's: the store puts it last.
      ++behind;
      largest_fraction = std::max(largest_fraction, s.backface_fraction);
      back_faces = lines.back();
      lines.pop_back();
    }
    for (const std::string& line : lines) {
      std::string note = fmt::format("{} {}: {}", s.season, s.time_utc, line);
      if (std::find(out.begin(), out.end(), note) == out.end()) out.push_back(std::move(note));
    }
  }
  if (behind > 0)
    out.push_back(fmt::format("{} of {} rows, up to {:.3g} % of the silhouette: {}", behind,
                              rows.size(), 100 * largest_fraction, back_faces));
  if (old > 0)
    out.push_back(
        fmt::format("{} of {} rows were stored by an older irsig, which did not compute "
                    "contrast, background and path (run the sweep again to have them)",
                    old, rows.size()));
  return out;
}

std::string far_note(const std::vector<QueryRow>& rows, const Query& query) {
  if (!query.aspect) return "";
  const auto [azimuth_deg, elevation_deg] = *query.aspect;
  const Vec<Body> asked = body_from_aspect(azimuth_deg, elevation_deg);
  double farthest_deg = 0, lowest_deg = 90, highest_deg = -90;
  for (const QueryRow& row : rows) {
    const StoredSignature& s = row.signature;
    const Vec<Body> is = body_from_aspect(s.aspect_azimuth_deg, s.aspect_elevation_deg);
    farthest_deg = std::max(farthest_deg, std::atan2(length(cross(asked, is)), dot(asked, is)) *
                                              180 / std::numbers::pi);
    if (!row.interpolation) continue;
    for (const StoredSignature& from : row.interpolation->from) {
      lowest_deg = std::min(lowest_deg, from.aspect_elevation_deg);
      highest_deg = std::max(highest_deg, from.aspect_elevation_deg);
    }
  }
  if (query.nearest > 0 && farthest_deg > 30)
    return fmt::format("the viewpoints found are up to {:.0f} deg away from aspect {:g},{:g}",
                       farthest_deg, azimuth_deg, elevation_deg);
  if (query.interpolate && lowest_deg <= highest_deg &&
      (elevation_deg > highest_deg + 0.1 || elevation_deg < lowest_deg - 0.1))
    return fmt::format(
        "elevation {:g} deg lies beyond the viewpoints' ({:.2f} to {:.2f} deg): "
        "interpolated across the pole, with the error of that",
        elevation_deg, lowest_deg, highest_deg);
  return "";
}

absl::Status check_seasons(StoreReader& reader, const NameSet& season) {
  if (season.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto contents, reader.contents());
  std::set<std::string> known;
  for (const SweepContents& sweep : contents)
    for (const SweepContents::Condition& c : sweep.condition) known.insert(c.season);
  return known.empty() ? absl::OkStatus() : check_seasons(season, known);
}

absl::Status check_seasons(const NameSet& season, const std::set<std::string>& known) {
  return check_known("season", season, known);
}

// Each name is looked for among the signatures
// that match what stands left of it in sweep > season > time > band.
absl::Status explain_nothing(StoreReader& reader, const SignatureFilter& asked) {
  ASSIGN_OR_RETURN(const auto contents, reader.contents());
  std::set<std::string> sweeps, seasons, times, bands;
  std::set<double> ranges_m;
  std::uint64_t rows = 0, last_row = 0;
  for (const SweepContents& sweep : contents) {
    rows += sweep.rows;
    last_row = std::max(last_row, sweep.whole_rows);
    sweeps.insert(sweep.name);
    for (const SweepContents::Condition& c : sweep.condition) {
      seasons.insert(c.season);
      times.insert(c.time_utc);
    }
    for (const SweepContents::Band& b : sweep.band) bands.insert(b.name);
    if (asked.sweep.empty() || sweep.name == asked.sweep)
      ranges_m.insert(sweep.range_m.begin(), sweep.range_m.end());
  }
  if (rows == 0) return absl::OkStatus();
  for (const absl::Status& status :
       {check_known("sweep", asked.sweep, sweeps), check_known("season", asked.season, seasons),
        check_known("time", asked.time_utc, times), check_known("band", asked.band, bands)}) {
    if (!status.ok()) return status;
  }
  if (asked.range_m && !ranges_m.contains(*asked.range_m))
    return absl::NotFoundError(fmt::format("no viewpoint at {} m in this database; there is: {} m",
                                           *asked.range_m, fmt::join(ranges_m, ", ")));
  if (asked.row) {
    SignatureFilter alone;
    alone.row = asked.row;
    ASSIGN_OR_RETURN(const auto there, reader.find_ids(alone));
    if (there.empty())
      return absl::NotFoundError(
          *asked.row >= 1 && *asked.row <= last_row
              ? fmt::format("row {} is not in this database, or not yet", *asked.row)
              : fmt::format("no row {} in this database; the last one is {}", *asked.row,
                            last_row));
  }
  return absl::OkStatus();
}

absl::StatusOr<SignatureFilter> filter_of(const Query& query) {
  RETURN_IF_ERROR(check(query));
  SignatureFilter filter;
  filter.sweep = query.sweep;
  filter.season = query.season;
  filter.band = query.band;
  filter.row = query.row;
  filter.range_m = query.at_range_m;
  if (!query.time.empty()) {
    ASSIGN_OR_RETURN(auto time, parse_rfc3339(query.time));
    filter.time_utc = format_rfc3339_utc(time);
  }
  if (!query.interpolate) {
    filter.direction = query.aspect;
    filter.nearest = query.nearest;
    filter.within_deg = query.within_deg;
    // Moving to another range changes the errors.
    if (query.range_m.empty()) filter.max_relative_error = query.max_relative_error;
    filter.error_of = query.quantity;
  }
  return filter;
}

namespace {

// Stored rows, as they are or as seen from other ranges.
class StoredRows final : public QueryRows {
 public:
  StoredRows(StoreReader& reader, Query query, const ExtentOf& extent_of,
             std::vector<std::int64_t> ids)
      : reader_(reader), query_(std::move(query)), ids_(std::move(ids)) {
    if (!query_.range_m.empty())
      changer_ = std::make_unique<RangeChanger>(reader, query_.range_m, extent_of);
  }

  std::size_t count() const override {
    return ids_.size() * std::max<std::size_t>(1, query_.range_m.size());
  }

  absl::StatusOr<std::vector<QueryRow>> next() override {
    // A thousand rows hold 2 MB, and a moved one its spectrum, too.
    constexpr std::size_t kAtOnce = 1000, kMovedAtOnce = 200;
    std::vector<QueryRow> rows;
    while (rows.empty() && done_ < ids_.size()) {
      const std::size_t n = std::min(ids_.size() - done_, changer_ ? kMovedAtOnce : kAtOnce);
      auto found = reader_.read({ids_.data() + done_, n});
      if (absl::IsNotFound(found.status()))
        return absl::AbortedError("rows were replaced while they were read: try again");
      if (!found.ok()) return found.status();
      done_ += n;
      for (auto& s : *found) rows.push_back({std::move(s), std::nullopt});
      if (!changer_) continue;
      ASSIGN_OR_RETURN(rows, changer_->moved(std::move(rows)));
      keep_exact(rows, query_);
    }
    return rows;
  }

 private:
  StoreReader& reader_;
  const Query query_;
  const std::vector<std::int64_t> ids_;
  std::unique_ptr<RangeChanger> changer_;
  std::size_t done_ = 0;
};

class GivenRows final : public QueryRows {
 public:
  explicit GivenRows(std::vector<QueryRow> rows) : rows_(std::move(rows)), count_(rows_.size()) {}
  std::size_t count() const override { return count_; }
  absl::StatusOr<std::vector<QueryRow>> next() override { return std::exchange(rows_, {}); }

 private:
  std::vector<QueryRow> rows_;
  std::size_t count_;
};

// Rows of one season of several would hide that another one does not exist.
absl::Status check_several_seasons(StoreReader& reader, const NameSet& season) {
  return season.names().size() > 1 ? check_seasons(reader, season) : absl::OkStatus();
}

// NOT_FOUND if there is nothing of that name.
absl::StatusOr<std::vector<std::int64_t>> matching_ids(StoreReader& reader, const Query& query) {
  RETURN_IF_ERROR(check_several_seasons(reader, query.season));
  ASSIGN_OR_RETURN(const auto filter, filter_of(query));
  auto ids = reader.find_ids(filter);
  if (ids.ok() && ids->empty()) RETURN_IF_ERROR(explain_nothing(reader, filter));
  return ids;
}

absl::StatusOr<std::vector<QueryRow>> all_of(QueryRows& rows, const Query& query) {
  std::optional<LoopProgress> progress;
  if (!query.range_m.empty()) progress.emplace("rows moved", rows.count());
  std::vector<QueryRow> all;
  for (;;) {
    ASSIGN_OR_RETURN(auto some, rows.next());
    if (some.empty()) return all;
    if (progress) progress->step(some.size());
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<QueryRows>> QueryRows::open(StoreReader& reader, const Query& query,
                                                           const ExtentOf& extent_of) {
  if (query.interpolate) {
    RETURN_IF_ERROR(check_several_seasons(reader, query.season));
    ASSIGN_OR_RETURN(const auto filter, filter_of(query));
    ASSIGN_OR_RETURN(auto found, reader.find(filter));
    std::vector<QueryRow> rows;
    if (!found.empty()) {
      ASSIGN_OR_RETURN(rows, interpolate_rows(found, *query.aspect));
      keep_exact(rows, query);
    } else if (absl::Status status = explain_nothing(reader, filter); !status.ok()) {
      return status;
    }
    return std::make_unique<GivenRows>(std::move(rows));
  }
  ASSIGN_OR_RETURN(auto ids, matching_ids(reader, query));
  return std::make_unique<StoredRows>(reader, query, extent_of, std::move(ids));
}

absl::StatusOr<std::vector<QueryRow>> run_query(StoreReader& reader, const Query& query,
                                                const ExtentOf& extent_of) {
  ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, query, extent_of));
  return all_of(*rows, query);
}

absl::StatusOr<SomeRows> run_query_of_some(StoreReader& reader, const Query& query,
                                           std::size_t at_most, const ExtentOf& extent_of) {
  constexpr std::uint64_t kSeed = 20240229;
  ASSIGN_OR_RETURN(const auto ids, matching_ids(reader, query));
  std::vector<std::int64_t> drawn;  // in the order of the ids
  std::sample(ids.begin(), ids.end(), std::back_inserter(drawn), at_most, std::mt19937_64(kSeed));
  StoredRows some(reader, query, extent_of, std::move(drawn));
  ASSIGN_OR_RETURN(auto rows, all_of(some, query));
  return SomeRows{std::move(rows), ids.size()};
}

}  // namespace irsig
