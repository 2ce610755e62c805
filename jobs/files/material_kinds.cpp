#include "jobs/files/material_kinds.h"

#include <set>
#include <string>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "core/materials/optical/material_library.h"

namespace irsig {
namespace {

// Returns the text itself, kept as long as the program runs: keys are plain pointers.
const char* kept(std::string text) {
  static std::set<std::string> known;
  return known.insert(std::move(text)).first->c_str();
}

OpticalProperty spectral(const char* key) {
  return {key, {key}, kept(absl::StrCat(key, "_table")), kept(absl::StrCat(key, "_file"))};
}

// Lists the keys of a model's properties.
struct AddKey {
  MaterialKind& kind;

  void operator()(MaterialKey key, const Spectrum&) const {
    kind.property.push_back(spectral(key.name));
  }
  void operator()(MaterialKey key, const OpticalConstants&) const {
    kind.property.push_back(
        {"optical constants", {"n", "k"}, key.name, kept(absl::StrCat(key.name, "_file"))});
  }
  void operator()(MaterialKey key, const TabulatedBrdf&) const {
    kind.property.push_back({key.name, {}, key.name, kept(absl::StrCat(key.name, "_file"))});
  }
  void operator()(MaterialKey key, bool) const { kind.optional.emplace_back(key.name); }
  template <typename Value>
  void operator()(MaterialKey key, const Value&) const {
    if (*key.name != 0) (key.optional ? kind.optional : kind.required).emplace_back(key.name);
  }
};

std::vector<MaterialKind> make_kinds() {
  std::vector<MaterialKind> kinds;
  for (const MaterialModel& model : material_models()) {
    MaterialKind& kind = kinds.emplace_back();
    kind.name = kept(model_kind(model));
    for_each_property(model, AddKey{kind});
    if (std::holds_alternative<Lambert>(model))
      kind.property.push_back(spectral("reflectance"));  // instead of the emissivity
    else
      kind.optional.emplace_back("allow_energy_gain");
  }
  return kinds;
}

}  // namespace

const std::vector<MaterialKind>& material_kinds() {
  static const std::vector<MaterialKind> kinds = make_kinds();
  return kinds;
}

const MaterialKind* find_material_kind(const std::string& name) {
  for (const MaterialKind& kind : material_kinds())
    if (kind.name == name) return &kind;
  return nullptr;
}

std::vector<const char*> keys_of(const MaterialKind& kind) {
  std::vector<const char*> keys = {"name", "kind", "solar_absorptance", "thermal_emissivity"};
  for (const OpticalProperty& property : kind.property) {
    keys.insert(keys.end(), property.value.begin(), property.value.end());
    keys.push_back(property.table);
    keys.push_back(property.file);
  }
  keys.insert(keys.end(), kind.required.begin(), kind.required.end());
  keys.insert(keys.end(), kind.optional.begin(), kind.optional.end());
  return keys;
}

}  // namespace irsig
