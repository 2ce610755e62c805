#include "core/sources/emission.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/check.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

constexpr double kStepPerK = 2e-5;

// n and its fourth derivative at x.
double occupation(double x) { return 1 / std::expm1(x); }
double fourth_derivative(double x) {
  const double n = occupation(x);
  return n * (1 + n) * (1 + 2 * n) * (1 + 12 * n * (1 + n));
}

}  // namespace

ElementEmission make_element_emission(std::span<const std::uint32_t> part_of_facet,
                                      std::size_t parts,
                                      std::span<const FacetTemperatures> condition) {
  ElementEmission out;
  // Emitters 0 .. parts - 1 are whole parts.
  for (std::uint32_t p = 0; p < parts; ++p) out.emitters.part.push_back(p);
  std::map<std::vector<float>, std::uint32_t> known;  // by part, temperatures and errors
  std::vector<std::uint32_t> facet_of(parts, 0);
  for (std::uint32_t f = 0; f < part_of_facet.size(); ++f) {
    const std::uint32_t part = part_of_facet[f];
    std::vector<float> key{static_cast<float>(part)};
    bool stated = true;
    for (const FacetTemperatures& c : condition) {
      const bool none = std::isnan(c.kelvin[f]);
      stated &= none;
      key.push_back(none ? -1 : c.kelvin[f]);
      key.push_back(none ? -1 : c.error_k[f]);
    }
    if (stated) {
      out.emitters.of_facet.push_back(part);
      continue;
    }
    const auto next = static_cast<std::uint32_t>(out.emitters.part.size());
    const auto [at, is_new] = known.try_emplace(std::move(key), next);
    if (is_new) {
      out.emitters.part.push_back(part);
      facet_of.push_back(f);
    }
    out.emitters.of_facet.push_back(at->second);
  }
  for (const FacetTemperatures& c : condition) {
    EmitterTemperatures& t = out.condition.emplace_back();
    t.kelvin.assign(parts, NAN);
    t.error_k.assign(parts, NAN);
    for (std::size_t e = parts; e < facet_of.size(); ++e) {
      const double kelvin = static_cast<double>(c.kelvin[facet_of[e]]),
                   error_k = static_cast<double>(c.error_k[facet_of[e]]);
      t.kelvin.push_back(c.kelvin[facet_of[e]]);
      t.error_k.push_back(c.error_k[facet_of[e]]);
      if (std::isnan(kelvin)) continue;
      const double known_to_k = std::isinf(error_k) ? 0 : error_k;
      if (t.hottest_k == 0) t.coldest_k = kelvin;
      t.coldest_k = std::min(t.coldest_k, kelvin - known_to_k);
      t.hottest_k = std::max(t.hottest_k, kelvin + known_to_k);
    }
  }
  return out;
}

BlackbodyNodes::BlackbodyNodes(double coldest_k, double hottest_k) {
  IRSIG_CHECK(coldest_k >= 1);
  IRSIG_CHECK(hottest_k >= coldest_k);
  IRSIG_CHECK(hottest_k <= kMostEmitterK);
  const auto cell = [](double kelvin) {
    return static_cast<std::uint32_t>(1 / (kelvin * kStepPerK));
  };
  first_ = cell(hottest_k) - 1;
  count_ = cell(coldest_k) + 3 - first_;
}

double BlackbodyNodes::kelvin(std::uint32_t node) const {
  return 1 / (kStepPerK * static_cast<double>(first_ + node));
}

BlackbodyNodes::Share BlackbodyNodes::share(double kelvin) const {
  const double steps = 1 / (kelvin * kStepPerK);
  const auto cell = static_cast<std::uint32_t>(steps);
  IRSIG_CHECK(cell > first_);
  IRSIG_CHECK(cell + 2 < first_ + count_);
  const double t = steps - cell;  // in the middle one of three cells
  const double below = t + 1, above = 1 - t, far = 2 - t;
  return {
      cell - 1 - first_,
      {-t * above * far / 6, below * above * far / 2, below * t * far / 2, -below * t * above / 6}};
}

double BlackbodyNodes::relative_error(double shortest_um) const {
  const double step = kC2UmK / shortest_um * kStepPerK;
  double worst = 0;
  for (std::uint32_t node = 0; node + 3 < count_; ++node) {
    const double x = step * static_cast<double>(first_ + node);
    worst = std::max(worst, fourth_derivative(x) / occupation(x + 3 * step));
  }
  return 9.0 / 384 * std::pow(step, 4) * worst;
}

}  // namespace irsig
