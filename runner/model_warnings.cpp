#include "runner/model_warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/scene/check/mesh_lint.h"
#include "core/scene/trace/target.h"
#include "messages/environment/weather_from_message.h"

namespace irsig {
namespace {

Problem noted(const std::string& key, const std::string& what) {
  return {"", key, absl::StrCat(key, ": ", what)};
}

// Sheets are mostly meant to have two sides.
void see_open_parts(const SceneSpec& scene, std::vector<Problem>& out) {
  const auto part_of_group = part_of_groups(scene.mesh, scene.part);
  if (!part_of_group.ok()) return;  // said elsewhere
  std::vector<std::uint64_t> facets(scene.part.size(), 0);
  for (const OpenGroup& open : open_groups(scene.mesh))
    for (std::size_t g = 0; g < scene.mesh.group.size(); ++g)
      if (scene.mesh.group[g] == open.group) facets[(*part_of_group)[g]] += open.facets;
  for (std::size_t p = 0; p < facets.size(); ++p)
    if (facets[p] > 0 && !scene.part[p].two_sided)
      out.push_back(noted(
          absl::StrCat("part[", p, "]"),
          absl::StrCat(facets[p], " facets of \"", scene.part[p].name,
                       "\" belong to open shells of the model, and send nothing from behind: "
                       "two_sided = true if they are sheets; `irsig model check` lists the holes "
                       "if they are not")));
}

struct Box {
  Vec<Body> low, high;
};
Box box_of(const Mesh& mesh) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const auto& triangle : mesh.triangle)
    for (const std::uint32_t i : triangle) {
      const Vec<Body>& v = mesh.vertex[i];
      box.low = {std::min(box.low.x, v.x), std::min(box.low.y, v.y), std::min(box.low.z, v.z)};
      box.high = {std::max(box.high.x, v.x), std::max(box.high.y, v.y), std::max(box.high.z, v.z)};
    }
  return box;
}

}  // namespace

double fraction_below_surface(const Mesh& mesh) {
  double below = 0, all = 0;
  for (const auto& t : mesh.triangle) {
    const Vec<Body> a = mesh.vertex[t[0]], b = mesh.vertex[t[1]], c = mesh.vertex[t[2]];
    const double area = length(cross(b - a, c - a));
    all += area;
    if (a.z + b.z + c.z > 0) below += area;
  }
  return all > 0 ? below / all : 0;
}

namespace {

// Viewpoints so near that the target reaches past the sensor.
void see_near_sensors(const schema::ResolvedSweep& sweep, const Mesh& mesh,
                      std::vector<Problem>& out) {
  double reach_m = 0;
  for (const Vec<Body>& v : mesh.vertex) reach_m = std::max(reach_m, length(v));
  const auto near =
      std::count_if(sweep.viewpoint().begin(), sweep.viewpoint().end(),
                    [&](const schema::Viewpoint& v) { return v.range_m() < reach_m; });
  if (near > 0)
    out.push_back(noted(
        "viewpoints.range_m",
        absl::StrFormat(
            "%d of %d viewpoints are nearer than the target reaches (%.6g m): their intensities "
            "are range^2 times radiance times solid angle, and what stands behind the target is "
            "taken at the azimuth of the reference point",
            near, sweep.viewpoint_size(), reach_m)));
}

}  // namespace

std::vector<PlacementNote> placement_notes(const Mesh& mesh, const Placement& placement) {
  std::vector<PlacementNote> out;
  const Box box = box_of(mesh);
  const Vec<Body> size = box.high - box.low, middle = 0.5 * (box.high + box.low);
  const double longest = std::max({size.x, size.y, size.z});
  const std::string is = absl::StrFormat("the model is %.6g m long, %.6g m wide and %.6g m high",
                                         size.x, size.y, size.z);
  const auto say = [&](const char* key, const std::string& what) { out.push_back({key, what}); };
  // Ships are up to 460 m long.
  const bool outdoors = placement.surroundings == "sea" || placement.surroundings == "ground";
  if (longest > 1000 || longest < (outdoors ? 0.5 : 0.05))
    say("model.unit_m", absl::StrCat(is, ": is unit_m = ", placement.unit_m, " right?"));
  if (size.z > 2 * std::max(size.x, size.y))
    say("model.up_axis", absl::StrCat(is,
                                      ": does it stand on end? up_axis is the file's axis that "
                                      "points up"));
  else if (size.y > 1.5 * size.x && size.y > size.z && size.x > 0.1 * size.y)
    say("model.forward_axis", absl::StrCat(is,
                                           ": is it turned? forward_axis is the file's axis that "
                                           "points to the bow"));
  const double aside = std::hypot(middle.x, middle.y);
  if (aside > longest)
    say("model.file",
        absl::StrFormat("the model's middle is %.6g m away from the reference point, around which "
                        "the sensor moves: reference = \"bbox_bottom_center\" puts it there",
                        aside));
  const std::string& kind = placement.surroundings;
  if (kind != "sea" && kind != "ground") return out;
  const double above_m = -box.high.z;  // of the lowest point
  if (const double below = fraction_below_surface(mesh);
      below > 0.7 || (kind == "sea" && -box.low.z < 0.1 * size.z) ||
      (kind == "ground" && below > 0.02)) {
    say("model.file",
        absl::StrFormat("%.0f %% of the model's area lie below the %s, where nothing is seen: %s",
                        100 * below, kind == "sea" ? "waterline" : "ground",
                        kind == "sea" ? "draft_m says how deep it floats"
                                      : "draft_m = 0 puts it on the ground"));
  } else if (above_m > 0.02 * longest && above_m < longest && !placement.placed) {
    say("model.file",
        absl::StrFormat("the model's lowest point is %.6g m above the %s: draft_m lowers it, "
                        "offset_m = [0, 0, 0] says that it is meant",
                        above_m, kind == "sea" ? "sea" : "ground"));
  } else if (above_m > 50 && !placement.placed && placement.atmosphere) {
    say("model.file",
        absl::StrFormat(
            "the model's lowest point is %.6g m up, but air and sky are taken 5 m above "
            "the surface: lower it (draft_m = 0) and put it there with [place] above_surface_m = "
            "%.6g, which they follow",
            above_m, above_m));
  } else if (kind == "sea" && std::abs(above_m) <= 1e-3 * longest && !placement.placed) {
    say("model.file",
        "the model stands on the sea with its lowest point at the waterline: draft_m says how deep "
        "a hull with a keel floats; draft_m = 0 that it ends there");
  }
  return out;
}

absl::Status check_above_surface(const schema::ResolvedSweep& sweep, const Mesh& mesh) {
  if (sweep.condition_size() == 0) return absl::OkStatus();
  const std::string& kind = sweep.condition(0).surroundings().kind();
  const auto lowest =
      std::min_element(sweep.condition().begin(), sweep.condition().end(),
                       [&](const schema::Condition& a, const schema::Condition& b) {
                         return above_surface_m(sweep, a) < above_surface_m(sweep, b);
                       });
  if ((kind != "sea" && kind != "ground") ||
      !(box_of(mesh).low.z > above_surface_m(sweep, *lowest)))
    return absl::OkStatus();
  const schema::Model& model = sweep.sweep().model();
  const char* key = model.has_draft_m()         ? "model.draft_m"
                    : model.offset_m_size() > 0 ? "model.offset_m"
                    : model.has_file()          ? "model.file"
                                                : "model";
  return keyed_problem(
      key, absl::StrCat("all of the target lies below the ", kind == "sea" ? "waterline" : "ground",
                        ", where nothing is seen, expected something that rises above it"));
}

namespace {

// By how much model.offset_m moves the target away from its reference point; 0: it does not, or by
// less than the target is large. [m]
struct FarOffset {
  double offset_m = 0, size_m = 0;
  std::string remedy;
};
FarOffset far_offset(const schema::Model& model, const Mesh& mesh) {
  if (model.offset_m_size() != 3) return {};
  const Vec<Body> offset{model.offset_m(0), model.offset_m(1), -model.offset_m(2)};
  const Box box = box_of(mesh);
  const Vec<Body> middle = 0.5 * (box.low + box.high);
  const double size_m = length(box.high - box.low), away_m = length(middle);
  // An offset that brings a far model to its reference point is what it is for.
  if (!(length(offset) > size_m && away_m > size_m && away_m > length(middle - offset))) return {};
  const bool up = -offset.z > 0.5 * length(offset);
  return {length(offset), size_m,
          up ? absl::StrFormat("leave offset_m out and put the target into the air: "
                               "above_surface_m = %.9g in [place]",
                               -offset.z)
             : "leave offset_m out: viewpoints are where the sensor is, seen from the target"};
}

// Limit of the offset as a fraction of the shortest range: an offset changes an intensity by at
// most twice this fraction.
constexpr double kOffsetOfRange = 0.01;

std::string offset_text(const FarOffset& far) {
  return absl::StrFormat(
      "moves the target by %.6g m (its size is %.4g m), away from the reference point from which "
      "range_m and aspects of viewpoints count",
      far.offset_m, far.size_m);
}

// A sheet of metal of metres is most likely one of millimetres; so is another layer thicker than a
// dam's parapet.
void see_thick_layers(const schema::Sweep& sweep, std::vector<Problem>& out) {
  constexpr double kMetal_w_m_k = 10, kMostMetal_m = 0.5, kMostOther_m = 5;
  for (int i = 0; i < sweep.build_up_size(); ++i)
    for (int j = 0; j < sweep.build_up(i).layer_size(); ++j) {
      const schema::Layer& layer = sweep.build_up(i).layer(j);
      const bool metal =
          layer.conductivity_w_m_k() > kMetal_w_m_k && layer.density_kg_m3() > 1000;
      if (layer.thickness_m() <= (metal ? kMostMetal_m : kMostOther_m)) continue;
      out.push_back(noted(
          absl::StrCat("build_up[", i, "].layer[", j, "].thickness_m"),
          absl::StrFormat("a layer%s of %.6g m: is it in millimetres? %.6g mm are thickness_m = %.6g",
                          metal ? " of metal" : "", layer.thickness_m(), layer.thickness_m(),
                          layer.thickness_m() / 1000)));
    }
}

double shortest_range_m(const schema::ResolvedSweep& sweep) {
  double out = INFINITY;
  for (const schema::Viewpoint& v : sweep.viewpoint()) out = std::min(out, v.range_m());
  return out;
}

}  // namespace

absl::Status check_offset(const schema::ResolvedSweep& sweep, const Mesh& mesh) {
  const FarOffset far = far_offset(sweep.sweep().model(), mesh);
  if (far.offset_m <= kOffsetOfRange * shortest_range_m(sweep)) return absl::OkStatus();
  return keyed_problem("model.offset_m", absl::StrCat(offset_text(far), "; ", far.remedy));
}

std::vector<Problem> model_warnings(const schema::ResolvedSweep& sweep, const SceneSpec& scene) {
  std::vector<Problem> out;
  see_near_sensors(sweep, scene.mesh, out);
  see_thick_layers(sweep.sweep(), out);
  const schema::Model& model = sweep.sweep().model();
  if (const FarOffset far = far_offset(model, scene.mesh); far.offset_m > 0)
    out.push_back(
        noted("model.offset_m",
              absl::StrFormat("%s: intensities differ by up to %.2g %%; %s", offset_text(far),
                              200 * far.offset_m / shortest_range_m(sweep), far.remedy)));
  if (!model.has_file()) return out;
  if (!model.has_accepted_backface_fraction()) see_open_parts(scene, out);
  // A target in the air stands on no surface.
  const bool in_the_air =
      sweep.condition_size() > 0 && above_surface_m(sweep, sweep.condition(0)) > 0;
  Placement placement{.unit_m = model.unit_m(),
                      .placed = model.has_draft_m() || model.offset_m_size() > 0,
                      .surroundings = sweep.condition_size() > 0 && !in_the_air
                                          ? sweep.condition(0).surroundings().kind()
                                          : std::string(),
                      .atmosphere = sweep.sweep().air().model() == "atmosphere"};
  for (const PlacementNote& note : placement_notes(scene.mesh, placement))
    out.push_back(noted(note.key, note.text));
  return out;
}

}  // namespace irsig
