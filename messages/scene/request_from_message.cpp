#include "messages/scene/request_from_message.h"

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
    if (!effect || !info_of(*effect).switchable)
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
  if (out.relative_error <= 0 && out.target_paths <= 0 &&
      out.samples_per_replicate == 0)
    return keyed_problem(
        "accuracy", "a time budget must be turned into samples_per_replicate before jobs are run");
  out.replicates = accuracy.replicates();
  out.max_samples_per_replicate = accuracy.max_samples_per_replicate();
  return out;
}

}  // namespace irsig
