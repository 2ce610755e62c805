#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/picture_program.h"
#include "cli/target_extent.h"
#include "core/base/status_macros.h"
#include "jobs/files/response_file.h"
#include "jobs/text/number_bounds.h"
#include "view/base/print.h"
#include "view/pictures/thumbnail.h"
#include "view/query/band_sum.h"
#include "view/query/query_table.h"
#include "view/report/outcome.h"

namespace irsig {
namespace {

struct QueryCommand {
  explicit QueryCommand(CLI::App& command)
      : filter(command), output(command, {"text", "csv", "json"}) {}
  FilterOptions filter;
  OutputOptions output;
  QueryContent content;
  std::string thumbnail, thumbnail_scale, sort;
  bool descending = false;
  std::vector<double> window_um;  // two, or none
  std::string response;           // a file

  // Returns the response of --window or --response; nullopt if neither option is given.
  [[nodiscard]] absl::StatusOr<std::optional<ResponseTable>> asked_response() const {
    if (!response.empty()) {
      ASSIGN_OR_RETURN(auto table, read_response(response));
      return table;
    }
    if (window_um.empty()) return std::nullopt;
    if (!(window_um[0] > 0 && window_um[0] < window_um[1]))
      return absl::InvalidArgumentError(
          fmt::format("--window {:g},{:g}: expected two wavelengths in um, the shorter one first",
                      window_um[0], window_um[1]));
    return window(window_um[0], window_um[1]);
  }

  // Prints how many rows lack the correlation of errors between wavelengths.
  static void note_on_errors(const std::vector<InBand>& sums) {
    const auto lacking =
        std::count_if(sums.begin(), sums.end(), [](const InBand& s) { return !s.modes; });
    if (lacking > 0)
      print_note(
          "irsig: note: of {} of {} rows it is not stored how errors of wavelengths go together "
          "(an older irsig, another range): their standard errors are the largest that they can "
          "be\n",
          lacking, sums.size());
  }

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(const auto asked, asked_response());
    ASSIGN_OR_RETURN(auto query, filter.query());
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(filter.database()));
    ASSIGN_OR_RETURN(auto rows, run_query(*reader, query, stored_target_extent));
    if (!thumbnail.empty())
      return write_thumbnail(*reader, rows, thumbnail, thumbnail_scale, read_pictures);
    if (!sort.empty()) RETURN_IF_ERROR(sort_rows(rows, sort, descending));
    if (rows.empty()) print_note("irsig: no signature matches\n");
    for (const std::string& note : notes_on(rows)) print_note("irsig: note: {}\n", note);
    if (const std::string note = far_note(rows, query); !note.empty())
      print_note("irsig: note: {}\n", note);
    ASSIGN_OR_RETURN(const auto floors, floor_notes(*reader, rows));
    for (const std::string& note : floors) print_note("irsig: note: {}\n", note);
    if (asked) {
      const auto sums = in_band(*reader, rows, *asked);
      if (!sums.ok())
        return absl::Status(sums.status().code(),
                            fmt::format("{}: {}", response.empty() ? "--window" : response,
                                        std::string(sums.status().message())));
      note_on_errors(*sums);
      return output.write([&](std::string_view format, std::ostream& out) {
        return write_in_band(rows, *sums, query.quantity, format, out);
      });
    }
    QueryContent shown = content;
    shown.quantity = query.quantity;
    return output.write([&](std::string_view format, std::ostream& out) {
      return write_rows(*reader, rows, shown, format, out);
    });
  }
};

}  // namespace

void add_query(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "query",
      "Print signatures: in-band intensity, apparent intensity or contrast [W/sr] or "
      "background [W/(m2 sr)], with standard error, projected area [m2] and source "
      "temperature [K]. One row per season, time, band and viewpoint.");
  const auto options = std::make_shared<QueryCommand>(*command);
  command->add_flag("--spectrum", options->content.spectrum,
                    "One line per wavelength: spectral intensity [W/(sr um)]");
  CLI::Option* parts = command->add_flag("--parts", options->content.parts,
                                         "One line per part of the target: its in-band intensity");
  parts->excludes("--spectrum");
  command->add_flag("--causes", options->content.causes,
                    "Split by cause: emitted; sun, sky, sea and other parts reflected");
  options->filter.add_ranges(*command);
  CLI::Option* window =
      command
          ->add_option("--window", options->window_um,
                       "In-band in a window from L1 to L2 [um], within the stored band and at "
                       "least one of its "
                       "steps wide, instead of the whole band: with the standard error that the "
                       "stored modes give, and the whole "
                       "band's bounds")
          ->type_name("L1,L2")
          ->delimiter(',')
          ->expected(2)
          ->excludes("--spectrum")
          ->excludes("--parts")
          ->excludes("--causes");
  command
      ->add_option("--response", options->response,
                   "  the same under a response: CSV with lambda_um,response")
      ->type_name("FILE")
      ->excludes(window)
      ->excludes("--spectrum")
      ->excludes("--parts")
      ->excludes("--causes");
  command->add_option("--sort", options->sort, "Order the rows by a column of the csv format")
      ->type_name("COLUMN");
  command->add_flag("--descending", options->descending, "  the largest first")->needs("--sort");
  command
      ->add_option("--thumbnail", options->thumbnail,
                   "Write the image of the one signature chosen (.png for people, .exr: float32 "
                   "in-band radiance) instead of printing it")
      ->type_name("FILE");
  command
      ->add_option("--thumbnail-scale", options->thumbnail_scale,
                   "  black and white of the .png: common (0 to the hottest pixel of the sweep's "
                   "images in this band) or BLACK,WHITE in W/(m2 sr); default: 0 to its own "
                   "hottest pixel")
      ->type_name("SCALE")
      ->needs("--thumbnail");
  command->footer("csv and json have every column and every digit; text has what people read.");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
