#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geo/viewpoint.h"
#include "core/study/stated_errors.h"
#include "core/study/work_precision.h"
#include "view/study_tables/work_precision_plot.h"

namespace irsig {

// Names of the ways that tables compare with each other.
inline constexpr const char* kPlain = "plain Monte Carlo, each wavelength";
inline constexpr const char* kPseudo = "ours, pseudo-random";
inline constexpr const char* kUnmasked = "ours, quasi, no masks or strata";
inline constexpr const char* kQuasi = "ours, quasi-Monte Carlo";
inline constexpr const char* kAutomatic = "whole run, automatic effects";
inline constexpr const char* kAllEffects = "whole run, all effects";

struct WorkMeasurement {
  std::string group, name;
  std::vector<WorkPoint> point;
};

// Relative errors of in-band integrals at one spectral step, on the same paths.
struct StepMeasurement {
  double step_um, cpu_s, ours, trapezoid, rectangles;
};

// Effects that the program left out of the row at one asked error: names, separated by commas.
struct LeftOutEffects {
  double asked_relative_error;
  std::string effects;
};

// All that was measured of one row of a sweep.
struct RowMeasurements {
  std::string season, time_utc, band;
  Viewpoint viewpoint{};
  std::uint32_t max_reflections = 0;
  double scene_cpu_s = 0, view_cpu_s = 0;  // set-up
  ReferenceValue reference;
  std::vector<WorkMeasurement> work;
  std::vector<StepMeasurement> step;
  std::vector<LeftOutEffects> left_out;
  std::string too_wide_steps;  // steps that could not be studied, in words
};

struct StudiedRow {
  std::string season, time_utc, band;
  double aspect_azimuth_deg = 0, aspect_elevation_deg = 0, range_m = 0;
  std::vector<std::string> paragraph;
  std::vector<WorkPanel> panel;
  std::vector<PageTable> table;
  std::string csv;  // lines without a header: csv_header()
};

[[nodiscard]] StudiedRow present(const RowMeasurements& measured);
[[nodiscard]] std::string accuracy_csv_header();

// Returns the deviations of stored values from longer runs, in stored standard errors and numerical
// errors: a line for each quantity. Markdown.
[[nodiscard]] std::string stated_errors_table(std::span<const StatedRow> rows);

}  // namespace irsig
