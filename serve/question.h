#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/image_layers.h"
#include "schema/store/tables/filters.h"
#include "view/bands/bands.h"
#include "view/query/query.h"

namespace irsig {

// The parameters of a request's address, decoded.
using Parameters = std::multimap<std::string, std::string>;

// One condition and band of one sweep from one stored range.
struct Selection {
  std::size_t database = 0;
  std::string sweep, season, time, band;
  double at_range_m = 0;
};

// Question for the window of a selection's band in which a detector sees best.
struct BandQuestion {
  std::optional<std::size_t> detector;  // index into the page's detectors; none: constant noise
  double nei_w_m2 = 1e-9;               // then
  MeritOf merit;
  bool clutter = false;         // counts as noise
  bool all_conditions = false;  // every season and time of the sweep, not the selection's alone
};

// A question to the page's server: a parameter of each name, with the CLI's names where they exist
// (at_range_m: the stored range; range_m: as seen from there).
struct Question {
  Selection a;
  std::optional<Selection> b;  // compared with a; parameters b_*
  SignatureQuantity quantity = SignatureQuantity::kIntensity;
  std::optional<double> elevation_deg;
  std::optional<std::uint64_t> row;
  std::optional<double> range_m;
  std::optional<ImageLayer> layer;  // of the row's image; none: the radiance of the target
  bool counts = false;              // of [imager] of the sweep, in place of a layer
  bool stderr_of_image = false;     // the standard errors of its pixels
  BandQuestion bands;
};

enum class Needs {
  kNothing,    // no parameters
  kSelection,  // of a; elevation_deg allowed
  kBoth,       // of a and b
  kBands,      // of a; members of BandQuestion and range_m allowed
  kRow,        // database, sweep, row; range_m allowed
  kImage,      // as above; layer and stderr allowed
};

// Parses the parameters of a question. INVALID_ARGUMENT: names a parameter that is unknown, occurs
// twice, is missing or is not a number, or a database that does not exist.
[[nodiscard]] absl::StatusOr<Question> parse_question(const Parameters& parameters, Needs needs,
                                                      std::size_t databases);

// Returns the question as filter and queries of `view`.
[[nodiscard]] ValueFilter value_filter(const Selection& selection, SignatureQuantity quantity);
[[nodiscard]] Query selection_query(const Selection& selection, SignatureQuantity quantity);
[[nodiscard]] Query row_query(const Question& question);

}  // namespace irsig
