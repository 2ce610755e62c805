#include "core/materials/spectra.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

template <typename Point>
struct Segment {
  const Point *a, *b;
  double t;
};
template <typename Point>
Segment<Point> segment(const std::vector<Point>& table, double lambda_um) {
  if (table.size() == 1) return {table.data(), table.data(), 0};
  auto after = std::upper_bound(table.begin(), table.end(), lambda_um,
                                [](double x, const Point& p) { return x < p.lambda_um; });
  after = std::clamp(after, table.begin() + 1, table.end() - 1);
  const Point &a = *(after - 1), &b = *after;
  return {&a, &b, std::clamp((lambda_um - a.lambda_um) / (b.lambda_um - a.lambda_um), 0.0, 1.0)};
}

template <typename Point>
absl::Status check_table(const std::vector<Point>& table, const char* what, double lambda_min_um,
                         double lambda_max_um) {
  if (table.empty()) return absl::InvalidArgumentError(absl::StrCat("no ", what));
  if (table.size() == 1) return absl::OkStatus();
  for (std::size_t i = 1; i < table.size(); ++i)
    if (!(table[i].lambda_um > table[i - 1].lambda_um))
      return absl::InvalidArgumentError(absl::StrCat(
          "the wavelengths of its ", what, " do not increase at ", table[i].lambda_um, " um"));
  if (table.front().lambda_um > lambda_min_um || table.back().lambda_um < lambda_max_um)
    return absl::InvalidArgumentError(
        absl::StrCat("its ", what, " covers ", table.front().lambda_um, " to ",
                     table.back().lambda_um, " um, but the bands need ", lambda_min_um, " to ",
                     lambda_max_um, " um (half a step beyond each band)"));
  return absl::OkStatus();
}

}  // namespace

double spectrum_at(const Spectrum& table, double lambda_um) {
  const auto s = segment(table, lambda_um);
  return s.a->value + s.t * (s.b->value - s.a->value);
}

OpticalConstant constants_at(const OpticalConstants& table, double lambda_um) {
  const auto s = segment(table, lambda_um);
  return {lambda_um, s.a->n + s.t * (s.b->n - s.a->n), s.a->k + s.t * (s.b->k - s.a->k)};
}

absl::Status check_covers(const OpticalConstants& table, double lambda_min_um,
                          double lambda_max_um) {
  if (auto status = check_table(table, "table of optical constants", lambda_min_um, lambda_max_um);
      !status.ok())
    return status;
  for (const OpticalConstant& c : table)
    if (!(c.n > 0 && c.k >= 0 && c.n < 1e12 && c.k < 1e12))
      return absl::InvalidArgumentError(
          absl::StrCat("no refractive index: n = ", c.n, ", k = ", c.k));
  return absl::OkStatus();
}

absl::Status check_fraction(const Spectrum& table, const char* what, double lambda_min_um,
                            double lambda_max_um) {
  if (auto status = check_table(table, what, lambda_min_um, lambda_max_um); !status.ok())
    return status;
  for (const SpectralPoint& p : table)
    if (auto status = check_between(p.value, what, 0, 1); !status.ok()) return status;
  return absl::OkStatus();
}

absl::Status check_between(double value, const char* what, double least, double most) {
  if (value >= least && value <= most) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(what, " ", value, " is not between ", least, " and ", most));
}

absl::Status first_failure(std::vector<absl::Status> statuses) {
  for (absl::Status& status : statuses)
    if (!status.ok()) return status;
  return absl::OkStatus();
}

std::vector<double> corners_um(const MaterialSpec& material) {
  std::vector<double> out;
  const auto add = [&](const auto& table) {
    for (std::size_t i = 1; i + 1 < table.size(); ++i) out.push_back(table[i].lambda_um);
  };
  struct Visit {
    const decltype(add)& table;
    std::vector<double>& out;
    void operator()(const Lambert& m) const { table(m.emissivity); }
    void operator()(const CookTorrance& m) const { table(m.constants); }
    void operator()(const Ward& m) const {
      table(m.diffuse);
      table(m.specular);
    }
    void operator()(const SandfordRobertson& m) const {
      table(m.emissivity);
      table(m.diffuse);
    }
    void operator()(const PriestGermer& m) const { table(m.constants); }
    void operator()(const BeardMaxwell& m) const {
      table(m.constants);
      table(m.diffuse);
      table(m.volume);
    }
    void operator()(const Prisse& m) const { table(m.reflectance); }
    void operator()(const TabulatedBrdf& m) const {
      for (std::size_t i = 1; i + 1 < m.lambda_um.size(); ++i) out.push_back(m.lambda_um[i]);
    }
  };
  std::visit(Visit{add, out}, material.model);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace irsig
