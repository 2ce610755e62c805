#include "view/report/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "view/base/table.h"
#include "view/query/query.h"

namespace irsig {
namespace {

using Rows = std::vector<StoredProfileRow>;

struct ProfileColumn {
  Column column;
  std::function<Cell(const StoredProfileRow&)> cell;
};

template <typename T>
ProfileColumn stored_column(const char* name, T StoredProfileRow::*field, bool brief) {
  return {{name, brief}, [field](const StoredProfileRow& row) -> Cell { return row.*field; }};
}

std::vector<ProfileColumn> columns() {
  using R = StoredProfileRow;
  std::vector<ProfileColumn> out{
      stored_column("row", &R::row, true),
      stored_column("sweep", &R::sweep, false),
      stored_column("season", &R::season, true),
      stored_column("time_utc", &R::time_utc, false),
      stored_column("band", &R::band, true),
      stored_column("aspect_azimuth_deg", &R::aspect_azimuth_deg, false),
      stored_column("aspect_elevation_deg", &R::aspect_elevation_deg, false),
      stored_column("range_m", &R::range_m, false),
      stored_column("profile", &R::profile, true),
      stored_column("point_index", &R::point_index, true),
      stored_column("x_m", &R::x_m, true),
      stored_column("y_m", &R::y_m, true),
      stored_column("z_m", &R::z_m, true),
      stored_column("reflections", &R::reflections, true),
      stored_column("radiance_w_m2_sr", &R::radiance_w_m2_sr, true),
      stored_column("radiance_stderr_w_m2_sr", &R::radiance_stderr_w_m2_sr, true),
      stored_column("source_radiance_temperature_k", &R::source_radiance_temperature_k, true),
      stored_column("source_radiance_temperature_stderr_k",
                    &R::source_radiance_temperature_stderr_k, true),
      stored_column("apparent_radiance_w_m2_sr", &R::apparent_radiance_w_m2_sr, false),
      stored_column("apparent_radiance_stderr_w_m2_sr", &R::apparent_radiance_stderr_w_m2_sr,
                    false),
      stored_column("truncation_bound_w_m2_sr", &R::truncation_bound_w_m2_sr, false),
      stored_column("quadrature_bound_w_m2_sr", &R::quadrature_bound_w_m2_sr, false),
      stored_column("target_fraction", &R::target_fraction, false),
      stored_column("footprint_width_m", &R::footprint_width_m, false),
      stored_column("footprint_height_m", &R::footprint_height_m, false),
      stored_column("lambda_min_um", &R::lambda_min_um, false),
      stored_column("lambda_max_um", &R::lambda_max_um, false),
      stored_column("samples", &R::samples, false),
      stored_column("replicates", &R::replicates, false),
      stored_column("energy_gain", &R::energy_gain, false),
      stored_column("job_key", &R::job_key, false),
      stored_column("seed_hex", &R::seed_hex, false),
      stored_column("physics_version", &R::physics_version, false),
      stored_column("determinism_class", &R::determinism_class, false),
      stored_column("build_id", &R::build_id, false)};
  // 0 K stands for "no radiance": there is no such temperature.
  for (ProfileColumn& c : out) {
    if (c.column.name != "source_radiance_temperature_k" &&
        c.column.name != "source_radiance_temperature_stderr_k")
      continue;
    c.cell = [inner = std::move(c.cell)](const StoredProfileRow& row) -> Cell {
      return row.source_radiance_temperature_k == 0 ? Cell() : inner(row);
    };
  }
  return out;
}

// Rows that stand in one table: the same sweep, viewpoint, condition and band.
std::map<std::pair<std::string, std::uint64_t>, Rows> by_signature(const Rows& rows) {
  std::map<std::pair<std::string, std::uint64_t>, Rows> out;
  for (const StoredProfileRow& r : rows) out[{r.sweep, r.row}].push_back(r);
  return out;
}

std::map<std::uint64_t, Rows> by_profile(const Rows& rows) {
  std::map<std::uint64_t, Rows> out;
  for (const StoredProfileRow& r : rows) out[r.profile_index].push_back(r);
  return out;
}

bool is_line(const Rows& profile) {
  return std::any_of(profile.begin(), profile.end(),
                     [](const StoredProfileRow& r) { return r.point_index > 0; });
}

std::string heading(const StoredProfileRow& r) {
  return fmt::format(
      "{}: {} {}, {} ({:g} to {:g} um), from azimuth {:g} deg, elevation {:g} deg, range {:g} m\n",
      r.sweep, r.season, r.time_utc, r.band, r.lambda_min_um, r.lambda_max_um, r.aspect_azimuth_deg,
      r.aspect_elevation_deg, r.range_m);
}

std::string point_table(const std::map<std::uint64_t, Rows>& profiles) {
  std::set<std::uint64_t> reflections;
  std::size_t name_width = 7;
  double worst_stderr_k = 0;
  for (const auto& [index, rows] : profiles) {
    if (is_line(rows)) continue;
    name_width = std::max(name_width, rows.front().profile.size());
    for (const StoredProfileRow& r : rows) {
      reflections.insert(r.reflections);
      worst_stderr_k = std::max(worst_stderr_k, r.source_radiance_temperature_stderr_k);
    }
  }
  if (reflections.empty()) return "";
  std::string out = fmt::format(
      "Source radiance temperature in K after N reflections (standard error {:.2g} mK at most)\n"
      "  {:<{}}",
      1000 * worst_stderr_k, "profile", name_width);
  for (const std::uint64_t n : reflections) out += fmt::format("  {:>7}", fmt::format("N={}", n));
  out += '\n';
  for (const auto& [index, rows] : profiles) {
    if (is_line(rows)) continue;
    out += fmt::format("  {:<{}}", rows.front().profile, name_width);
    for (const std::uint64_t n : reflections) {
      const auto found =
          std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.reflections == n; });
      out += found == rows.end() || found->source_radiance_temperature_k == 0
                 ? fmt::format("  {:>7}", "-")
                 : fmt::format("  {:7.3f}", found->source_radiance_temperature_k);
    }
    out += '\n';
  }
  return out;
}

std::string line_extent(const Rows& profile) {
  const std::uint64_t most = profile.back().reflections;
  const StoredProfileRow *coldest = nullptr, *hottest = nullptr;
  std::uint64_t points = 0;
  for (const StoredProfileRow& r : profile) {
    if (r.reflections != most) continue;
    ++points;
    if (r.source_radiance_temperature_k == 0) continue;
    if (!coldest || r.source_radiance_temperature_k < coldest->source_radiance_temperature_k)
      coldest = &r;
    if (!hottest || r.source_radiance_temperature_k > hottest->source_radiance_temperature_k)
      hottest = &r;
  }
  if (!coldest)
    return fmt::format("  {}: {} points, no radiance\n", profile.front().profile, points);
  return fmt::format("  {}: {} points, N={}: {:.2f} K (point {}) to {:.2f} K (point {})\n",
                     profile.front().profile, points, most, coldest->source_radiance_temperature_k,
                     coldest->point_index, hottest->source_radiance_temperature_k,
                     hottest->point_index);
}

// The text in lines of at most `width` characters, each indented.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string out, line;
  const auto flush = [&] {
    if (!line.empty()) out += std::string(indent, ' ') + line + '\n';
    line.clear();
  };
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (!word.empty()) {
      if (!line.empty() && indent + line.size() + 1 + word.size() > width) flush();
      line += (line.empty() ? "" : " ") + word;
    }
    begin = end + 1;
  }
  flush();
  return out;
}

std::string comparison(const StoredPublished& p, const StoredProfileRow& ours) {
  const double difference = ours.source_radiance_temperature_k - p.source_radiance_temperature_k;
  const bool below = p.relation == "below", above = p.relation == "above";
  std::string theirs = fmt::format("{}{:g}",
                                   below   ? "< "
                                   : above ? "> "
                                           : "",
                                   p.source_radiance_temperature_k);
  std::string verdict = fmt::format("{:+.3f} K", difference);
  if (below) verdict += difference < 0 ? ", agrees" : ", does not agree";
  if (above) verdict += difference > 0 ? ", agrees" : ", does not agree";
  std::string out = fmt::format("  {:<24} {:>3}  {:>11}  {:>9.3f} +- {:.3f}  {}\n",
                                ours.point_index > 0 || p.point_index > 0
                                    ? fmt::format("{} [{}]", p.profile, p.point_index)
                                    : p.profile,
                                p.reflections, theirs, ours.source_radiance_temperature_k,
                                ours.source_radiance_temperature_stderr_k, verdict);
  out += wrapped(p.source, 6, 100);
  if (!p.remark.empty()) out += wrapped("Why: " + p.remark, 6, 100);
  return out;
}

}  // namespace

absl::StatusOr<Rows> find_profiles(StoreReader& reader, const ProfileQuery& query) {
  ASSIGN_OR_RETURN(auto rows, reader.profiles(query.filter));
  if (query.row) std::erase_if(rows, [&](const auto& r) { return r.row != *query.row; });
  const bool several = query.filter.season.names().size() > 1;
  if (!rows.empty() && !several) return rows;
  ASSIGN_OR_RETURN(const auto all, reader.profiles({}));
  std::set<std::string> names, seasons;
  for (const StoredProfileRow& r : all) {
    names.insert(fmt::format("{} ({}, {}, row {})", r.profile, r.season, r.band, r.row));
    seasons.insert(r.season);
  }
  if (names.empty()) return absl::NotFoundError("the database holds no profile");
  RETURN_IF_ERROR(check_seasons(query.filter.season, seasons));
  if (!rows.empty()) return rows;
  return absl::NotFoundError(
      fmt::format("no profile matches; there are: {}", fmt::join(names, ", ")));
}

absl::Status write_profiles(const Rows& rows, std::string_view format, std::ostream& out) {
  const std::vector<ProfileColumn> all = columns();
  std::vector<Column> heads;
  for (const ProfileColumn& c : all) heads.push_back(c.column);
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
  for (const StoredProfileRow& row : rows) {
    std::vector<Cell> cells;
    for (const ProfileColumn& c : all) cells.push_back(c.cell(row));
    writer->row(cells);
  }
  return writer->finish();
}

std::vector<std::string> profile_notes(const Rows& rows, const schema::Sweep& sweep) {
  std::vector<std::string> out;
  for (const schema::Profile& profile : sweep.profile()) {
    const double asked_k = profile.source_radiance_temperature_stderr_k();
    if (!(asked_k > 0)) continue;  // a number of samples was asked for
    std::size_t count = 0, above = 0;
    double worst_k = 0;
    for (const StoredProfileRow& r : rows) {
      if (r.sweep != sweep.name() || r.profile != profile.name()) continue;
      ++count;
      if (!(r.source_radiance_temperature_stderr_k > asked_k)) continue;
      ++above;
      worst_k = std::max(worst_k, r.source_radiance_temperature_stderr_k);
    }
    if (above > 0)
      out.push_back(fmt::format(
          "profile \"{}\": {} of {} rows miss the standard error asked for: {:.2g} mK at most, "
          "{:.2g} mK asked",
          profile.name(), above, count, 1000 * worst_k, 1000 * asked_k));
  }
  return out;
}

std::string profile_summary(const Rows& rows, const std::vector<StoredPublished>& published) {
  std::string out;
  for (const auto& [place, signature] : by_signature(rows)) {
    if (!out.empty()) out += '\n';
    out += heading(signature.front());
    const auto profiles = by_profile(signature);
    out += point_table(profiles);
    bool first_line = true;
    for (const auto& [index, profile] : profiles) {
      if (!is_line(profile)) continue;
      if (first_line) out += "Source radiance temperature along a line\n";
      first_line = false;
      out += line_extent(profile);
    }
    std::string beside;
    for (const StoredPublished& p : published) {
      if (p.sweep != signature.front().sweep) continue;
      for (const StoredProfileRow& r : signature)
        if (r.profile == p.profile && r.point_index == p.point_index &&
            r.reflections == p.reflections)
          beside += comparison(p, r);
    }
    if (!beside.empty())
      out += fmt::format("Beside what is published, in K\n  {:<24} {:>3}  {:>11}  {:>9} {:8}  {}\n",
                         "profile", "N", "published", "irsig", "", "irsig - published") +
             beside;
  }
  return printable(out);
}

}  // namespace irsig
