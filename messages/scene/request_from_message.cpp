#include "messages/scene/request_from_message.h"

#include <algorithm>
#include <bit>
#include <numbers>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "messages/environment/named.h"

namespace irsig {

absl::StatusOr<EffectChoice> effects_from_message(const schema::Effects& effects) {
  using Mode = EffectChoice::Mode;
  const auto mode =
      named<Mode>("effects.mode", effects.mode(),
                  {{"auto", Mode::kAuto}, {"all", Mode::kAll}, {"only", Mode::kOnly}});
  if (!mode.ok()) return mode.status();
  EffectChoice choice;
  choice.mode = *mode;
  for (const std::string& name : effects.only()) {
    const auto effect = effect_named(name);
    if (!effect || !info_of(*effect).switchable || is_of_cloud(*effect))
      return keyed_problem("effects.only",
                           absl::StrCat("\"", name, "\" is no effect that can be left out"));
    choice.only.push_back(*effect);
  }
  for (const std::string& name : effects.without()) {
    const auto effect = effect_named(name);
    if (effect && is_of_plume(*effect))
      choice.without_plume.push_back(*effect);
    else if (!effect || !is_of_heat(*effect))
      return keyed_problem("effects.without",
                           absl::StrCat("\"", name, "\" is no effect that it can leave out"));
  }
  return choice;
}

absl::StatusOr<AccuracySpec> accuracy_from_message(const schema::Accuracy& accuracy) {
  AccuracySpec out;
  if (accuracy.has_relative_error()) {
    out.relative_error = accuracy.relative_error();
    out.absolute_error_k = accuracy.absolute_error_k();
  }
  if (accuracy.has_target_paths()) out.target_paths = accuracy.target_paths();
  if (accuracy.has_samples_per_replicate() && !accuracy.has_relative_error())
    out.samples_per_replicate = accuracy.samples_per_replicate();
  if (out.relative_error <= 0 && out.target_paths <= 0 && out.samples_per_replicate == 0)
    return keyed_problem(
        "accuracy", "a time budget must be turned into samples_per_replicate before jobs are run");
  out.replicates = accuracy.replicates();
  out.max_samples_per_replicate = accuracy.max_samples_per_replicate();
  return out;
}

absl::StatusOr<ImageSpec> image_from_message(const schema::Image& image) {
  const auto camera =
      named<bool>("image.kind", image.kind(), {{"framed", false}, {"camera", true}});
  if (!camera.ok()) return camera.status();
  ImageSpec out;
  if (image.pixels_size() != 2 || image.pixels(0) == 0 || image.pixels(1) == 0)
    return keyed_problem("image.pixels", "expected a width and a height");
  out.width_px = image.pixels(0);
  out.height_px = image.pixels(1);
  if (*camera) {
    out.camera.emplace().field_of_view_rad = image.field_of_view_deg() * std::numbers::pi / 180;
    if (!image.look_at_m().empty()) {
      if (image.look_at_m_size() != 3)
        return keyed_problem("image.look_at_m", "expected three numbers");
      out.camera->look_at_m = Vec<Body>{image.look_at_m(0), image.look_at_m(1), image.look_at_m(2)};
    }
  }
  out.margin = image.margin();
  out.samples = image.samples();
  if (image.has_samples() && (!std::has_single_bit(out.samples) || out.samples < 2))
    return keyed_problem("image.samples", "expected a power of two");
  out.relative_error = image.pixel_error_percent() / 100;
  out.error_k = image.pixel_error_k();
  if (image.has_max_samples()) out.most_samples = image.max_samples();
  if (!std::has_single_bit(out.most_samples))
    return keyed_problem("image.max_samples", "expected a power of two");
  out.whole_parts = image.whole_parts();
  for (const std::string& name : image.layers()) {
    const auto layer = image_layer_of(name);
    if (!layer)
      return keyed_problem("image.layers", absl::StrCat("there is no layer \"", name, "\""));
    out.layer.push_back(*layer);
  }
  std::sort(out.layer.begin(), out.layer.end());
  out.layer.erase(std::unique(out.layer.begin(), out.layer.end()), out.layer.end());
  return out;
}

}  // namespace irsig
