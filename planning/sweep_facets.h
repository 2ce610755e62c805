#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "planning/accuracy_source.h"
#include "runner/spec_to_request.h"
#include "schema/store/tables/name_set.h"

namespace irsig {

// The facets of a sweep and their temperatures, stated, computed or from a file.
class SweepFacets {
 public:
  // Loads the facets of a database or a sweep file. FAILED_PRECONDITION: temperatures have yet to
  // be computed.
  static absl::StatusOr<SweepFacets> load(const std::string& database, const std::string& sweep);

  // Temperature of a facet. NaN: no sensor sees the facet, or its computed error is as large as the
  // temperature.
  struct Temperature {
    double kelvin, error_k;
  };
  [[nodiscard]] Temperature temperature(int condition, std::size_t facet) const;

  [[nodiscard]] const AccuracySource& source() const { return source_; }
  [[nodiscard]] const schema::ResolvedSweep& sweep() const { return source_.loaded.resolved; }
  [[nodiscard]] const SweepScene& scene() const { return scene_; }
  // Checks names of seasons. NOT_FOUND: the sweep lacks one; the message lists those that it has.
  [[nodiscard]] absl::Status check_seasons(const NameSet& season) const;
  // [facet] Index of its part.
  [[nodiscard]] const std::vector<std::uint32_t>& part() const { return part_; }

 private:
  AccuracySource source_;
  SweepScene scene_;
  std::vector<std::uint32_t> part_;
  std::vector<FacetTemperatures> fields_;  // [condition], or empty: all are stated
};

}  // namespace irsig
