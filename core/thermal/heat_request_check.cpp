#include "core/thermal/heat_request_check.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

absl::Status check_faces(std::span<const FaceProperties> faces, const char* side) {
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto of = [&](const char* name) {
      return absl::StrCat(side, " face of element ", i, ": ", name);
    };
    const auto& [emissivity, convection, evaporation] = faces[i];
    if (!(emissivity >= 0 && emissivity <= 1)) {
      return wrong_number(of("emissivity"), emissivity, "0 to 1");
    }
    for (const double natural : {convection.natural_warm, convection.natural_cold}) {
      if (!(natural >= 0 && natural <= 1e6))
        return wrong_number(of("natural"), natural, "0 to 1e6");
    }
    if (!(convection.mixing >= 0 && convection.mixing <= 1)) {
      return wrong_number(of("mixing"), convection.mixing, "0 to 1");
    }
    for (const double share : {evaporation.bare, evaporation.cover}) {
      if (!(share >= 0 && share <= 1))
        return wrong_number(of("share that evaporates"), share, "0 to 1");
    }
  }
  return absl::OkStatus();
}

bool is_temperature(double t) { return t > 0 && t <= 1e5; }

absl::Status check_start(const HeatRequest& request) {
  if (const auto* stated = std::get_if<StatedStart>(&request.start)) {
    const std::size_t count = stated->temperature_k.size();
    if (count != 1 && count != request.layers.size()) {
      return wrong_number("start: number of temperatures", static_cast<double>(count),
                          absl::StrCat("1 or ", request.layers.size()));
    }
    for (const double t : stated->temperature_k) {
      if (!is_temperature(t)) return wrong_number("start: temperature_k", t, "(0, 1e5]");
    }
    if (!(stated->uncertainty_k >= 0 && stated->uncertainty_k <= 1e5)) {
      return wrong_number("start: uncertainty_k", stated->uncertainty_k, "0 to 1e5");
    }
    return absl::OkStatus();
  }
  const auto& periodic = std::get<PeriodicStart>(request.start);
  if (!is_temperature(periodic.guess_k)) {
    return wrong_number("start: guess_k", periodic.guess_k, "(0, 1e5]");
  }
  if (periodic.intervals < 1 || periodic.intervals >= request.knot_s.size()) {
    return wrong_number("start: intervals", static_cast<double>(periodic.intervals),
                        absl::StrCat("1 to ", request.knot_s.size() - 1));
  }
  if (!(periodic.tolerance_k > 0)) {
    return wrong_number("start: tolerance_k", periodic.tolerance_k, "a positive number");
  }
  if (!std::ranges::all_of(periodic.begin_k, is_temperature)) {
    return absl::InvalidArgumentError("start: begin_k has what is no temperature");
  }
  if (periodic.max_days < 2) return wrong_number("start: max_days", periodic.max_days, "2 or more");
  return absl::OkStatus();
}

}  // namespace

absl::Status wrong_number(const std::string& name, double value, const std::string& expected) {
  return absl::InvalidArgumentError(absl::StrCat(name, " = ", value, ", expected ", expected));
}

absl::Status check_request(const HeatRequest& request) {
  RETURN_IF_ERROR(check_layers(request.layers));
  const std::vector<double>& knot = request.knot_s;
  if (knot.size() < 2)
    return wrong_number("number of knots", static_cast<double>(knot.size()), "2 or more");
  for (std::size_t i = 0; i < knot.size(); ++i) {
    const double length_s = i > 0 ? knot[i] - knot[i - 1] : 1;
    if (!(std::isfinite(knot[i]) && length_s >= 1e-6 && length_s <= 1e9)) {
      return wrong_number(absl::StrCat("knot_s[", i, "]"), knot[i],
                          "1e-6 to 1e9 s more than the knot before");
    }
  }
  if (!request.smooth.empty() && request.smooth.size() != knot.size()) {
    return wrong_number("number of smooth", static_cast<double>(request.smooth.size()),
                        absl::StrCat("0 or ", knot.size()));
  }
  const std::size_t inner = request.inner_side == InnerSide::kOpen ? request.outer.size() : 0;
  if (request.inner.size() != inner) {
    return wrong_number("number of inner faces", static_cast<double>(request.inner.size()),
                        absl::StrCat(inner));
  }
  RETURN_IF_ERROR(check_faces(request.outer, "outer"));
  RETURN_IF_ERROR(check_faces(request.inner, "inner"));
  for (const FaceProperties& face : request.inner)
    if (face.evaporation.on)
      return absl::InvalidArgumentError("an inner face evaporates, expected outer faces only");
  if (std::ranges::all_of(request.layers, [](const Layer& layer) {
        return layer.density_kg_m3 * layer.specific_heat_j_kg_k == 0;
      })) {
    for (std::size_t i = 0; i < request.outer.size(); ++i) {
      if (request.outer[i].emissivity == 0 && (inner == 0 || request.inner[i].emissivity == 0)) {
        return wrong_number(absl::StrCat("layers without heat capacity, emissivity of element ", i),
                            0.0, "a positive number: nothing else determines the temperature");
      }
    }
  }
  for (std::size_t i = 0; i < request.output_knot.size(); ++i) {
    const std::size_t k = request.output_knot[i];
    if (k >= knot.size() || (i > 0 && k <= request.output_knot[i - 1])) {
      return wrong_number(absl::StrCat("output_knot[", i, "]"), static_cast<double>(k),
                          "increasing indices of knots");
    }
  }
  for (const std::size_t boundary : request.output_boundary) {
    if (boundary > request.layers.size()) {
      return wrong_number("output_boundary", static_cast<double>(boundary),
                          absl::StrCat("0 to ", request.layers.size()));
    }
  }
  if (!(request.accuracy.tolerance_k > 0)) {
    return wrong_number("tolerance_k", request.accuracy.tolerance_k, "a positive number");
  }
  if (request.accuracy.max_level < 0 || request.accuracy.max_level > 10) {
    return wrong_number("max_level", request.accuracy.max_level, "0 to 10");
  }
  return check_start(request);
}

}  // namespace irsig
