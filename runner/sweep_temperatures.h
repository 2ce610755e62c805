#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/fields/temperature_field.h"
#include "core/scene/mesh.h"
#include "core/scene/trace/target.h"
#include "core/sources/emission.h"
#include "runner/land_temperatures.h"
#include "schema/assets.h"

namespace irsig {

// The temperatures of a sweep's facets, where they have their own.
struct SweepTemperatures {
  // True if jobs compute some temperatures and their outputs are not given: no view can be
  // requested. There are no emitters then; the field below is their largest number.
  bool awaited = false;
  std::size_t awaited_emitters = 0;
  std::shared_ptr<const Emitters> emitters;  // null: each part has one temperature
  // [condition]; then also, of each part whose facets have their own: the hottest one, its error
  // included, and their mean. Else 0.                                                      [K]
  std::vector<std::shared_ptr<const EmitterTemperatures>> condition;
  std::vector<std::vector<double>> part_k, part_mean_k;
  // [condition] Computed temperatures, as text, of facets whose temperature cannot be determined,
  // by facet: "286 K +- 295 K"; empty: no ray from outside reaches the facet or any facet of its
  // part.
  std::vector<std::map<std::size_t, std::string>> unknown;
  LandTemperatures land;
};

// Returns the INVALID_ARGUMENT error of a view that sees a facet without a known temperature. The
// message names the facet, its place and the computed temperature as far as it is known.
[[nodiscard]] absl::Status unknown_temperature(
    const schema::ResolvedSweep& sweep, const Target& target, std::size_t facet,
    const schema::Condition& condition,
    const std::vector<std::map<std::size_t, std::string>>& unknown);

// Returns true if jobs compute some of the sweep's temperatures and `heat` does not have their
// outputs.
[[nodiscard]] bool awaits_temperatures(const schema::ResolvedSweep& sweep, const HeatOutputs& heat);

// Returns the sweep's facets in the coordinates of its model's file; for a generated model, in
// those of the OBJ that `irsig model` writes: x forward, y to port, z up.
[[nodiscard]] absl::StatusOr<FieldMesh> field_mesh(const schema::ResolvedSweep& sweep,
                                                   const Assets& assets);

// Returns the temperatures [condition][facet] of a sweep; NaN where the temperature of the facet's
// part is stated; empty: all are stated.
//   heat           outputs of the sweep's heat runs
//   part_of_facet  of `mesh`, the sweep's mesh
// A computed temperature that is not a number, or whose error is too large to leave any
// information, is replaced by its part's mean with an infinite error. It matters only to views that
// see the facet. INVALID_ARGUMENT: an error in a file; a facet of a part without temperature, or
// with such a large error; an instant beyond the file's range, or one for which no heat run was
// requested. FAILED_PRECONDITION: computed temperatures are not known.
[[nodiscard]] absl::StatusOr<std::vector<FacetTemperatures>> facet_temperatures(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
    const Mesh& mesh, const std::vector<std::uint32_t>& part_of_facet,
    std::vector<std::map<std::size_t, std::string>>* unknown = nullptr);

// Returns true if a part is 30 K or more above the coldest part in any condition, facets by their
// mean: the default of Part.hot (jobs/resolve_sweep.cpp, where all temperatures are stated). The
// hottest facet does not count: every part of a hull in the sun has warm facets, and all parts
// would be hot.
[[nodiscard]] bool is_hot(const schema::ResolvedSweep& sweep, const SweepTemperatures& temperatures,
                          std::size_t part);

[[nodiscard]] absl::StatusOr<SweepTemperatures> temperatures_from_sweep(
    const schema::ResolvedSweep& sweep, const Assets& assets, const HeatOutputs& heat,
    const Mesh& mesh, const std::vector<PartSpec>& parts);

}  // namespace irsig
