#include "core/signature/land_clutter.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/status_macros.h"
#include "core/signature/background_window.h"
#include "core/signature/view/land_background.h"

namespace irsig {
namespace {

// The sources of a background that shine under a condition: all but other conditions' suns.
std::vector<std::size_t> shining(const LandBackground& land, const ConditionSources& light) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < land.sources().size(); ++i)
    if (light.light_of_path(land.sources()[i])) out.push_back(i);
  return out;
}

// Returns the fractions of the window by the land's materials.
std::vector<double> material_fractions(const ClutterField& field,
                                       const std::vector<SourceId>& source,
                                       const SourceLayout& layout, const Land& land) {
  using Kind = SourceLayout::Kind;
  std::vector<double> out(land.materials(), 0.0);
  for (std::size_t i = 0; i < field.sources; ++i) {
    const SourceLayout::Place at = layout.place_of(source[i]);
    if (at.kind != Kind::kBehindLand) continue;
    const std::uint32_t kind = at.index / layout.behind_ranges();
    double& sum =
        out[kind < layout.land_kinds() ? land.material_of(kind) : kind - layout.land_kinds()];
    for (std::size_t pixel = 0; pixel < field.pixels(); ++pixel)
      sum += static_cast<double>(field.weight[pixel * field.sources + i]);
  }
  for (double& f : out) f /= static_cast<double>(field.pixels());
  return out;
}

}  // namespace

absl::Status add_clutter(const MeasuredView& view, const ViewRequest& request, ViewResult& result) {
  constexpr std::uint32_t kRays = 2;  // along each side of a pixel
  const PreparedScene& scene = view.setup.scene;
  const ViewFrame& frame = view.setup.aimed().frame;
  const double range_m = length(frame.sensor);
  const double side_m = kClutterDiameters * 2 * scene.target.radius_m,
               on_plane_m = side_m * frame.plane_m / range_m;
  PictureFrame window;
  window.rectangle = {-0.5 * on_plane_m, -0.5 * on_plane_m, on_plane_m, on_plane_m};
  window.plane_m = frame.plane_m;
  window.width_px = window.height_px = kClutterPixels;
  ASSIGN_OR_RETURN(
      const LandBackground land,
      LandBackground::make(scene, request, view.setup.plan.effects, frame, window, kRays, false));
  const std::vector<float> weight = land.weights();
  const std::size_t sources = land.sources().size();
  const double pixel_m = side_m / kClutterPixels;

  const double seen_m2 = view.totals.front_area_m2, whole_m2 = seen_m2 + view.totals.hidden_area_m2,
               visible = whole_m2 > 0 ? seen_m2 / whole_m2 : 0;
  const WeightDeviations deviations({kClutterPixels, kClutterPixels, pixel_m, sources, weight},
                                    seen_m2);
  // Conditions of the same suns share a field.
  struct Field {
    ClutterField field;
    SpectralSet factor;
    std::vector<double> material;
  };
  std::map<std::vector<std::size_t>, Field> known;
  const std::vector<std::uint32_t>& bands = request.selected_band;
  for (std::size_t c = 0; c < request.selected_condition.size(); ++c) {
    const ConditionSources& light = land.light(request.selected_condition[c]);
    const std::vector<std::size_t> used = shining(land, light);
    const auto apparent = [&](std::size_t i) {
      return light.apparent(*light.light_of_path(land.sources()[i]));
    };
    const auto [at, fresh] = known.try_emplace(used);
    ClutterField& field = at->second.field;
    if (fresh) {
      field = {kClutterPixels, kClutterPixels, pixel_m, used.size(), {}};
      field.weight.reserve(field.pixels() * used.size());
      for (std::size_t pixel = 0; pixel < field.pixels(); ++pixel)
        for (const std::size_t i : used) field.weight.push_back(weight[pixel * sources + i]);
      std::vector<SourceId> source;
      for (const std::size_t i : used) source.push_back(land.sources()[i]);
      at->second.factor = deviations.factor(used);
      at->second.material = material_fractions(field, source, land.layout(), land.land());
    }
    std::vector<SpectralSet> spectra;
    for (const std::uint32_t b : bands) {
      SpectralSet& of_band = spectra.emplace_back();
      for (const std::size_t i : used) of_band.push_back(on_bins(apparent(i), scene.axis.band(b)));
    }
    const ClutterModes modes = clutter_modes(at->second.factor, spectra);
    for (std::size_t b = 0; b < bands.size(); ++b) {
      std::vector<double> radiance;
      for (const std::size_t i : used)
        radiance.push_back(in_band(apparent(i), scene.axis.band(bands[b])));
      ClutterStatistics statistics = clutter_of(field, radiance, seen_m2);
      SignatureResult& row = result.row[c * bands.size() + b];
      statistics.mean.value += row.path_radiance_w_m2_sr;
      row.clutter = background_clutter(field, statistics, modes, b, visible, at->second.material);
    }
  }
  return absl::OkStatus();
}

}  // namespace irsig
