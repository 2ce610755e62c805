#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/target_extent.h"
#include "core/base/status_macros.h"
#include "jobs/files/detector_file.h"
#include "jobs/files/response_file.h"
#include "jobs/text/number_bounds.h"
#include "planning/amount_text.h"
#include "planning/machine.h"
#include "planning/prediction.h"
#include "view/bands/band_tables.h"
#include "view/base/atomic_file.h"
#include "view/base/print.h"
#include "view/query/query.h"

namespace irsig {
namespace {

// 45 kB a row of 81 wavelengths with 16 modes, measured.
constexpr double kBytesOfRowAndWavelength = 45e3 / 81;

struct BandsCommand {
  explicit BandsCommand(CLI::App& command)
      : filter(command), output(command, {"text", "csv", "json"}) {}
  FilterOptions filter;
  OutputOptions output;
  std::string detector, merit = "mean", weight = "solid-angle", pairs, against, against_sweep;
  std::string map, response_out, ranges_out, detection_out;
  std::vector<std::string> filter_file, weights_file;
  std::vector<double> range_m, window_um;
  double percentile = 10, threshold = 5;
  std::optional<double> min_width_um, nei_w_m2;
  bool clutter = false, overlapping = false;
  std::size_t top = 10;

  [[nodiscard]] absl::StatusOr<MeritOf> asked_merit() const {
    MeritOf out{merit_named(merit).value_or(Merit::kMean), percentile, threshold,
                clutter ? kRatioInClutter : kRatio};
    if (!(percentile > 0 && percentile <= 100))
      return absl::InvalidArgumentError(
          fmt::format("--percentile {}: expected more than 0, at most 100", percentile));
    if (!(threshold > 0 && std::isfinite(threshold)))
      return absl::InvalidArgumentError(
          fmt::format("--threshold {}: expected a number above 0", threshold));
    return out;
  }

  // Returns the matching rows of one database, at their stored ranges or at the ranges of
  // --range-m.
  [[nodiscard]] absl::StatusOr<std::vector<QueryRow>> rows_of(StoreReader& reader,
                                                              Query query) const {
    for (const double range : range_m)
      RETURN_IF_ERROR(check_number("Viewpoints.range_m", "--range-m", range));
    query.range_m = range_m;
    return run_query(reader, query, stored_target_extent);
  }

  // A window of the user's own, between the nearest edges.
  [[nodiscard]] static absl::StatusOr<Passband> nearest_window(const BandSearch& search, double low,
                                                               double high) {
    const auto edge = search.edges_um();
    const auto nearest = [&](double um) {
      std::size_t at = 0;
      for (std::size_t i = 0; i < edge.size(); ++i)
        if (std::abs(edge[i] - um) < std::abs(edge[at] - um)) at = i;
      return at;
    };
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
    // Between nearest limits there may be half a bin: that of an end.
    Passband out{nearest(low), nearest(high)};
    if (edge[out.last] - edge[out.first] < search.step_um() - 1e-9)
      out.last + 1 < edge.size() ? ++out.last : --out.first;
    const double from = edge[out.first], to = edge[out.last];
    if (std::max(std::abs(from - low), std::abs(to - high)) > 1e-6)
      print_note(
          "irsig: note: window {:g},{:g} is taken between limits of stored bins, {:g} to {:g} um\n",
          low, high, from, to);
    return out;
  }

  // Returns the windows and filters that the user names, compared with one another alone: each by
  // itself, or each pair of them.
  [[nodiscard]] absl::StatusOr<BandSearch::Found> asked(const BandSearch& search,
                                                        const MeritOf& of) const {
    std::vector<Passband> part;
    for (std::size_t i = 0; i + 1 < window_um.size(); i += 2) {
      ASSIGN_OR_RETURN(auto found, nearest_window(search, window_um[i], window_um[i + 1]));
      part.push_back(found);
    }
    for (std::size_t i = 0; i < filter_file.size(); ++i) part.push_back(search.filter(i));
    BandSearch::Found out;
    if (search.pairing() == Pairing::kNone) {
      for (const Passband p : part) out.best.push_back(search.candidate(of, p));
    } else {
      if (part.size() < 2)
        return absl::InvalidArgumentError(
            fmt::format("--pairs {}: one --window or --filter, expected two or more", pairs));
      for (std::size_t i = 0; i < part.size(); ++i)
        for (std::size_t j = i + 1; j < part.size(); ++j)
          out.best.push_back(search.candidate(of, part[i], part[j]));
    }
    out.judged = out.best.size();
    return out;
  }

  [[nodiscard]] absl::Status check_one_sweep(const std::vector<QueryRow>& their_rows) const {
    std::set<std::string> sweeps;
    for (const QueryRow& row : their_rows) sweeps.insert(row.signature.sweep);
    if (sweeps.size() <= 1) return absl::OkStatus();
    return absl::InvalidArgumentError(
        fmt::format("--against {}: rows of several sweeps match, {}; name one with --against-sweep",
                    against, fmt::join(sweeps, ", ")));
  }

  // All spectra of the population are held, with their modes.
  [[nodiscard]] static absl::Status check_memory_of(StoreReader& reader,
                                                    const std::vector<QueryRow>& rows,
                                                    const std::vector<QueryRow>& their_rows) {
    if (rows.empty()) return absl::OkStatus();
    ASSIGN_OR_RETURN(const auto first, reader.spectrum(rows.front().signature.signature_id));
    const std::size_t count = rows.size() + their_rows.size();
    const double bytes =
        static_cast<double>(count) * first.lambda_um_size() * kBytesOfRowAndWavelength;
    const double usable = usable_memory_bytes();
    if (bytes <= usable) return absl::OkStatus();
    return absl::ResourceExhaustedError(
        fmt::format("{} rows of {} wavelengths take {} of memory, this machine has {}: choose "
                    "fewer by --season, --time or --aspect, or ask for fewer --range-m",
                    count, first.lambda_um_size(), bytes_text(bytes), bytes_text(usable)));
  }

  [[nodiscard]] absl::StatusOr<DetectorOfFile> asked_detector() const {
    if (!nei_w_m2) return read_detector(detector);
    RETURN_IF_ERROR(check_number("DetectorNoise.nei_w_m2", "--nei", *nei_w_m2));
    return DetectorOfFile{fmt::format("of NEI {:g} W/m2", *nei_w_m2),
                          {{}, ConstantNoise{*nei_w_m2}}};
  }

  [[nodiscard]] absl::StatusOr<std::vector<NamedFilter>> read_filters() const {
    std::vector<NamedFilter> out;
    for (const std::string& file : filter_file) {
      ASSIGN_OR_RETURN(auto table, read_response(file, "transmittance"));
      for (const SpectralPoint& p : table)
        if (p.value > 1)
          return absl::InvalidArgumentError(
              fmt::format("{}:1:1: transmittance {:g} at {:g} um, expected at most 1", file,
                          p.value, p.lambda_um));
      out.push_back({std::filesystem::path(file).stem().string(), std::move(table)});
    }
    return out;
  }

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const auto of, asked_merit());
    ASSIGN_OR_RETURN(const auto read, asked_detector());
    ASSIGN_OR_RETURN(auto query, filter.query());
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(filter.database()));
    ASSIGN_OR_RETURN(const auto rows, rows_of(*reader, query));
    std::unique_ptr<StoreReader> other;
    std::vector<QueryRow> their_rows;
    if (!against.empty()) {
      ASSIGN_OR_RETURN(other, StoreReader::open(against));
      Query same = query;
      same.sweep = against_sweep;
      ASSIGN_OR_RETURN(their_rows, rows_of(*other, same));
      RETURN_IF_ERROR(check_one_sweep(their_rows));
    }
    RETURN_IF_ERROR(check_memory_of(*reader, rows, their_rows));
    std::vector<RowWeights> weights;
    for (const std::string& file : weights_file) {
      ASSIGN_OR_RETURN(auto table, read_row_weights(file));
      weights.push_back(std::move(table));
    }
    ASSIGN_OR_RETURN(auto population, band_population(*reader, rows, other.get(), their_rows,
                                                      weight == "rows" ? AspectWeight::kRows
                                                                       : AspectWeight::kSolidAngle,
                                                      weights, clutter));
    ASSIGN_OR_RETURN(const auto filters, read_filters());
    const auto search =
        BandSearch::make(std::move(population), read.detector, asked_pairing(), filters);
    if (!search.ok())
      return absl::Status(search.status().code(),
                          fmt::format("{}: {}", detector.empty() ? "--nei" : detector,
                                      std::string(search.status().message())));
    RETURN_IF_ERROR(search->check(of));
    if (of.merit == Merit::kRange && !ranges_out.empty())
      return absl::InvalidArgumentError(
          "--ranges is the merit at each range, and --merit range is of all of them: --detection "
          "has how far each row is seen");
    if (min_width_um && !(*min_width_um >= search->step_um() - 1e-9))
      return absl::InvalidArgumentError(
          fmt::format("--min-width-um {:g}: narrower than the stored step of {:g} um; ask for "
                      "step_um = {:g} in the [[band]] of the sweep",
                      *min_width_um, search->step_um(), *min_width_um));
    const bool own = !window_um.empty() || !filter_file.empty();
    if (own && !map.empty())
      return absl::InvalidArgumentError(
          "--map is of every window: not with --window or --filter, which compare these alone");
    ASSIGN_OR_RETURN(const auto found,
                     own ? asked(*search, of)
                         : search->search(of, min_width_um.value_or(search->step_um()), top,
                                          overlapping ? Listed::kAll : Listed::kDifferent));
    if (found.best.empty() && !min_width_um)
      return absl::InvalidArgumentError(
          fmt::format("the detector responds to {:g} to {:g} um, narrower than {} stored step{} of "
                      "{:g} um: ask "
                      "for step_um = {:g} in the [[band]] of the sweep",
                      search->edges_um().front(), search->edges_um().back(),
                      pairs.empty() ? "a" : "two", pairs.empty() ? "" : "s", search->step_um(),
                      (search->edges_um().back() - search->edges_um().front()) / 4));
    if (found.best.empty())
      return absl::InvalidArgumentError(fmt::format(
          "--min-width-um {:g}: wider than what is stored and the detector responds to, {:g} to "
          "{:g} um{}",
          min_width_um.value_or(0), search->edges_um().front(), search->edges_um().back(),
          pairs.empty() ? "" : ", for two of them"));
    ASSIGN_OR_RETURN(const auto stored,
                     reader->sweep(rows.front().signature.sweep, SweepFiles::kNone));
    const WindowChoice choice = search->compare(of, found.best);
    print_note("irsig: note: {} {}, {} rows, {}; detector {}\n", found.judged,
               search->pairing() != Pairing::kNone ? "pairs"
               : filter_file.empty()               ? "windows"
                                                   : "windows and filters",
               search->population().row.size(), merit_name(of), read.name);
    ASSIGN_OR_RETURN(const auto progress, reader->progress());
    for (const SweepProgress& sweep : progress)
      if (sweep.name == rows.front().signature.sweep && sweep.done < sweep.jobs)
        print_note(
            "irsig: note: {} of the sweep's {} jobs are not done: their rows are not in the "
            "population\n",
            sweep.jobs - sweep.done, sweep.jobs);
    if (found.stride > 1)
      print_note(
          "irsig: note: too many pairs for all of them: of {} limits one was taken, and from there "
          "the best "
          "were moved to where they are best; --min-width-um or fewer rows leave all\n",
          found.stride);
    for (const std::string& note :
         notes_on(choice, search->population(), stored.resolved.sweep().accuracy()))
      print_note("irsig: note: {}\n", note);
    if (range_m.size() > 1)
      print_note("irsig: note: {}\n", note_on_detection(*search, choice, threshold));
    RETURN_IF_ERROR(write_files(*search, of, found, choice));
    return output.write([&](std::string_view format, std::ostream& out) {
      return write_choice(*search, choice, format, out);
    });
  }

  [[nodiscard]] Pairing asked_pairing() const {
    return pairs.empty()           ? Pairing::kNone
           : pairs == "difference" ? Pairing::kDifference
           : pairs == "matched"    ? Pairing::kMatched
                                   : Pairing::kRatio;
  }

  // A file that is a picture or numbers, by its name's end.
  [[nodiscard]] static absl::Status write_file(
      const char* option, const std::string& file, const std::function<std::string()>& picture,
      const std::function<absl::Status(std::ostream&)>& numbers) {
    const bool svg = picture && file.ends_with(".svg");
    if (!svg && !file.ends_with(".csv"))
      return absl::InvalidArgumentError(fmt::format("{} {}: expected a name that ends in {}.csv",
                                                    option, file, picture ? ".svg or " : ""));
    return replace_file(file, [&](const std::string& name) {
      std::ofstream out(name, std::ios::binary);
      if (!svg) return numbers(out);
      out << picture();
      return out ? absl::OkStatus() : absl::UnavailableError("cannot write " + file);
    });
  }

  [[nodiscard]] absl::Status write_files(const BandSearch& search, const MeritOf& of,
                                         const BandSearch::Found& found,
                                         const WindowChoice& choice) const {
    if (!map.empty()) {
      if (auto s = write_file(
              "--map", map,
              [&] {
                return plot_map_of_windows(search, of, found, "Windows of " + filter.database());
              },
              [&](std::ostream& out) { return write_map(search, of, found, "csv", out); });
          !s.ok())
        return s;
    }
    if (!ranges_out.empty()) {
      if (auto s = write_file(
              "--ranges", ranges_out,
              [&] { return plot_ranges(search, of, choice, "Windows of " + filter.database()); },
              [&](std::ostream& out) { return write_ranges(search, of, choice, "csv", out); });
          !s.ok())
        return s;
    }
    if (!detection_out.empty()) {
      if (auto s = write_file("--detection", detection_out, {},
                              [&](std::ostream& out) {
                                return write_detection(search, choice, threshold, "csv", out);
                              });
          !s.ok())
        return s;
    }
    if (response_out.empty()) return absl::OkStatus();
    const Candidate& best = choice.candidate.front().of;
    const auto write = [&](const std::string& file, Passband p) {
      return replace_file(file, std::string_view(response_csv(search.response(p))));
    };
    if (!best.other) return write(response_out, best.one);
    for (const auto& [number, part] : {std::pair{1, best.one}, {2, *best.other}}) {
      std::filesystem::path file(response_out);
      file.replace_filename(
          fmt::format("{}-{}{}", file.stem().string(), number, file.extension().string()));
      RETURN_IF_ERROR(write(file.string(), part));
    }
    return absl::OkStatus();
  }
};

}  // namespace

void add_bands(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "bands",
      "Find the part of a stored band in which a detector sees the target best. For every "
      "window it prints the signal-to-noise ratio of the contrast, with what is known of "
      "its error (docs/reference/bands.md).");
  const auto o = std::make_shared<BandsCommand>(*command);
  CLI::Option_group* seen_by = command->add_option_group("Detector");
  seen_by
      ->add_option("--detector", o->detector,
                   "The detector: response and noise, a TOML file (docs/reference/bands.md)")
      ->type_name("FILE");
  seen_by
      ->add_option("--nei", o->nei_w_m2,
                   "Instead: noise-equivalent irradiance of a detector that responds alike to the "
                   "whole band")
      ->type_name("W/M2");
  seen_by->require_option(1);
  command
      ->add_option(
          "--merit", o->merit,
          "What is best: mean, percentile (the SNR that all but --percentile % of the "
          "population exceed), worst, above (the share with --threshold or more), range (up "
          "to where all but --percentile % have --threshold or more, between --range-m)")
      ->check(CLI::IsMember({"mean", "percentile", "worst", "above", "range"}))
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
      ->add_option("--weights", o->weights_file,
                   "Weights of one's own: a CSV file with weight and season, time_utc, range_m, or "
                   "aspect_azimuth_deg, aspect_elevation_deg; may be repeated")
      ->type_name("FILE");
  command
      ->add_option(
          "--pairs", o->pairs,
          "Two windows at once: their difference with the background taken away, their best "
          "weighted sum of each row (matched), or what their ratio tells of two targets "
          "(--against)")
      ->check(CLI::IsMember({"difference", "matched", "ratio"}));
  command->add_flag("--clutter", o->clutter,
                    "Count the structure of the background around the target as noise: signal to "
                    "clutter and noise (SCNR)");
  command
      ->add_option(
          "--range-m", o->range_m,
          "As seen from these ranges instead of the stored one, without tracing (docs of query)")
      ->type_name("R,...")
      ->delimiter(',');
  command
      ->add_option("--against", o->against,
                   "Tell the target from that of another database: the difference of both")
      ->type_name("DB2");
  command
      ->add_option("--against-sweep", o->against_sweep, "  which of its sweeps, if it has several")
      ->type_name("NAME")
      ->needs("--against");
  command
      ->add_option("--window", o->window_um,
                   "Compare these windows from L1 to L2 [um] alone; may be repeated")
      ->type_name("L1,L2")
      ->delimiter(',')
      ->expected(2)
      ->take_all();
  command
      ->add_option("--filter", o->filter_file,
                   "Compare these filters alone: CSV files lambda_um,transmittance, before the "
                   "detector; may be repeated")
      ->type_name("FILE");
  command->add_option("--min-width-um", o->min_width_um, "No narrower windows")->type_name("W");
  command
      ->add_option("--top", o->top,
                   "So many windows are compared and printed, none of which shares more than half "
                   "of what both cover with a better one (of pairs: both windows)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_flag("--overlapping", o->overlapping,
                 "Compare and print the best windows even where they are nearly the same")
      ->excludes("--window", "--filter");
  command
      ->add_option("--map", o->map, "The merit of every window: a picture (.svg) or numbers (.csv)")
      ->type_name("FILE");
  command
      ->add_option("--response-out", o->response_out,
                   "The response of the best window, as --response of query takes it (.csv); of a "
                   "pair FILE-1 and FILE-2")
      ->type_name("FILE");
  command
      ->add_option("--ranges", o->ranges_out,
                   "The merit at each range: a picture (.svg) or numbers (.csv)")
      ->type_name("FILE")
      ->needs("--range-m");
  command
      ->add_option("--detection", o->detection_out,
                   "How far each row is seen, the range at which its SNR falls to --threshold "
                   "(.csv)")
      ->type_name("FILE")
      ->needs("--range-m");
  command->callback([o, &exit_code] { exit_code = report(o->run()); });
}

}  // namespace irsig
