#include "view/export/export.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/picture_program.h"
#include "cli/target_extent.h"
#include "core/base/status_macros.h"
#include "planning/export_temperatures.h"
#include "view/base/print.h"
#include "view/pictures/export_thumbnails.h"

namespace irsig {
namespace {

struct ExportCommand {
  explicit ExportCommand(CLI::App& command)
      : filter(command), output(command, {"csv", "netcdf", "envi", "tsf", "thumbnails", "temperatures"}) {
    output.out_option()->required();
  }
  FilterOptions filter;
  OutputOptions output;
  std::string spectra;  // empty, long or wide
  std::string scale;    // of thumbnails; empty: not said
  bool exr = false, background = false;

  [[nodiscard]] absl::Status run() const {
    ASSIGN_OR_RETURN(auto query, filter.query());
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(filter.database()));
    ASSIGN_OR_RETURN(const auto format, output.format());
    if (format == "temperatures" && !query.range_m.empty())
      return absl::InvalidArgumentError("--range-m: temperatures are the same from everywhere");
    if (format == "temperatures")
      return output.write([&](std::string_view, std::ostream& out) {
        return export_temperatures(filter.database(), query.sweep, query.season, query.time, out);
      });
    if (format != "thumbnails" && (!scale.empty() || exr || background))
      return absl::InvalidArgumentError(
          "--thumbnail-scale, --exr and --background: belong to the format thumbnails");
    if (!spectra.empty() && format != "csv")
      return absl::InvalidArgumentError(
          absl::StrCat("--spectra: belongs to the format csv; ", format, " has them as it is"));
    if (format == "thumbnails") return write_thumbnails(*reader, query);
    const ExportAsked asked{query,
                            spectra.empty()     ? TableSpectra::kNone
                            : spectra == "long" ? TableSpectra::kLong
                                                : TableSpectra::kWide,
                            stored_target_extent};
    if (output.out() != "-") return export_file(*reader, asked, format, output.out());
    if (format != "csv")
      return absl::InvalidArgumentError(
          absl::StrCat("--out -: ", format, " needs a file, only csv can be streamed"));
    return export_csv(*reader, asked, data_output());
  }

 private:
  [[nodiscard]] absl::Status write_thumbnails(StoreReader& reader, const Query& query) const {
    if (output.out() == "-") return absl::InvalidArgumentError("--out -: thumbnails need a folder");
    ASSIGN_OR_RETURN(const auto images, export_thumbnails(reader,
                                                          {query, scale.empty() ? "common" : scale,
                                                           exr, background, filter.text()},
                                                          output.out(), read_pictures));
    print_note("irsig: {}: {} images\n", output.out(), images);
    return absl::OkStatus();
  }
};

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "export",
      "Write signatures to a file: csv (one line each) or netcdf (netCDF-4 with CF "
      "attributes: scalars, causes, parts and spectra) or envi (spectral library of one --band, "
      "with its .hdr) or tsf (STK's target signature file of one --season and --band) or "
      "thumbnails (a folder of pictures with their labels); or, as csv, the "
      "temperatures of all facets");
  const auto options = std::make_shared<ExportCommand>(*command);
  options->filter.add_ranges(*command);
  command
      ->add_option(
          "--spectra", options->spectra,
          "Of csv: long (a line for each wavelength) or wide (a column for each wavelength "
          "of the --quantity and of its standard error; one --band)")
      ->type_name("FORM")
      ->check(CLI::IsMember({"long", "wide"}));
  command
      ->add_option(
          "--thumbnail-scale", options->scale,
          "Black and white of thumbnails: common (0 to the hottest pixel of all that are "
          "exported, by sweep and band; default), own (of each), or BLACK,WHITE in W/(m2 sr)")
      ->type_name("SCALE");
  command->add_flag("--exr", options->exr,
                    "With thumbnails also their radiances at the target, as EXR");
  command->add_flag("--background", options->background,
                    "Thumbnails as the sensor has them: behind the air, before the background");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
