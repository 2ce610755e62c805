#include "view/plot/plot.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/picture_program.h"
#include "cli/target_extent.h"
#include "core/accuracy/image_layers.h"
#include "core/base/status_macros.h"
#include "planning/land_picture.h"
#include "planning/temperature_picture.h"
#include "view/pictures/effect_pictures.h"
#include "view/pictures/image_regions.h"
#include "view/pictures/plot_picture.h"
#include "view/pictures/region_hours.h"
#include "view/pictures/sky_picture.h"
#include "view/pictures/sweep_imager.h"
#include "view/report/hours.h"

namespace irsig {
namespace {

struct PlotCommand {
  explicit PlotCommand(CLI::App& command)
      : filter(command), output(command, {"svg", "csv", "json"}) {
    output.out_option()->required();
  }
  FilterOptions filter;
  OutputOptions output;
  std::string kind, scale, layer;
  std::vector<std::string> region;
  std::optional<double> elevation_deg;
  std::optional<std::uint32_t> pixels;
  bool no_imager = false;

  [[nodiscard]] absl::Status run() const {
    RETURN_IF_ERROR(check_options());
    ASSIGN_OR_RETURN(const auto format, output.format());
    if (format != "svg" && kind != "hours" && kind != "regions" && kind != "polar" &&
        kind != "diagonal")
      return absl::InvalidArgumentError("--kind " + kind +
                                        " is drawn as svg alone; `irsig query` and `irsig export` "
                                        "write its numbers");
    ASSIGN_OR_RETURN(auto query, filter.query());
    RETURN_IF_ERROR(belongs(!query.range_m.empty(), "--range-m",
                            {"polar", "spectrum", "map", "transmittance"}));
    std::optional<ColorRange> range;
    if (!scale.empty()) {
      ASSIGN_OR_RETURN(range, parse_color_range(scale));
    }
    if (kind == "land") {
      ASSIGN_OR_RETURN(const std::string svg,
                       land_picture(filter.database(), query.sweep, pixels.value_or(kPixels)));
      return output.write(svg);
    }
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(filter.database()));
    if (kind == "hours") return write_hours_as(format, *reader, query);
    if (kind == "regions") return write_regions_as(format, *reader, query);
    if (kind == "polar" && format != "svg")
      return output.write([&](std::string_view table, std::ostream& out) {
        return write_polar(*reader, query, elevation_deg, table, out, stored_target_extent);
      });
    if (kind == "picture" || kind == "sheet") return write_stored(*reader, query, range);
    if (kind == "effects" || kind == "diagonal")
      return write_effects_as(format, *reader, query, range);
    if (kind == "sky")
      return write_picture(sky_picture(*reader, query, range, pixels.value_or(kPixels)));
    if (kind == "temperatures")
      return write_picture(
          temperature_picture(filter.database(), query, range, pixels.value_or(kPixels)));
    ASSIGN_OR_RETURN(
        auto svg, kind == "polar" ? plot_polar(*reader, query, elevation_deg, stored_target_extent)
                  : kind == "spectrum" ? plot_spectrum(*reader, query, stored_target_extent)
                  : kind == "transmittance"
                      ? plot_transmittance(*reader, query, stored_target_extent)
                      : plot_map(*reader, query, stored_target_extent));
    return output.write(svg);
  }

  static constexpr std::uint32_t kPixels = 512;

 private:
  [[nodiscard]] absl::Status belongs(bool given, const char* option,
                                     const std::vector<std::string>& kinds) const {
    if (!given || std::find(kinds.begin(), kinds.end(), kind) != kinds.end())
      return absl::OkStatus();
    std::string names = kinds.front();
    for (std::size_t i = 1; i < kinds.size(); ++i) names += " or " + kinds[i];
    return absl::InvalidArgumentError(std::string(option) + " belongs to --kind " + names);
  }

  [[nodiscard]] absl::Status check_options() const {
    absl::Status status = belongs(elevation_deg.has_value(), "--elevation", {"polar"});
    status.Update(
        belongs(!scale.empty(), "--scale", {"picture", "sheet", "temperatures", "sky", "effects"}));
    status.Update(belongs(!layer.empty(), "--layer", {"picture", "sheet", "regions"}));
    status.Update(belongs(no_imager, "--no-imager", {"picture", "sheet"}));
    status.Update(belongs(!region.empty(), "--region", {"regions"}));
    status.Update(belongs(pixels.has_value(), "--pixels",
                          {"picture", "sheet", "temperatures", "sky", "land"}));
    return status;
  }

  [[nodiscard]] absl::Status write_picture(const absl::StatusOr<FalseColorPicture>& picture) const {
    if (!picture.ok()) return picture.status();
    return output.write(draw_false_color(*picture));
  }

  // Counts of the sweep's imager unless a layer or its absence is asked for.
  [[nodiscard]] absl::Status write_stored(StoreReader& reader, const Query& query,
                                          const std::optional<ColorRange>& range) const {
    std::optional<SweepImager> imager;
    if (!no_imager && layer.empty()) {
      ASSIGN_OR_RETURN(imager, common_imager(reader, query.sweep));
    }
    return write_picture(
        kind == "picture"
            ? radiance_picture(reader, query, range, pixels, read_pictures, layer, imager)
            : sheet_picture(reader, query, range, pixels, read_pictures, layer, imager));
  }

  [[nodiscard]] absl::Status write_hours_as(const std::string& format, StoreReader& reader,
                                            const Query& query) const {
    ASSIGN_OR_RETURN(const auto hours, hours_of(reader, query));
    if (format == "svg") return output.write(plot_hours(hours));
    return output.write(
        [&](std::string_view table, std::ostream& out) { return write_hours(hours, table, out); });
  }

  [[nodiscard]] absl::Status write_effects_as(const std::string& format, StoreReader& reader,
                                              const Query& query,
                                              const std::optional<ColorRange>& range) const {
    ASSIGN_OR_RETURN(const auto pictures, effect_pictures(reader, query, read_pictures));
    if (kind == "effects") return write_picture(effects_sheet(pictures, range));
    if (format == "svg") return output.write(plot_diagonal(pictures));
    return output.write([&](std::string_view table, std::ostream& out) {
      return write_diagonal(pictures, table, out);
    });
  }

  [[nodiscard]] absl::Status write_regions_as(const std::string& format, StoreReader& reader,
                                              const Query& query) const {
    ASSIGN_OR_RETURN(const auto rectangles, parse_rectangles(region));
    const std::string shown = layer.empty() ? name_of(ImageLayer::kAtSensor) : layer;
    ASSIGN_OR_RETURN(const auto hours,
                     region_hours(reader, query, rectangles, shown, read_pictures));
    if (format == "svg") return output.write(plot_region_hours(hours));
    return output.write([&](std::string_view table, std::ostream& out) {
      return write_region_hours(hours, table, out);
    });
  }
};

}  // namespace

void add_plot(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "plot",
      "Draw signatures as SVG. Curves of in-band values: polar (against aspect azimuth), "
      "hours (of one viewpoint, against the time of day, with computed temperatures) and "
      "regions (rectangles or parts of stored images against the time of day); these also "
      "as csv and json. Also map (over all aspects), spectrum (of one viewpoint) and "
      "transmittance (of the air). In false colours: picture (one stored image), sheet "
      "(many, side by side), temperatures (of the facets, from any --aspect), sky (radiance "
      "by direction) and land (relief and materials from above). effects shows an image "
      "with and without air, reflected sky and reflected sun, and diagonal the radiances "
      "along its diagonal.");
  const auto options = std::make_shared<PlotCommand>(*command);
  command
      ->add_option("--kind", options->kind,
                   "polar, spectrum, map, hours, regions, transmittance, picture, sheet, effects, "
                   "diagonal, temperatures, sky or land")
      ->required()
      ->type_name("KIND")
      ->check(
          CLI::IsMember({"polar", "spectrum", "map", "hours", "regions", "transmittance", "picture",
                         "sheet", "effects", "diagonal", "temperatures", "sky", "land"}));
  command
      ->add_option("--elevation", options->elevation_deg,
                   "Elevation of a polar plot [deg]; default: the lowest that the viewpoints cover")
      ->type_name("DEG");
  command
      ->add_option("--scale", options->scale,
                   "Values at the ends of the colours of picture, sheet (of [imager]: counts), "
                   "effects and sky "
                   "[W/(m2 sr)] and "
                   "temperatures [K]; "
                   "default: the 1st and 99th percentile of their pixels; of temperatures and "
                   "sky: the smallest and largest")
      ->type_name("LOW,HIGH");
  command
      ->add_option(
          "--pixels", options->pixels,
          "Long side of temperatures, sky and land, default: " +
              std::to_string(PlotCommand::kPixels) +
              "; of picture and sheet, of whose stored pixels squares are averaged, default: all "
              "that are stored")
      ->type_name("N")
      ->check(CLI::Range(16, 2048));
  std::vector<std::string> layers;
  for (const ImageLayerInfo& layer : kImageLayers) layers.emplace_back(layer.name);
  command
      ->add_option(
          "--layer", options->layer,
          "Of picture, sheet and regions: a further image of the rows, as [image] layers of "
          "the sweep asked for it; default: the radiance at the target, of regions at_sensor")
      ->type_name("NAME")
      ->check(CLI::IsMember(layers));
  command->add_flag("--no-imager", options->no_imager,
                    "Of picture and sheet: stored radiance, although the sweep has [imager]");
  command
      ->add_option(
          "--region", options->region,
          "Of regions: a rectangle of the image, pixels from the top left corner, x0 <= x < "
          "x1 and y0 <= y < y1; may be given several times (default: each part of the "
          "target, and the whole image)")
      ->type_name("NAME=X0,Y0,X1,Y1")
      ->take_all()
      ->allow_extra_args(false);
  options->filter.add_ranges(*command);
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
