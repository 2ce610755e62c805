#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/effects/effects.h"
#include "jobs/resolve.h"
#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

// Returns true for the effects that `without` lists. `only` lists all others.
bool is_of_without(Effect effect) { return is_of_heat(effect) || is_of_plume(effect); }

// Returns the names of the effects of `without`, or of those of `only`.
std::vector<std::string> switchable_names(bool of_without) {
  std::vector<std::string> names;
  const auto add = [&](const auto& table) {
    for (const EffectInfo& effect : table)
      if (effect.switchable) names.emplace_back(effect.name);
  };
  if (of_without) {
    add(heat_effect_table());
    add(plume_effect_table());
  } else {
    add(effect_table());
  }
  return names;
}

constexpr std::array<const char*, 3> kModes = {"auto", "all", "only"};
bool is_mode(const std::string& mode) {
  return std::find(kModes.begin(), kModes.end(), mode) != kModes.end();
}

// One name of a list.
void check_effect_name(const google::protobuf::RepeatedPtrField<std::string>& names, int i,
                       const char* list, bool of_without, const SectionCheck& check) {
  const std::string& name = names[i];
  const std::string key = absl::StrCat(list, "[", i, "]");
  if (std::find(names.begin(), names.begin() + i, name) != names.begin() + i) {
    check.error_at(key, absl::StrCat("= \"", name, "\" is there twice"));
    return;
  }
  const auto effect = effect_named(name);
  if (!effect) {
    check.error_at(key, absl::StrCat("= \"", name, "\" is no effect that can be left out, ",
                                     suggestion(name, switchable_names(of_without))));
  } else if (is_of_cloud(*effect)) {
    check.error_at(key, absl::StrCat("= \"", name,
                                     "\" is left out by its bound alone; for a clear sky leave out "
                                     "[[season.cloud]]"));
  } else if (!of_without && is_of_without(*effect)) {
    check.error_at(key, absl::StrCat("= \"", name, "\" is an effect of ",
                                     is_of_heat(*effect) ? "computed temperatures" : "hot gas",
                                     ", which is on unless effects.without names it"));
  } else if (of_without && !is_of_without(*effect)) {
    check.error_at(key,
                   absl::StrCat("= \"", name, "\" is no effect of computed temperatures or of hot ",
                                "gas, expected one of ", quoted_list(switchable_names(true)),
                                "; the others are left out by mode = \"only\""));
  } else if (!info_of(*effect).switchable) {
    check.error_at(
        key, absl::StrCat("= \"", name, "\" cannot be left out by itself, ", "expected one of ",
                          quoted_list(switchable_names(of_without))));
  }
}

void sort_by_table(google::protobuf::RepeatedPtrField<std::string>& names) {
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return effect_named(a) < effect_named(b);
  });
}

}  // namespace

void check_effects(const SweepFile& file, Findings& findings) {
  const schema::Effects& effects = file.sweep.effects();
  const SectionCheck check(effects, "effects", findings);
  // An empty list is one, too: none of them.
  const bool has_list = file.where.contains("effects.only");
  const bool known = !effects.has_mode() || is_mode(effects.mode());
  const bool only = effects.mode() == "only";
  if (only && !has_list)
    check.error("only", absl::StrCat("is missing, expected the effects that are on, of ",
                                     quoted_list(switchable_names(false))));
  if (has_list && !only && known) check.error("only", "does not apply without mode = \"only\"");
  for (int i = 0; i < effects.without_size(); ++i) {
    const auto effect = effect_named(effects.without(i));
    const std::string key = absl::StrCat("without[", i, "]");
    if (effect && is_of_heat(*effect) && !file.sweep.has_heat())
      check.error_at(key, "does not apply without [heat]: it is an effect of temperatures");
    if (effect && is_of_plume(*effect) && !file.sweep.has_plume())
      check.error_at(key, "does not apply without [plume]: it is an effect of hot gas");
  }
  check_effect_names(effects, findings);
}

void check_effect_names(const schema::Effects& effects, Findings& findings) {
  const SectionCheck check(effects, "effects", findings);
  (void)check.one_of("mode", {kModes.begin(), kModes.end()});
  for (int i = 0; i < effects.only_size(); ++i)
    check_effect_name(effects.only(), i, "only", false, check);
  for (int i = 0; i < effects.without_size(); ++i)
    check_effect_name(effects.without(), i, "without", true, check);
}

void write_effect_defaults(schema::Sweep& sweep) {
  schema::Effects& effects = *sweep.mutable_effects();
  if (!effects.has_mode()) effects.set_mode("auto");
  // The lists are sorted, so that the same effects give the same sweep in whatever order they were
  // written.
  sort_by_table(*effects.mutable_only());
  sort_by_table(*effects.mutable_without());
}

}  // namespace irsig
