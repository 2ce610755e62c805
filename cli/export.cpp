#include "view/export/export.h"

#include <fmt/format.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/commands.h"
#include "cli/filter_options.h"
#include "cli/output_options.h"
#include "cli/picture_program.h"
#include "cli/positive_number.h"
#include "cli/target_extent.h"
#include "core/accuracy/image_layers.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "jobs/files/imager_file.h"
#include "planning/export_temperatures.h"
#include "view/base/print.h"
#include "view/pictures/export_thumbnails.h"
#include "view/pictures/sweep_imager.h"

namespace irsig {
namespace {

// Returns all formats: those of rows, then of pictures and temperatures.
std::vector<std::string> export_format_names() {
  std::vector<std::string> out;
  for (const ExportFormat& of : export_formats()) out.emplace_back(of.name);
  out.insert(out.end(), {"thumbnails", "temperatures"});
  return out;
}

std::string export_description() {
  std::string out = "Write signatures to a file: ";
  const std::span<const ExportFormat> of = export_formats();
  for (std::size_t i = 0; i < of.size(); ++i)
    out += fmt::format("{} ({}){}", of[i].name, of[i].what,
                       i + 2 < of.size()   ? ", "
                       : i + 1 < of.size() ? " or "
                                           : ". ");
  return out +
         "thumbnails writes a folder of pictures with their labels. temperatures writes those of "
         "all facets as CSV.";
}

struct ExportCommand {
  explicit ExportCommand(CLI::App& command)
      : filter(command), output(command, export_format_names()) {
    output.out_option()->required();
  }
  FilterOptions filter;
  OutputOptions output;
  std::string spectra;  // empty, long or wide
  std::string scale;    // of thumbnails; empty: not said
  std::string imager;   // file; empty: none
  std::string layer;    // shown by thumbnails; empty: the radiance at the target
  bool no_imager = false, exr = false, background = false, masks = false, coco = false,
       each_part = false;
  std::string image_format = "png";
  int bits = 0;  // of pictures; 0: not said
  double validation = 0;
  std::uint64_t split_seed = 1;
  std::vector<std::string> category;
  std::vector<const CLI::Option*> of_thumbnails;  // options of that format alone

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
    for (const CLI::Option* option : of_thumbnails)
      if (format != "thumbnails" && option->count() > 0)
        return absl::InvalidArgumentError(
            absl::StrCat(option->get_name(),
                         ": belongs to the format thumbnails, expected --thumbnails beside it"));
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
  // The [imager] of the sweeps is applied where no option asks for a stored radiance.
  [[nodiscard]] absl::Status take_sweep_imager(StoreReader& reader, ThumbnailsAsked& asked) const {
    ASSIGN_OR_RETURN(auto stated, common_imager(reader, asked.query.sweep));
    if (!stated) return absl::OkStatus();
    const char* radiance = !scale.empty()          ? "--thumbnail-scale"
                           : bits != 0             ? "--bits"
                           : image_format != "png" ? "--image-format"
                           : !asked.layer.empty()  ? "--layer"
                                                   : nullptr;
    if (radiance) {
      print_note("irsig: [imager] of the sweep is not applied: {} is of stored radiance\n",
                 radiance);
      return absl::OkStatus();
    }
    print_note(
        "irsig: counts of {} as [imager] of the sweep states it; --no-imager gives stored "
        "radiance\n",
        printable(stated->name));
    asked.background = true;
    asked.imager = stated->imager;
    asked.imager_name = std::move(stated->name);
    asked.imager_identity = std::move(stated->identity);
    return absl::OkStatus();
  }

  [[nodiscard]] absl::Status write_thumbnails(StoreReader& reader, const Query& query) const {
    if (output.out() == "-") return absl::InvalidArgumentError("--out -: thumbnails need a folder");
    ThumbnailsAsked asked;
    asked.query = query;
    asked.said = filter.text();
    if (!scale.empty()) asked.scale = scale;
    asked.format = image_format == "envi"   ? PictureFormat::kEnvi
                   : image_format == "tiff" ? PictureFormat::kTiff
                                            : PictureFormat::kPng;
    const bool cubes = asked.format == PictureFormat::kEnvi;
    if (cubes && bits != 0)
      return absl::InvalidArgumentError("--bits: cubes of --image-format envi are float32");
    if (bits != 0) asked.bits = bits;
    if (!scale.empty() && (cubes || bits == 32))
      return absl::InvalidArgumentError(
          "--thumbnail-scale: float32 pictures have no black and white");
    asked.exr = exr;
    asked.background = background;
    asked.layer = layer;
    if (const auto known = image_layer_of(layer); known && !is_radiance(*known))
      return absl::InvalidArgumentError(
          absl::StrCat("--layer ", layer, ": is no radiance; --exr writes its numbers"));
    asked.masks = masks;
    asked.coco = coco;
    if (!imager.empty()) {
      ASSIGN_OR_RETURN(auto read, read_imager(imager));
      asked.imager = read.imager;
      asked.imager_name = std::move(read.name);
      asked.imager_identity = std::move(read.identity);
    } else if (!no_imager) {
      RETURN_IF_ERROR(take_sweep_imager(reader, asked));
    }
    asked.each_part = each_part;
    asked.validation = validation;
    asked.split_seed = split_seed;
    for (const std::string& text : category) {
      ASSIGN_OR_RETURN(auto one, parse_category(text));
      asked.categories.push_back(std::move(one));
    }
    if (!coco && (each_part || !category.empty()))
      return absl::InvalidArgumentError("--category and --each-part: belong to --coco");
    ASSIGN_OR_RETURN(const auto images,
                     export_thumbnails(reader, asked, output.out(), read_pictures));
    print_note("irsig: {}: {} images\n", output.out(), images);
    return absl::OkStatus();
  }
};

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("export", export_description());
  const auto options = std::make_shared<ExportCommand>(*command);
  options->filter.add_ranges(*command);
  command
      ->add_option(
          "--spectra", options->spectra,
          "Of csv: long (a line for each wavelength) or wide (a column for each wavelength "
          "of the --quantity and of its standard error; one --band)")
      ->type_name("FORM")
      ->check(CLI::IsMember({"long", "wide"}));
  const auto of_thumbnails = [&](CLI::Option* option) {
    options->of_thumbnails.push_back(option);
    return option;
  };
  CLI::Option* imager = of_thumbnails(command->add_option(
      "--imager", options->imager,
      "Thumbnails of counts, as the camera of this TOML file records them; with --background"));
  imager->type_name("FILE");
  of_thumbnails(command->add_flag("--no-imager", options->no_imager,
                                  "Thumbnails of stored radiance, although the sweep has [imager]"))
      ->excludes(imager);
  of_thumbnails(command->add_option(
                    "--thumbnail-scale", options->scale,
                    "Black and white of thumbnails: common (0 to the hottest pixel of all that are "
                    "exported, by sweep and band; default), own (of each), or BLACK,WHITE in "
                    "W/(m2 sr)"))
      ->type_name("SCALE")
      ->excludes(imager);
  of_thumbnails(
      command->add_option(
          "--image-format", options->image_format,
          "Of thumbnails: png (grey; default), tiff (grey, or float32 radiances with --bits 32) or "
          "envi (a cube of float32 radiances for each viewpoint and condition, a band for each "
          "band, with its .hdr)"))
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"png", "tiff", "envi"}));
  of_thumbnails(command->add_option("--bits", options->bits,
                                    "Bits of the pictures' grey, 8 (default) or 16; 32: float32, "
                                    "with --image-format tiff"))
      ->type_name("BITS")
      ->check(CLI::IsMember({8, 16, 32}))
      ->excludes(imager);
  of_thumbnails(command->add_flag(
      "--exr", options->exr,
      "With thumbnails also their radiances at the target, the standard errors and all layers, as "
      "EXR"));
  std::vector<std::string> layers;
  for (const ImageLayerInfo& one : kImageLayers) layers.emplace_back(one.name);
  CLI::Option* layer = of_thumbnails(command->add_option(
      "--layer", options->layer,
      "Thumbnails of a further image of the rows, as [image] layers of the sweep asked for it; "
      "default: of the radiance at the target"));
  layer->type_name("NAME")->check(CLI::IsMember(layers))->excludes(imager);
  of_thumbnails(
      command->add_flag("--background", options->background,
                        "Thumbnails as the sensor has them: behind the air, before the background"))
      ->excludes(layer);
  of_thumbnails(command->add_flag("--masks", options->masks,
                                  "Beside each thumbnail a picture of the parts that it shows, and "
                                  "parts.csv with their numbers"));
  of_thumbnails(command->add_flag("--coco", options->coco,
                                  "Labels of what the thumbnails show, too, as COCO's JSON: masks, "
                                  "boxes, rectangles"));
  CLI::Option* category = of_thumbnails(command->add_option(
      "--category", options->category,
      "Of --coco: a class of objects and patterns of its parts, as funnel=funnel*,mast_hot; may be "
      "given several times (default: target=*)"));
  category->type_name("NAME=PATTERNS")->take_all()->allow_extra_args(false);
  of_thumbnails(command->add_flag("--each-part", options->each_part,
                                  "Of --coco: each part is a class of its own"))
      ->excludes(category);
  of_thumbnails(command->add_option("--validation", options->validation,
                                    "Fraction of the viewpoints whose thumbnails are for "
                                    "validation, the others for training"))
      ->type_name("FRACTION");
  of_thumbnails(command->add_option("--split-seed", options->split_seed,
                                    "Chooses the viewpoints of --validation"))
      ->check(seed_number())
      ->type_name("N");
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
