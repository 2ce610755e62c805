#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "verify/cases/hard_case.h"

namespace irsig {

[[nodiscard]] std::vector<HardCase> atmosphere_cases();
[[nodiscard]] std::vector<HardCase> cloud_cases();
[[nodiscard]] std::vector<HardCase> determinism_cases();
[[nodiscard]] std::vector<HardCase> geometry_cases();
[[nodiscard]] std::vector<HardCase> heat_cases();
[[nodiscard]] std::vector<HardCase> honesty_cases();
[[nodiscard]] std::vector<HardCase> image_cases();
[[nodiscard]] std::vector<HardCase> land_cases();
[[nodiscard]] std::vector<HardCase> material_cases();
[[nodiscard]] std::vector<HardCase> planck_cases();
[[nodiscard]] std::vector<HardCase> plume_cases();
[[nodiscard]] std::vector<HardCase> sum_cases();
[[nodiscard]] std::vector<HardCase> sun_and_frame_cases();
[[nodiscard]] std::vector<HardCase> transport_cases();

// Records the largest error of a case and its place.
class Worst {
 public:
  explicit Worst(double bound) { finding_.bound = bound; }

  // Counts one check and keeps the largest error. where: called only for a new largest error.
  template <typename Where>
  void see(double error, Where&& where) {
    ++finding_.checks;
    // NaN, once found, remains the worst error.
    if (std::isnan(finding_.worst_error)) return;
    if (error <= finding_.worst_error) return;
    finding_.worst_error = error;
    finding_.where = std::forward<Where>(where)();
  }
  // Records a requirement: an error of 0 if it holds, infinite otherwise.
  template <typename Where>
  void require(bool holds, Where&& where) {
    see(holds ? 0.0 : std::numeric_limits<double>::infinity(), std::forward<Where>(where));
  }

  [[nodiscard]] Finding finding() const { return finding_; }

 private:
  Finding finding_;
};

}  // namespace irsig
