#include "core/materials/spectra.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

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
  RETURN_IF_ERROR(check_table(table, "table of optical constants", lambda_min_um, lambda_max_um));
  for (const OpticalConstant& c : table)
    if (!(c.n > 0 && c.k >= 0 && c.n < 1e12 && c.k < 1e12))
      return absl::InvalidArgumentError(
          absl::StrCat("no refractive index: n = ", c.n, ", k = ", c.k));
  return absl::OkStatus();
}

absl::Status check_fraction(const Spectrum& table, const char* what, double lambda_min_um,
                            double lambda_max_um) {
  RETURN_IF_ERROR(check_table(table, what, lambda_min_um, lambda_max_um));
  for (const SpectralPoint& p : table) RETURN_IF_ERROR(check_between(p.value, what, 0, 1));
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

namespace {

double distance(const SpectralPoint& a, const SpectralPoint& b, const SpectralPoint& p) {
  return std::abs(p.value - std::lerp(a.value, b.value,
                                      (p.lambda_um - a.lambda_um) / (b.lambda_um - a.lambda_um)));
}
double distance(const OpticalConstant& a, const OpticalConstant& b, const OpticalConstant& p) {
  const double t = (p.lambda_um - a.lambda_um) / (b.lambda_um - a.lambda_um);
  return std::hypot(p.n - std::lerp(a.n, b.n, t), p.k - std::lerp(a.k, b.k, t)) /
         std::hypot(p.n, p.k);
}

// The point farthest from the chord is kept where it is too far, and so on to both sides of it.
// [douglas1973]
template <typename Point>
void add_corners(const std::vector<Point>& table, double from_um, double to_um, double tolerance,
                 TableCorners& out) {
  if (table.size() < 3) return;
  // The last point at or before the interval, the first at or after it.
  std::size_t first = 0, last = table.size() - 1;
  while (first + 1 < last && table[first + 1].lambda_um <= from_um) ++first;
  while (last > first + 1 && table[last - 1].lambda_um >= to_um) --last;
  std::vector<std::pair<std::size_t, std::size_t>> chords = {{first, last}};
  while (!chords.empty()) {
    const auto [a, b] = chords.back();
    chords.pop_back();
    double most = 0;
    std::size_t farthest = a;
    for (std::size_t i = a + 1; i < b; ++i)
      if (const double d = distance(table[a], table[b], table[i]); d > most) {
        most = d;
        farthest = i;
      }
    if (most <= tolerance) {
      out.left_out = std::max(out.left_out, most);
      continue;
    }
    out.um.push_back(table[farthest].lambda_um);
    chords.emplace_back(a, farthest);
    chords.emplace_back(farthest, b);
  }
}

struct AddCorners {
  double from_um, to_um, tolerance;
  TableCorners& out;

  void operator()(MaterialKey /*key*/, const Spectrum& table) const {
    add_corners(table, from_um, to_um, tolerance, out);
  }
  void operator()(MaterialKey /*key*/, const OpticalConstants& table) const {
    add_corners(table, from_um, to_um, tolerance, out);
  }
  void operator()(MaterialKey /*key*/, const TabulatedBrdf& m) const {
    for (const double um : m.lambda_um)
      if (um > from_um && um < to_um && um > m.lambda_um.front() && um < m.lambda_um.back())
        out.um.push_back(um);
  }
  template <typename Other>
  void operator()(MaterialKey /*key*/, const Other& /*no table*/) const {}
};

}  // namespace

TableCorners table_corners(const MaterialSpec& material, double from_um, double to_um,
                           double tolerance) {
  TableCorners out;
  for_each_property(material.model, AddCorners{from_um, to_um, tolerance, out});
  std::sort(out.um.begin(), out.um.end());
  out.um.erase(std::unique(out.um.begin(), out.um.end()), out.um.end());
  return out;
}

}  // namespace irsig
