#pragma once

#include <string>
#include <vector>

namespace irsig {

// A property of a surface that is given as a number, as a table over wavelength or as a file: the
// keys of the three forms in [[material]]. (The optical constants' number is a pair, n and k; a
// tabulated BRDF has no number.)
struct OpticalProperty {
  const char* name;                // in messages
  std::vector<const char*> value;  // {"emissivity"}, {"n", "k"}
  const char* table;               // "emissivity_table"
  const char* file;                // "emissivity_file"
};

struct MaterialKind {
  const char* name;
  std::vector<OpticalProperty> property;
  std::vector<const char*> required, optional;  // other keys than the properties'
};

// Returns every kind whose properties the sweep file states.
[[nodiscard]] const std::vector<MaterialKind>& material_kinds();

// Returns the kind of this name. Null: the kind is built in, a library's or unknown.
[[nodiscard]] const MaterialKind* find_material_kind(const std::string& name);

// Returns every key that a [[material]] of this kind may have.
[[nodiscard]] std::vector<const char*> keys_of(const MaterialKind& kind);

}  // namespace irsig
