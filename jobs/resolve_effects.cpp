#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/effects/effects.h"
#include "jobs/nearest_name.h"
#include "jobs/resolve.h"

namespace irsig {
namespace {

std::vector<std::string> switchable_names() {
  std::vector<std::string> names;
  for (const EffectInfo& effect : effect_table())
    if (effect.switchable) names.emplace_back(effect.name);
  return names;
}

void check_name(const schema::Effects& effects, int i, const SectionCheck& check) {
  const std::string& name = effects.only(i);
  const std::string key = absl::StrCat("only[", i, "]");
  const auto& names = effects.only();
  if (std::find(names.begin(), names.begin() + i, name) != names.begin() + i) {
    check.error_at(key, absl::StrCat("= \"", name, "\" is there twice"));
    return;
  }
  const auto effect = effect_named(name);
  if (!effect) {
    check.error_at(key, absl::StrCat("= \"", name, "\" is no effect that can be left out, ",
                                     suggestion(name, switchable_names())));
  } else if (!info_of(*effect).switchable) {
    check.error_at(key, absl::StrCat("= \"", name, "\" cannot be left out by itself, ",
                                     "expected one of ", quoted_list(switchable_names())));
  }
}

}  // namespace

void check_effects(const SweepFile& file, Findings& findings) {
  const schema::Effects& effects = file.sweep.effects();
  const SectionCheck check(effects, "effects", findings);
  // An empty list is one, too: none of them.
  const bool has_list = file.where.contains("effects.only");
  const bool known = check.one_of("mode", {"auto", "all", "only"});
  const bool only = effects.mode() == "only";
  if (only && !has_list)
    check.error("only", absl::StrCat("is missing, expected the effects that are on, of ",
                                     quoted_list(switchable_names())));
  if (has_list && !only && (known || !effects.has_mode()))
    check.error("only", "does not apply without mode = \"only\"");
  for (int i = 0; i < effects.only_size(); ++i) check_name(effects, i, check);
}

void write_effect_defaults(schema::Sweep& sweep) {
  schema::Effects& effects = *sweep.mutable_effects();
  if (!effects.has_mode()) effects.set_mode("auto");
  // The same effects are the same sweep, in whatever order they were written.
  std::sort(
      effects.mutable_only()->begin(), effects.mutable_only()->end(),
      [](const std::string& a, const std::string& b) { return effect_named(a) < effect_named(b); });
}

}  // namespace irsig
