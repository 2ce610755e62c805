#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/atmosphere/imported/imported_path.h"
#include "core/base/file_errors.h"

// Shared parts of the readers of imported text; private to this folder.
namespace irsig {

// One run of a file: its stated facts, and its samples as written in the file but for their units.
// A quantity that the file does not have is empty.
struct SampledRun {
  ImportedPath path;                   // without its spectra
  std::vector<double> wavenumber_cm1;  // increasing or decreasing
  std::vector<double> transmittance, radiance_w_m2_sr_um, sun_w_m2_um;
};

// Returns an ImportedPath without any statement.
[[nodiscard]] ImportedPath unstated_path();

// Parses a number as people and Fortran write it ("1.2E-05", "1.2D-05", "+3", "1.234-102"), below
// 1e38. Returns false if it is none.
[[nodiscard]] bool parse_fortran_number(std::string_view text, double& value);

// Returns the text without the blanks around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);
[[nodiscard]] std::vector<std::string_view> split_lines(std::string_view text);

// Appends a sample's wavenumber. The axis is strictly monotonic and has no gaps wider than two
// bands; says what is wrong, empty if nothing is (and begins anew, to say it once).
[[nodiscard]] std::string extend_axis(std::vector<double>& wavenumber_cm1, double next);

[[nodiscard]] std::vector<SampledRun> read_tape7(std::string_view text, FileErrors& errors);
[[nodiscard]] std::vector<SampledRun> read_path_csv(std::string_view text, FileErrors& errors);

}  // namespace irsig
