// Reads the unit and the axes that a mesh file states.
#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "core/base/printable.h"
#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"

namespace irsig {
namespace {

constexpr std::size_t kMostFront = 4000;  // bytes in which a comment may stand

constexpr std::pair<std::string_view, double> kUnits[] = {{"mm", 1e-3},
                                                          {"millimeter", 1e-3},
                                                          {"millimeters", 1e-3},
                                                          {"millimetre", 1e-3},
                                                          {"millimetres", 1e-3},
                                                          {"cm", 1e-2},
                                                          {"centimeter", 1e-2},
                                                          {"centimeters", 1e-2},
                                                          {"centimetre", 1e-2},
                                                          {"centimetres", 1e-2},
                                                          {"m", 1},
                                                          {"meter", 1},
                                                          {"meters", 1},
                                                          {"metre", 1},
                                                          {"metres", 1},
                                                          {"in", 0.0254},
                                                          {"inch", 0.0254},
                                                          {"inches", 0.0254},
                                                          {"ft", 0.3048},
                                                          {"foot", 0.3048},
                                                          {"feet", 0.3048},
                                                          {"km", 1e3},
                                                          {"kilometers", 1e3},
                                                          {"kilometres", 1e3}};

// The unit of a comment that speaks of units and names one, and no other; words apart from letters.
std::optional<double> unit_in(std::string_view comment) {
  std::vector<std::string> words(1);
  for (const char c : comment) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0)
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (std::ranges::none_of(words, [](const std::string& w) { return w == "unit" || w == "units"; }))
    return std::nullopt;
  std::optional<double> found;
  for (const std::string& word : words)
    for (const auto& [name, unit_m] : kUnits)
      if (word == name && !(name == "in" && words.size() > 4)) {
        if (found && *found != unit_m) return std::nullopt;
        found = unit_m;
      }
  return found;
}

bool ends_with(std::string_view name, std::string_view ending) {
  return name.size() >= ending.size() &&
         equals_ignoring_case(name.substr(name.size() - ending.size()), ending);
}

}  // namespace

StatedFrame stated_frame(std::string_view bytes, const std::string& file_name) {
  StatedFrame out;
  if (ends_with(file_name, ".gltf") || ends_with(file_name, ".glb")) {
    out.unit_m = 1;
    out.forward_axis = "+z";
    out.up_axis = "+y";
    out.unit_from = out.axes_from = "the glTF 2.0 standard";
    return out;
  }
  const bool obj = ends_with(file_name, ".obj"), ply = ends_with(file_name, ".ply"),
             stl = ends_with(file_name, ".stl");
  if (!obj && !ply && !stl) return out;
  const auto take = [&](std::string_view comment) {
    while (!comment.empty() && (comment.front() == '#' || comment.front() == ' '))
      comment.remove_prefix(1);
    if (out.unit_m || !unit_in(comment)) return;
    out.unit_m = unit_in(comment);
    out.unit_from = "\"" + one_line(comment.substr(0, 80)) + "\"";
  };
  TextCursor cursor(bytes.substr(0, kMostFront));
  if (stl) {
    const std::string_view line = cursor.rest_of_line().text;
    const std::string_view head = line.substr(0, std::min<std::size_t>(line.size(), 80));
    take(head.substr(0, head.find('\0')));
    return out;
  }
  do {
    const std::string_view line = cursor.rest_of_line().text;
    if (obj && line.starts_with('#')) take(line);
    if (ply && (line.starts_with("comment ") || line.starts_with("obj_info ")))
      take(line.substr(line.find(' ')));
    if (ply && line.starts_with("end_header")) break;
    if (obj && line.starts_with("v ")) break;
  } while (cursor.next_line());
  return out;
}

}  // namespace irsig
