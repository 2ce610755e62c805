#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/target_extent.h"
#include "jobs/detector_file.h"
#include "jobs/number_bounds.h"
#include "view/atomic_file.h"
#include "view/band_tables.h"
#include "view/print.h"
#include "view/query.h"

namespace irsig {
namespace {

struct BandsCommand {
  explicit BandsCommand(CLI::App& command)
      : filter(command), output(command, {"text", "csv", "json"}) {}
  FilterOptions filter;
  OutputOptions output;
  std::string detector, merit = "mean", weight = "solid-angle", against, map, response_out;
  std::vector<double> range_m, window_um;
  double percentile = 10, threshold = 5;
  std::optional<double> min_width_um;
  std::size_t top = 10;

  [[nodiscard]] absl::StatusOr<MeritOf> asked_merit() const {
    MeritOf out{merit == "mean"         ? Merit::kMean
                : merit == "percentile" ? Merit::kPercentile
                : merit == "worst"      ? Merit::kWorst
                                        : Merit::kAbove,
                percentile, threshold};
    if (!(percentile > 0 && percentile <= 100))
      return absl::InvalidArgumentError(
          fmt::format("--percentile {}: expected more than 0, at most 100", percentile));
    if (!(threshold > 0 && std::isfinite(threshold)))
      return absl::InvalidArgumentError(
          fmt::format("--threshold {}: expected a number above 0", threshold));
    return out;
  }

  // Of one database, at its own ranges or at those that are asked for.
  [[nodiscard]] absl::StatusOr<std::vector<QueryRow>> rows_of(StoreReader& reader,
                                                              Query query) const {
    if (range_m.empty()) return run_query(reader, query, stored_target_extent);
    std::vector<QueryRow> all;
    for (const double range : range_m) {
      if (auto s = check_number("Viewpoints.range_m", "--range-m", range); !s.ok()) return s;
      query.range_m = range;
      auto rows = run_query(reader, query, stored_target_extent);
      if (!rows.ok()) return rows.status();
      std::move(rows->begin(), rows->end(), std::back_inserter(all));
    }
    return all;
  }

  // Windows of the user's own, to be compared with each other alone.
  [[nodiscard]] absl::StatusOr<BandSearch::Map> asked_windows(const BandSearch& search,
                                                              const MeritOf& of) const {
    BandSearch::Map out;
    const std::vector<double>& edge = search.edges_um();
    const auto nearest = [&](double um) {
      std::size_t at = 0;
      for (std::size_t i = 0; i < edge.size(); ++i)
        if (std::abs(edge[i] - um) < std::abs(edge[at] - um)) at = i;
      return at;
    };
    for (std::size_t i = 0; i + 1 < window_um.size(); i += 2) {
      const double low = window_um[i], high = window_um[i + 1];
      if (!(low < high))
        return absl::InvalidArgumentError(fmt::format(
            "--window {:g},{:g}: expected two wavelengths, the shorter one first", low, high));
      if (low < edge.front() - 1e-9 || high > edge.back() + 1e-9)
        return absl::InvalidArgumentError(fmt::format(
            "--window {:g},{:g}: outside of what is stored and the detector responds to, {:g} to "
            "{:g} um",
            low, high, edge.front(), edge.back()));
      if (high - low < search.step_um() - 1e-9)
        return absl::InvalidArgumentError(
            fmt::format("--window {:g},{:g}: narrower than the stored step of {:g} um; ask for "
                        "step_um = {:g} in the [[band]] of the sweep",
                        low, high, search.step_um(), (high - low) / 2));
      const std::size_t first = nearest(low), last = nearest(high);
      if (std::max(std::abs(edge[first] - low), std::abs(edge[last] - high)) > 1e-6)
        print_note(
            "irsig: note: window {:g},{:g} is taken between limits of stored bins, {:g} to "
            "{:g} um\n",
            low, high, edge[first], edge[last]);
      out.first.push_back(first);
      out.last.push_back(last);
      out.merit.push_back(search.merit(of, first, last));
    }
    return out;
  }

  [[nodiscard]] absl::Status run() const {
    const auto of = asked_merit();
    if (!of.ok()) return of.status();
    const auto read = read_detector(detector);
    if (!read.ok()) return read.status();
    auto query = filter.query();
    if (!query.ok()) return query.status();
    auto reader = StoreReader::open(filter.database());
    if (!reader.ok()) return reader.status();
    const auto rows = rows_of(**reader, *query);
    if (!rows.ok()) return rows.status();
    std::unique_ptr<StoreReader> other;
    std::vector<QueryRow> their_rows;
    if (!against.empty()) {
      auto opened = StoreReader::open(against);
      if (!opened.ok()) return opened.status();
      other = *std::move(opened);
      Query same = *query;
      same.sweep.clear();
      auto found = rows_of(*other, same);
      if (!found.ok()) return found.status();
      their_rows = *std::move(found);
    }
    auto population =
        band_population(**reader, *rows, other.get(), their_rows,
                        weight == "rows" ? AspectWeight::kRows : AspectWeight::kSolidAngle);
    if (!population.ok()) return population.status();
    const auto search = BandSearch::make(*std::move(population), read->detector);
    if (!search.ok())
      return absl::Status(search.status().code(),
                          fmt::format("{}: {}", detector, std::string(search.status().message())));
    if (min_width_um && *min_width_um < search->step_um() - 1e-9)
      return absl::InvalidArgumentError(
          fmt::format("--min-width-um {:g}: narrower than the stored step of {:g} um; ask for "
                      "step_um = {:g} in the [[band]] of the sweep",
                      *min_width_um, search->step_um(), *min_width_um));
    const auto windows = window_um.empty() ? absl::StatusOr<BandSearch::Map>(search->map(
                                                 *of, min_width_um.value_or(search->step_um())))
                                           : asked_windows(*search, *of);
    if (!windows.ok()) return windows.status();
    if (windows->merit.empty())
      return absl::InvalidArgumentError(fmt::format(
          "--min-width-um {:g}: wider than what is stored and the detector responds to, {:g} to "
          "{:g} um",
          min_width_um.value_or(0), search->edges_um().front(), search->edges_um().back()));
    const auto stored = (*reader)->sweep(rows->front().signature.sweep);
    if (!stored.ok()) return stored.status();
    const BandChoice choice = search->compare(*of, *windows, top);
    print_note("irsig: note: {} windows, {} rows, {}; detector {}\n", windows->merit.size(),
               rows->size(), merit_name(*of), read->name);
    for (const std::string& note :
         notes_on(choice, search->population(), stored->resolved.sweep().accuracy()))
      print_note("irsig: note: {}\n", note);
    note_ranges(*search, choice);
    if (auto s = write_files(*search, *of, *windows, choice, read->detector); !s.ok()) return s;
    return output.write([&](std::string_view format, std::ostream& out) {
      return write_choice(choice, format, out);
    });
  }

  void note_ranges(const BandSearch& search, const BandChoice& choice) const {
    if (range_m.size() < 2) return;
    const auto edge = [&](double um) {
      return static_cast<std::size_t>(
          std::find(search.edges_um().begin(), search.edges_um().end(), um) -
          search.edges_um().begin());
    };
    const WindowMerit& best = choice.window.front();
    auto ranges =
        search.detection_range_m(edge(best.lambda_min_um), edge(best.lambda_max_um), threshold);
    std::sort(ranges.begin(), ranges.end());
    const auto at = [&](double share) {
      const double m = ranges[static_cast<std::size_t>(
          std::floor(share * static_cast<double>(ranges.size() - 1)))];
      return m == 0          ? std::string("below the nearest")
             : std::isinf(m) ? std::string("beyond the farthest")
                             : fmt::format("{:.4g} m", m);
    };
    print_note(
        "irsig: note: SNR {:g} of {:g} to {:g} um is reached up to: 10 % of the rows {}, "
        "half {}, 90 % {}\n",
        threshold, best.lambda_min_um, best.lambda_max_um, at(0.9), at(0.5), at(0.1));
  }

  [[nodiscard]] absl::Status write_files(const BandSearch& search, const MeritOf& of,
                                         const BandSearch::Map& windows, const BandChoice& choice,
                                         const Detector& seen_by) const {
    if (!map.empty()) {
      const bool svg = map.ends_with(".svg");
      if (!svg && !map.ends_with(".csv"))
        return absl::InvalidArgumentError(
            fmt::format("--map {}: expected a name that ends in .svg or .csv", map));
      if (auto s = replace_file(
              map,
              [&](const std::string& name) {
                std::ofstream file(name, std::ios::binary);
                if (!svg) return write_map(search, of, windows, "csv", file);
                file << plot_map_of_windows(search, of, windows, "Windows of " + filter.database());
                return file ? absl::OkStatus() : absl::UnavailableError("cannot write " + map);
              });
          !s.ok())
        return s;
    }
    if (response_out.empty()) return absl::OkStatus();
    const WindowMerit& best = choice.window.front();
    const ResponseTable whole = seen_by.response.empty()
                                    ? window(search.edges_um().front(), search.edges_um().back())
                                    : seen_by.response;
    return replace_file(response_out, std::string_view(response_csv(whole, best.lambda_min_um,
                                                                    best.lambda_max_um)));
  }
};

}  // namespace

void add_bands(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "bands",
      "Which part of a stored band a detector sees the target best in: the signal-to-noise ratio "
      "of "
      "its contrast in every window, with what is known of its error (docs/bands.md)");
  const auto o = std::make_shared<BandsCommand>(*command);
  command
      ->add_option("--detector", o->detector,
                   "The detector: response and noise, a TOML file (docs/bands.md)")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--merit", o->merit,
                   "What is best: mean, percentile (the SNR that all but --percentile % of the "
                   "population exceed), worst, above (the share with --threshold or more)")
      ->check(CLI::IsMember({"mean", "percentile", "worst", "above"}))
      ->capture_default_str();
  command->add_option("--percentile", o->percentile, "  [%]")
      ->type_name("P")
      ->capture_default_str();
  command->add_option("--threshold", o->threshold, "  SNR; also of detection ranges")
      ->type_name("SNR")
      ->capture_default_str();
  command
      ->add_option("--weight", o->weight,
                   "Rows count alike (rows), or aspects by the solid angle that they stand for")
      ->check(CLI::IsMember({"solid-angle", "rows"}))
      ->capture_default_str();
  command
      ->add_option("--range-m", o->range_m,
                   "At these ranges instead of the stored one, without tracing (docs of query)")
      ->type_name("R,...")
      ->delimiter(',');
  command
      ->add_option("--against", o->against,
                   "Tell the target from that of another database: the difference of both")
      ->type_name("DB2");
  command
      ->add_option("--window", o->window_um,
                   "Compare these windows alone; may be repeated, L1,L2 [um]")
      ->type_name("L1,L2")
      ->delimiter(',')
      ->expected(2)
      ->take_all();
  command->add_option("--min-width-um", o->min_width_um, "No narrower windows")->type_name("W");
  command->add_option("--top", o->top, "So many windows are compared and printed")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--map", o->map, "The merit of every window: a picture (.svg) or numbers (.csv)")
      ->type_name("FILE");
  command
      ->add_option("--response-out", o->response_out,
                   "The response of the best window, as --response of query takes it (.csv)")
      ->type_name("FILE");
  command->callback([o, &exit_code] { exit_code = report(o->run()); });
}

}  // namespace irsig
