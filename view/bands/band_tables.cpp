#include "view/bands/band_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "view/base/table.h"
#include "view/draw/axis.h"
#include "view/draw/svg.h"
#include "view/plot/plot_curves.h"

namespace irsig {
namespace {

// A window that is as good as the first with less than this is told from it.
constexpr double kTold = 0.05;

Cell number_cell(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

}  // namespace

std::string merit_name(const MeritOf& merit) {
  switch (merit.merit) {
    case Merit::kMean:
      return fmt::format("mean {}", merit.ratio);
    case Merit::kPercentile:
      return fmt::format("{} that all but {:g} % exceed", merit.ratio, merit.percentile);
    case Merit::kWorst:
      return fmt::format("worst {}", merit.ratio);
    case Merit::kAbove:
      return fmt::format("share with {} >= {:g}", merit.ratio, merit.threshold);
    case Merit::kRange:
      return fmt::format("range [m] up to which all but {:g} % have {} >= {:g}", merit.percentile,
                         merit.ratio, merit.threshold);
  }
  return "";
}

std::string title_of(const BandSearch& search, const Candidate& candidate) {
  const auto one = [&](Passband p) {
    return search.name(p).empty()
               ? fmt::format("{:.5g} to {:.5g}", search.lambda_min_um(p), search.lambda_max_um(p))
               : std::string(search.name(p));
  };
  std::string out = one(candidate.one);
  if (candidate.other) out += " and " + one(*candidate.other);
  return out + " um";
}

namespace {

// Columns and cells of a candidate.
void add_columns(const BandSearch& search, bool filters, std::vector<Column>& out) {
  if (filters) out.push_back({"filter"});
  out.insert(out.end(), {{"lambda_min_um"}, {"lambda_max_um"}});
  if (search.pairing() == Pairing::kNone) return;
  if (filters) out.push_back({"second_filter"});
  out.insert(out.end(), {{"second_min_um"}, {"second_max_um"}});
  if (search.pairing() == Pairing::kDifference)
    out.insert(out.end(), {{"gain"}, {"background_left", false}});
}
void add_cells(const BandSearch& search, bool filters, const Candidate& c, std::vector<Cell>& out) {
  const auto add = [&](Passband p) {
    if (filters) out.push_back(search.name(p).empty() ? Cell() : Cell(std::string(search.name(p))));
    out.insert(out.end(), {search.lambda_min_um(p), search.lambda_max_um(p)});
  };
  add(c.one);
  if (!c.other) return;
  add(*c.other);
  if (search.pairing() == Pairing::kDifference)
    out.insert(out.end(), {c.gain, search.background_left(c)});
}
bool any_filter(const BandSearch& search, const WindowChoice& choice) {
  return std::any_of(choice.candidate.begin(), choice.candidate.end(), [&](const auto& m) {
    return !search.name(m.of.one).empty() || (m.of.other && !search.name(*m.of.other).empty());
  });
}
std::vector<double> ranges_of(const BandPopulation& population) {
  std::vector<double> out;
  for (const BandCase& row : population.row) out.push_back(row.range_m);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

absl::Status write_choice(const BandSearch& search, const WindowChoice& choice,
                          std::string_view format, std::ostream& out) {
  const bool filters = any_filter(search, choice);
  const bool clutter = search.population().row.front().clutter.has_value();
  std::vector<Column> columns = {{"rank"}};
  add_columns(search, filters, columns);
  if (clutter) columns.push_back({"clutter_fraction"});
  columns.insert(columns.end(), {{"merit"},
                                 {"samples_stderr"},
                                 {"numerical_error"},
                                 {"total_error"},
                                 {"best_numerical", false},
                                 {"best"},
                                 {"as_good_numerical", false},
                                 {"as_good"},
                                 {"errors_alone", false},
                                 {"samples_to_tell", false}});
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, columns, out));
  std::uint64_t rank = 0;
  for (const CandidateMerit& m : choice.candidate) {
    std::vector<Cell> line = {++rank};
    add_cells(search, filters, m.of, line);
    if (clutter) line.emplace_back(search.clutter_fraction(m.of));
    line.insert(line.end(), {number_cell(m.of.merit), number_cell(m.samples_stderr),
                             number_cell(m.numerical_error), number_cell(m.total_error),
                             number_cell(m.best_numerical), number_cell(m.best),
                             number_cell(m.as_good_numerical), number_cell(m.as_good),
                             number_cell(m.errors_alone), number_cell(m.samples_to_tell)});
    writer->row(line);
  }
  return writer->finish();
}

absl::Status write_map(const BandSearch& search, const MeritOf& merit,
                       const BandSearch::Found& found, std::string_view format, std::ostream& out) {
  const bool one = search.pairing() == Pairing::kNone;
  const bool errors = one && merit.merit == Merit::kMean;
  std::vector<Column> columns = {{"lambda_min_um"}, {"lambda_max_um"}, {"merit"}};
  if (errors) columns.push_back({"samples_stderr"});
  if (!one) columns.insert(columns.end(), {{"second_min_um"}, {"second_max_um"}});
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, columns, out));
  for (const Candidate& c : found.map) {
    std::vector<Cell> line = {search.lambda_min_um(c.one), search.lambda_max_um(c.one),
                              number_cell(c.merit)};
    if (errors) line.push_back(number_cell(search.mean_stderr(c.one)));
    if (!one)
      line.insert(line.end(), {search.lambda_min_um(*c.other), search.lambda_max_um(*c.other)});
    writer->row(line);
  }
  return writer->finish();
}

absl::Status write_ranges(const BandSearch& search, const MeritOf& merit,
                          const WindowChoice& choice, std::string_view format, std::ostream& out) {
  const bool filters = any_filter(search, choice);
  std::vector<Column> columns = {{"rank"}};
  add_columns(search, filters, columns);
  columns.insert(columns.end(), {{"range_m"}, {"merit"}});
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, columns, out));
  std::uint64_t rank = 0;
  for (const CandidateMerit& m : choice.candidate) {
    ++rank;
    for (const double range_m : ranges_of(search.population())) {
      std::vector<Cell> line = {rank};
      add_cells(search, filters, m.of, line);
      line.insert(line.end(), {range_m, number_cell(search.merit_at(merit, m.of, range_m))});
      writer->row(line);
    }
  }
  return writer->finish();
}

std::string plot_ranges(const BandSearch& search, const MeritOf& merit, const WindowChoice& choice,
                        const std::string& title) {
  constexpr std::size_t kCurves = 5;
  CurvePanel panel{"", "range [km]", merit_name(merit), {}};
  for (const CandidateMerit& m : choice.candidate) {
    if (panel.curve.size() == kCurves) break;
    Curve curve{title_of(search, m.of), {}, {}};
    for (const double range_m : ranges_of(search.population())) {
      curve.x.push_back(range_m / 1000);
      curve.y.push_back(search.merit_at(merit, m.of, range_m));
    }
    curve.marks = true;
    panel.curve.push_back(std::move(curve));
  }
  return plot_curves(title, fmt::format("{} rows", search.population().row.size()), {panel}, 1);
}

absl::Status write_detection(const BandSearch& search, const WindowChoice& choice, double threshold,
                             std::string_view format, std::ostream& out) {
  const bool filters = any_filter(search, choice);
  std::vector<Column> columns = {{"rank"}};
  add_columns(search, filters, columns);
  columns.insert(columns.end(), {{"season"},
                                 {"time_utc"},
                                 {"aspect_azimuth_deg"},
                                 {"aspect_elevation_deg"},
                                 {"weight"},
                                 {"detection_range_m"},
                                 {"reach"}});
  ASSIGN_OR_RETURN(auto writer, make_table_writer(format, columns, out));
  std::uint64_t rank = 0;
  for (const CandidateMerit& m : choice.candidate) {
    ++rank;
    for (const BandSearch::Detection& d : search.detection(m.of, threshold)) {
      const BandCase& row = search.population().row[d.row];
      std::vector<Cell> line = {rank};
      add_cells(search, filters, m.of, line);
      const bool known = d.range_m > 0 && std::isfinite(d.range_m);
      line.insert(line.end(), {row.season, row.time_utc, row.aspect_azimuth_deg,
                               row.aspect_elevation_deg, d.weight, known ? Cell(d.range_m) : Cell(),
                               std::string(known           ? "between"
                                           : d.range_m > 0 ? "beyond the farthest"
                                                           : "below the nearest")});
      writer->row(line);
    }
  }
  return writer->finish();
}

std::string note_on_detection(const BandSearch& search, const WindowChoice& choice,
                              double threshold) {
  const Candidate& best = choice.candidate.front().of;
  auto seen = search.detection(best, threshold);
  std::sort(seen.begin(), seen.end(),
            [](const auto& a, const auto& b) { return a.range_m > b.range_m; });
  // As far as at least this share of the population.
  const auto at = [&](double share) {
    double sum = 0, m = seen.back().range_m;
    for (const auto& d : seen)
      if ((sum += d.weight) >= share * (1 - 1e-12)) {
        m = d.range_m;
        break;
      }
    return m == 0          ? std::string("below the nearest")
           : std::isinf(m) ? std::string("beyond the farthest")
                           : fmt::format("{:.4g} m", m);
  };
  return fmt::format("{} {:g} of {} is reached up to: 10 % of the population {}, half {}, 90 % {}",
                     search.population().row.front().clutter ? "SCNR" : "SNR", threshold,
                     title_of(search, best), at(0.1), at(0.5), at(0.9));
}

std::string plot_map_of_windows(const BandSearch& search, const MeritOf& merit,
                                const BandSearch::Found& found, const std::string& title) {
  constexpr double kLeft = 80, kTop = 80, kSide = 520, kBarX = kLeft + kSide + 30, kBarWidth = 22;
  const auto edge = search.edges_um();
  const std::vector<Candidate>& map = found.map;
  const Axis axis = tight_axis(edge.front(), edge.back(), 8);
  double low = 0, high = 0;
  std::size_t best = 0;
  for (std::size_t w = 0; w < map.size(); ++w) {
    if (map[w].merit > map[best].merit) best = w;
    high = std::max(high, map[w].merit);
  }
  const auto above = [&](std::size_t e) { return std::min(e + found.stride, edge.size() - 1); };
  const auto below = [&](std::size_t e) {
    return e == edge.size() - 1 ? e - 1 - (e - 1) % found.stride : e - std::min(e, found.stride);
  };
  if (!(high > low)) high = 1;
  const auto x = [&](double um) { return kLeft + kSide * axis.fraction(um); };
  const auto y = [&](double um) { return kTop + kSide * (1 - axis.fraction(um)); };
  Svg svg(kBarX + kBarWidth + 100, kTop + kSide + 70, title);
  svg.text({kLeft + kSide / 2, 32}, title, {.size = 17, .anchor = Anchor::kMiddle, .bold = true});
  svg.text({kLeft + kSide / 2, 55},
           merit_name(merit) + (search.pairing() == Pairing::kNone
                                    ? " of every window"
                                    : " of every window with its best partner"),
           {.size = 13, .anchor = Anchor::kMiddle, .color = "#666666"});
  svg.rect({kLeft, kTop}, kSide, kSide, "#f2f3f5", {"#333333", 1, ""});
  // A window is the cell between its limits and the next ones: left of and below it.
  struct Field {
    double x0, x1, y0, y1;
  };
  const auto cell = [&](Passband p) {
    return Field{x(edge[p.first]), x(edge[above(p.first)]), y(edge[p.last]),
                 y(edge[below(p.last)])};
  };
  for (const Candidate& c : map) {
    const Field at = cell(c.one);
    svg.rect({at.x0, at.y0}, at.x1 - at.x0, at.y1 - at.y0,
             map_color((c.merit - low) / (high - low)), {"", 0, ""});
  }
  if (!map.empty()) {
    const auto mark = [&](Passband p) {
      const Field c = cell(p);
      const Point at{0.5 * (c.x0 + c.x1), 0.5 * (c.y0 + c.y1)};
      svg.circle(at, 6, "none", {"#ffffff", 3, ""});
      svg.circle(at, 6, "none", {"#000000", 1.5, ""});
    };
    mark(map[best].one);
    if (map[best].other) mark(*map[best].other);
  }
  for (std::size_t i = 0; i < axis.tick.size(); ++i) {
    svg.line({x(axis.tick[i]), kTop + kSide}, {x(axis.tick[i]), kTop + kSide + 5},
             {"#333333", 1, ""});
    svg.text({x(axis.tick[i]), kTop + kSide + 21}, axis.label[i],
             {.size = 13, .anchor = Anchor::kMiddle});
    svg.line({kLeft - 5, y(axis.tick[i])}, {kLeft, y(axis.tick[i])}, {"#333333", 1, ""});
    svg.text({kLeft - 9, y(axis.tick[i]) + 4.5}, axis.label[i],
             {.size = 13, .anchor = Anchor::kEnd});
  }
  svg.text({kLeft + kSide / 2, kTop + kSide + 48}, "from [um]",
           {.size = 14, .anchor = Anchor::kMiddle});
  svg.text({24, kTop + kSide / 2}, "to [um]",
           {.size = 14, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  constexpr int kLevels = 64;
  for (int n = 0; n < kLevels; ++n)
    svg.rect({kBarX, kTop + kSide * (1 - (n + 1.0) / kLevels)}, kBarWidth, kSide / kLevels + 0.5,
             map_color((n + 0.5) / kLevels), {"", 0, ""});
  const Axis bar = tight_axis(low, high, 8);
  for (std::size_t i = 0; i < bar.tick.size(); ++i)
    svg.text({kBarX + kBarWidth + 8, kTop + kSide * (1 - bar.fraction(bar.tick[i])) + 4.5},
             bar.label[i], {.size = 13});
  return svg.finish();
}

std::string response_csv(const ResponseTable& response) {
  std::string out = "wavelength_um,response\n";
  for (const SpectralPoint& p : response)
    out += fmt::format("{:.10g},{:.10g}\n", p.lambda_um, p.value);
  return out;
}

std::vector<std::string> notes_on(const WindowChoice& choice, const BandPopulation& population,
                                  const schema::Accuracy& accuracy) {
  std::vector<std::string> out;
  if (population.without_clutter > 0)
    out.push_back(fmt::format(
        "{} of {} rows are left out, since they have no clutter: their sensor stands less than 0.6 "
        "deg above the target's horizontal, or neither [land] nor a rough sea lies behind",
        population.without_clutter, population.without_clutter + population.row.size()));
  if (population.without_modes > 0)
    out.push_back(fmt::format(
        "of {} of {} rows it is not stored how errors of wavelengths go together (an older "
        "irsig): they are taken as one, the largest that a window's can be",
        population.without_modes, population.row.size()));
  const CandidateMerit& first = choice.candidate.front();
  if (!first.known)
    out.push_back(fmt::format(
        "errors alone would make {:.3g} of no contrast at all, and the first has {:.3g}: "
        "of what the detector sees nothing is known, and no window is told from another",
        first.errors_alone, first.of.merit));
  if (first.extrapolated) {
    const std::vector<double> ranges = ranges_of(population);
    const bool farther = first.of.merit > ranges.back();
    out.push_back(fmt::format(
        "the first is seen {} than the {} range, {:g} m: {:.4g} m is extrapolated{}, without "
        "errors, and no window is told from another; ask for {} ranges (--range-m)",
        farther ? "farther" : "less far", farther ? "farthest" : "nearest",
        farther ? ranges.back() : ranges.front(), first.of.merit,
        farther ? " along the last line, which air makes steeper" : "",
        farther ? "farther" : "nearer"));
  }
  if (!first.known || first.extrapolated) return out;
  if (choice.candidate.size() < 2) return out;
  std::size_t alike = 0;
  for (const CandidateMerit& w : choice.candidate)
    if (w.as_good >= kTold) ++alike;
  if (alike < 2) {
    out.push_back("the first is told from the others listed");
    return out;
  }
  out.push_back(
      fmt::format("{} of the {} compared are not distinguishable: with more than {:g} % "
                  "each is as good "
                  "as the first",
                  alike, choice.candidate.size(), 100 * kTold));
  const double samples_to_tell = choice.candidate[1].samples_to_tell;
  if (std::isinf(samples_to_tell)) {
    out.push_back(
        "no number of samples tells the first from the second: what is left are bounds, models and "
        "inputs");
  } else if (samples_to_tell > 1) {
    const std::string line =
        accuracy.has_relative_error()
            ? fmt::format("relative_error = {:.2g}",
                          accuracy.relative_error() / std::sqrt(samples_to_tell))
        : accuracy.has_samples_per_replicate()
            ? fmt::format("samples_per_replicate = {:.0f}",
                          std::ceil(static_cast<double>(accuracy.samples_per_replicate()) *
                                    samples_to_tell))
            : fmt::format("target_paths = {:.2g}", accuracy.target_paths() * samples_to_tell);
    out.push_back(
        fmt::format("{:.2g} x as many samples would tell the first from the second: "
                    "[accuracy] {}",
                    samples_to_tell, line));
  }
  return out;
}

}  // namespace irsig
