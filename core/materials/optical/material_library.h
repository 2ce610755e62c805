#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/material_spec.h"
#include "core/materials/wavelength_range.h"

namespace irsig {

// A material that comes with the program, and where its numbers come from.
struct LibraryEntry {
  MaterialSpec spec;  // its name is the entry's
  std::string description;
  std::string source, licence;
  std::string provenance;  // what was measured, what is generic, what it must not be used for
};

// All entries, by name. Compiled in from data/*.yml; tests/unit/material_library_test.cpp reads
// every one.
[[nodiscard]] const std::vector<LibraryEntry>& material_library();

// Returns one entry. NOT_FOUND: there is none of that name.
[[nodiscard]] absl::StatusOr<LibraryEntry> library_entry(std::string_view name);

// Reads an entry's file (data/README.md has the format). Errors: file:line:column.
[[nodiscard]] absl::StatusOr<LibraryEntry> read_library_entry(std::string_view text,
                                                              std::string_view file_name);

// Returns the fraction of sunlight (0.3 to 2.5 um, E490) that a Lambert material absorbs, or
// nothing if its emissivity is not known there. The mean over the sun's spectrum outside the air:
// at the ground it differs by some 0.02 for paints.
[[nodiscard]] std::optional<double> solar_absorptance(const MaterialSpec& spec);

// Returns the kind of a sweep file's [[material]] that this model is: "cook_torrance", "ward_1992"
// ...
[[nodiscard]] std::string model_kind(const MaterialModel& model);
[[nodiscard]] inline std::string model_kind(const MaterialSpec& spec) {
  return model_kind(spec.model);
}

// One model of each kind, with the properties' defaults and empty tables.
[[nodiscard]] const std::vector<MaterialModel>& material_models();

}  // namespace irsig
