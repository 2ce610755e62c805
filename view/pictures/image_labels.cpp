#include "view/pictures/image_labels.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "view/base/table.h"

namespace irsig {
namespace {

using S = StoredSignature;

struct Number {
  const char* name;
  double S::*member;
};
constexpr Number kAspect[] = {{"aspect_azimuth_deg", &S::aspect_azimuth_deg},
                              {"aspect_elevation_deg", &S::aspect_elevation_deg},
                              {"range_m", &S::range_m},
                              {"sun_azimuth_deg", &S::sun_azimuth_deg},
                              {"sun_zenith_deg", &S::sun_zenith_deg}};
constexpr Number kValues[] = {{"intensity_w_sr", &S::intensity_w_sr},
                              {"numerical_error_w_sr", &S::numerical_error_w_sr},
                              {"apparent_intensity_w_sr", &S::apparent_intensity_w_sr},
                              {"apparent_numerical_error_w_sr", &S::apparent_numerical_error_w_sr},
                              {"contrast_intensity_w_sr", &S::contrast_intensity_w_sr},
                              {"contrast_numerical_error_w_sr", &S::contrast_numerical_error_w_sr},
                              {"background_radiance_w_m2_sr", &S::background_radiance_w_m2_sr},
                              {"projected_area_m2", &S::projected_area_m2}};

std::vector<Column> heads_of(const LabelColumns& columns) {
  std::vector<Column> heads;
  const auto head = [&](std::string name) { heads.push_back({std::move(name)}); };
  head("image");
  if (columns.band) head("image_band");
  if (columns.mask) head("mask");
  if (columns.split) head("split");
  for (const char* name : {"sweep", "row", "season", "time_utc", "band"}) head(name);
  for (const Number& n : kAspect) head(n.name);
  for (const char* name : {"width_px", "height_px", "pixel_rad"}) head(name);
  if (columns.imager) {
    for (const char* name :
         {"imager", "counts_per_w_m2_sr", "offset_counts", "noise_w_m2_sr", "saturated_px"})
      head(name);
  } else if (columns.scale) {
    for (const char* name : {"black_w_m2_sr", "white_w_m2_sr"}) head(name);
  }
  for (const char* name : {"target_area_px", "target_in_frame_px", "target_px", "box_left_px",
                           "box_top_px", "box_width_px", "box_height_px"})
    head(name);
  for (const Number& n : kValues) head(n.name);
  for (const std::string& part : columns.part) {
    head(part + ":part_intensity_w_sr");
    head(part + ":part_intensity_stderr_w_sr");
  }
  return heads;
}

}  // namespace

absl::Status write_labels(StoreReader& reader, const LabelColumns& columns,
                          const std::vector<ImageLabel>& labels, std::ostream& out) {
  ASSIGN_OR_RETURN(auto table, make_table_writer("csv", heads_of(columns), out));
  const auto known = [](double v) { return std::isnan(v) ? Cell() : Cell(v); };
  for (const ImageLabel& label : labels) {
    const S& s = label.signature;
    std::vector<Cell> line{label.image};
    if (label.band) line.emplace_back(std::uint64_t{*label.band});
    if (columns.mask) line.emplace_back(label.mask);
    if (columns.split) line.emplace_back(label.split);
    line.insert(line.end(), {s.sweep, s.row, s.season, s.time_utc, s.band});
    for (const Number& n : kAspect) line.push_back(known(s.*n.member));
    const auto add_counts = [&](std::initializer_list<std::uint32_t> numbers) {
      for (const std::uint32_t n : numbers) line.emplace_back(std::uint64_t{n});
    };
    add_counts({label.width_px, label.height_px});
    line.emplace_back(label.pixel_rad);
    if (label.counts)
      line.insert(line.end(), {label.counts->imager, label.counts->counts_per_w_m2_sr,
                               label.counts->offset_counts, label.counts->noise_w_m2_sr,
                               label.counts->saturated_px});
    else if (label.scale)
      line.insert(line.end(), {label.scale->black_w_m2_sr, label.scale->white_w_m2_sr});
    line.emplace_back(s.projected_area_m2 / std::pow(label.pixel_rad * s.range_m, 2));
    line.emplace_back(label.target_in_frame_px);
    const ImageContent& target = label.target;
    add_counts({target.shown_px, target.left_px, target.top_px, target.width_px, target.height_px});
    for (const Number& n : kValues) line.push_back(known(s.*n.member));
    ASSIGN_OR_RETURN(const auto parts, reader.parts(s.signature_id));
    for (const std::string& name : columns.part) {
      const auto part = std::find_if(parts.begin(), parts.end(),
                                     [&](const StoredPart& p) { return p.part == name; });
      const bool there = part != parts.end();
      line.push_back(there ? Cell(part->intensity_w_sr) : Cell());
      line.push_back(there ? Cell(part->intensity_stderr_w_sr) : Cell());
    }
    table->row(line);
  }
  return table->finish();
}

}  // namespace irsig
