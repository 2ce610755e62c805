#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/atmosphere/absorber_amounts.h"
#include "jobs/resolve.h"
#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

void check_limits(const SectionCheck& check, double least_um, double most_um) {
  check.require({"lambda_min_um", "lambda_max_um"}, "expected a wavelength in micrometres");
  check.require({"step_um"}, "expected the spacing of the stored spectrum in micrometres");
  if (!check.has("lambda_min_um") || !check.has("lambda_max_um")) return;
  if (!(least_um < most_um)) {
    check.error("lambda_max_um", absl::StrCat("= ", most_um, " is not above lambda_min_um = ",
                                              least_um, ", expected the shorter wavelength first"));
  }
}

void check_step(const SectionCheck& check, double least_um, double most_um, double step_um) {
  if (!(step_um > 0) || !(least_um < most_um)) return;
  // Limits are decimal: 8.2 - 8.1 is less than 0.1 by rounding.
  if (step_um > (most_um - least_um) * (1 + 1e-9)) {
    check.error("step_um", absl::StrCat("= ", step_um, " is wider than the band, expected at most ",
                                        most_um - least_um));
  } else if ((most_um - least_um) / step_um > kMostWavelengths) {
    check.error("step_um", absl::StrCat("= ", step_um, " makes more than ", kMostWavelengths,
                                        " wavelengths, expected fewer"));
  }
}

void check_response(const schema::Band& band, const std::string& path, Findings& findings) {
  double largest = 0;
  for (int i = 0; i < band.response_size(); ++i) {
    const schema::SpectralPoint& point = band.response(i);
    const SectionCheck check(point, absl::StrCat(path, ".response[", i, "]"), findings);
    check.require({"lambda_um", "value"}, "expected a wavelength and the response there");
    check.within("lambda_um", band.lambda_min_um(), band.lambda_max_um());
    largest = std::max(largest, point.value());
    if (i > 0 && point.has_lambda_um() && !(point.lambda_um() > band.response(i - 1).lambda_um())) {
      check.error("lambda_um",
                  absl::StrCat("= ", point.lambda_um(),
                               " is not above the one before it, expected increasing wavelengths"));
    }
  }
  if (band.response_size() == 1)
    findings.add(path + ".response", path + ".response has one point, expected two or more");
  if (band.response_size() > 1 && largest == 0) {
    findings.add(path + ".response",
                 path + ".response is zero everywhere, expected a value above 0");
  }
}

// The atmosphere's table ends.
void check_air_limit(const SectionCheck& check, const char* key, double lambda_um) {
  const double least_um = 1e4 / kAirLastCm1, most_um = 1e4 / kAirFirstCm1;
  if (!check.has(key) || (lambda_um >= least_um && lambda_um <= most_um)) return;
  check.error(key, absl::StrCat("= ", lambda_um, ", expected ", absl::SixDigits(least_um), " to ",
                                absl::SixDigits(most_um),
                                " um: air.model = \"atmosphere\" has no absorption outside",
                                lambda_um >= 1e4 / most_um && lambda_um <= 1e4 / least_um
                                    ? absl::StrCat("; is it in cm-1? ", lambda_um, " cm-1 are ",
                                                   absl::SixDigits(1e4 / lambda_um), " um")
                                    : ""));
}

void check_run_bands(const schema::Sweep& sweep, Findings& findings) {
  if (sweep.band_size() == 0) {
    findings.add("band",
                 "[[band]] is missing, expected one or more bands with name, lambda_min_um, "
                 "lambda_max_um and step_um");
    return;
  }
  (void)check_names(sweep.band(), "band", findings);
  for (int i = 0; i < sweep.band_size(); ++i) {
    const schema::Band& band = sweep.band(i);
    const std::string path = absl::StrCat("band[", i, "]");
    const SectionCheck check(band, path, findings);
    check_limits(check, band.lambda_min_um(), band.lambda_max_um());
    if (sweep.air().model() == "atmosphere") {
      check_air_limit(check, "lambda_min_um", band.lambda_min_um());
      check_air_limit(check, "lambda_max_um", band.lambda_max_um());
    }
    check_step(check, band.lambda_min_um(), band.lambda_max_um(), band.step_um());
    check_response(band, path, findings);
    for (int j = 0; j < i; ++j) {
      const schema::Band& other = sweep.band(j);
      if (!(band.lambda_min_um() < other.lambda_max_um() &&
            other.lambda_min_um() < band.lambda_max_um()))
        continue;
      findings.add(path, absl::StrCat(path, " \"", band.name(), "\" (", band.lambda_min_um(),
                                      " to ", band.lambda_max_um(), " um) overlaps band[", j,
                                      "] \"", other.name(), "\" (", other.lambda_min_um(), " to ",
                                      other.lambda_max_um(), " um), expected separate bands"));
    }
  }
}

void check_transport(const schema::Sweep& sweep, Findings& findings) {
  const SectionCheck check(sweep.transport(), "transport", findings);
  check.require({"sun"}, "expected true or false: whether the sun shines on the target");
}

void check_accuracy(const schema::Sweep& sweep, Findings& findings) {
  const schema::Accuracy& accuracy = sweep.accuracy();
  const SectionCheck check(accuracy, "accuracy", findings);
  (void)check.at_most_one(
      {"relative_error", "target_paths", "samples_per_replicate", "time_budget_s"});
  for (const char* other : {"target_paths", "samples_per_replicate", "time_budget_s"}) {
    if (!check.has("absolute_error_k") || accuracy.has_relative_error() || !check.has(other))
      continue;
    check.error("absolute_error_k",
                absl::StrCat("does not apply with ", other, ": it is a floor for relative_error"));
  }
  if (accuracy.has_samples_per_replicate() && accuracy.has_max_samples_per_replicate() &&
      accuracy.samples_per_replicate() > accuracy.max_samples_per_replicate()) {
    check.error("samples_per_replicate",
                absl::StrCat("= ", accuracy.samples_per_replicate(),
                             " is more than max_samples_per_replicate, expected at most ",
                             accuracy.max_samples_per_replicate()));
  }
}

void check_by_season(const google::protobuf::Map<std::string, double>& by_season,
                     const std::string& path, const schema::Sweep& sweep, Findings& findings) {
  std::vector<std::string> seasons;
  for (const schema::Season& season : sweep.season()) {
    seasons.push_back(season.name());
    if (by_season.contains(season.name())) continue;
    findings.add(path, absl::StrCat(path, " lacks season \"", season.name(),
                                    "\", expected a temperature for every season"));
  }
  for (const auto& [season, temperature_k] : by_season) {
    const std::string key = absl::StrCat(path, ".", season);
    if (std::find(seasons.begin(), seasons.end(), season) == seasons.end()) {
      findings.add(key, absl::StrCat(key, ": there is no season \"", season, "\", ",
                                     suggestion(season, seasons)));
    }
  }
}

void check_precompute(const schema::Sweep& sweep, Findings& findings) {
  if (!sweep.has_precompute()) return;
  const schema::Precompute& model = sweep.precompute();
  const SectionCheck check(model, "precompute", findings);
  check.require({"hot_area_m2", "hot_temperature_k", "ambient_area_m2", "emissivity",
                 "reflected_exitance_w_m2_um", "absorption_m2_kg", "pressure_pa",
                 "gas_constant_j_kg_k", "range_m"},
                "expected a number: Eq. 12 needs every one of its inputs");
  check_limits(check, model.lambda_min_um(), model.lambda_max_um());
  check_step(check, model.lambda_min_um(), model.lambda_max_um(), model.step_um());
  check_by_season(model.ambient_temperature_k(), "precompute.ambient_temperature_k", sweep,
                  findings);
  check_by_season(model.air_temperature_k(), "precompute.air_temperature_k", sweep, findings);
}

}  // namespace

void check_run(const schema::Sweep& sweep, Findings& findings) {
  check_run_bands(sweep, findings);
  check_transport(sweep, findings);
  check_accuracy(sweep, findings);
  check_precompute(sweep, findings);
}

}  // namespace irsig
