#include "runner/heat_walls.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/materials/total_emissivity.h"
#include "messages/environment/inside_schedule.h"
#include "messages/scene/heat_from_message.h"
#include "messages/scene/material_from_message.h"

namespace irsig {
namespace {

// Emissivities change little with temperature: taken at that of the outdoors.
constexpr double kOutdoorsK = 290;
// A blackbody's flux that a material's tables should cover; less is said.
constexpr double kCoveredShare = 0.9;

}  // namespace

absl::StatusOr<HeatSurface> heat_surface(const schema::Material& material, const std::string& path,
                                         std::vector<std::string>& warning) {
  if (!material.has_solar_absorptance())
    return keyed_problem(path + ".solar_absorptance", "is missing");
  if (material.has_thermal_emissivity())
    return HeatSurface{material.solar_absorptance(), material.thermal_emissivity()};
  const auto spec = material_from_message(material);
  if (!spec.ok()) return at_key(path, spec.status());
  const auto total = total_emissivity(*spec, kOutdoorsK);
  if (!total.ok()) return at_key(path, total.status());
  if (total->covered < kCoveredShare)
    warning.push_back(absl::StrCat(path, ": the spectrum of \"", material.name(), "\" covers ",
                                   std::lround(100 * total->covered),
                                   " % of what it emits; beyond it, its last values make its "
                                   "thermal emissivity ",
                                   absl::SixDigits(total->value), ": state thermal_emissivity"));
  return HeatSurface{material.solar_absorptance(), total->value};
}

absl::StatusOr<std::vector<WallBuildUp>> walls_at_knots(const schema::Sweep& sweep,
                                                        const std::vector<double>& knot_s) {
  std::vector<WallBuildUp> out;
  for (int b = 0; b < sweep.build_up_size(); ++b) {
    const std::string path = absl::StrCat("build_up[", b, "]");
    ASSIGN_OR_RETURN(auto wall, wall_from_message(sweep.build_up(b), path));
    const auto schedule = inside_schedule(sweep.build_up(b));
    if (!schedule.ok()) return at_key(path, schedule.status());
    if (*schedule) wall.inner_at = at_knots(**schedule, knot_s);
    out.push_back(std::move(wall));
  }
  return out;
}

}  // namespace irsig
