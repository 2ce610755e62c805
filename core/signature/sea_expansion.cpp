#include "core/signature/sea_expansion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/environment/sea/sea_surface.h"

namespace irsig {
namespace {

using Numbers = SlopeExpansion::Numbers;

void add_numbers(Numbers& to, double weight, const Numbers& of) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += weight * of[i];
}

// [term] he_a(x) he_b(y)
std::vector<double> term_values(double x, double y) {
  const std::vector<double> of_x = hermite_functions(x), of_y = hermite_functions(y);
  std::vector<double> out;
  for (const SlopeTerm& t : slope_terms())
    out.push_back(of_x[static_cast<std::size_t>(t.a)] * of_y[static_cast<std::size_t>(t.b)]);
  return out;
}

}  // namespace

SeaSight::SeaSight(Vec<Body> towards, double wind)
    : to_sensor(towards),
      sine(-towards.z),
      wind_m_s(wind),
      deviation(std::sqrt(0.5 * sea_slope_variance(wind))) {
  const double level = std::hypot(towards.x, towards.y);
  x = level > 0 ? Vec<Body>{towards.x / level, towards.y / level, 0} : Vec<Body>{1, 0, 0};
  y = {-x.y, x.x, 0};
}

Vec<Body> SeaSight::steep_normal(double slope_x, double slope_y) const {
  return Vec<Body>{0, 0, -1} - deviation * slope_x * x - deviation * slope_y * y;
}

SlopeAverages SeaSight::averages(const SlopeCorrelation& sea, double side_m) const {
  return {sea, side_m / sine, side_m};
}

SlopeExpansion::SlopeExpansion(const SeaSight& sight,
                               const std::function<Numbers(Vec<Body> normal)>& of_facet,
                               std::optional<Glint> glint)
    : glint_(std::move(glint)) {
  std::vector<double> seen;                     // [facet]
  std::vector<std::vector<double>> term_value;  // [facet]
  double area = 0;
  for (const SlopeNode& x : slope_nodes())
    for (const SlopeNode& y : slope_nodes()) {
      const Vec<Body> normal = sight.steep_normal(x.x, y.x);
      const double cosine = dot(normal, sight.to_sensor), weight = x.weight * y.weight;
      if (cosine <= 0) continue;
      facet_.push_back({weight, of_facet(normalized(normal))});
      seen.push_back(cosine);
      term_value.push_back(term_values(x.x, y.x));
      area += weight * cosine;
    }
  mean_.assign(facet_.front().excess.size(), 0.0);
  for (std::size_t f = 0; f < seen.size(); ++f)
    add_numbers(mean_, facet_[f].frequency * seen[f] / area, facet_[f].excess);
  if (glint_) add_numbers(mean_, 1, glint_->mean);
  term_.assign(slope_terms().size(), Numbers(mean_.size(), 0.0));
  for (std::size_t f = 0; f < seen.size(); ++f) {
    Numbers& excess = facet_[f].excess;
    add_numbers(excess, -1, mean_);
    for (double& e : excess) e *= seen[f] / area;
    for (std::size_t t = 0; t < term_.size(); ++t)
      add_numbers(term_[t], facet_[f].frequency * term_value[f][t], excess);
  }
  if (!glint_) return;
  const std::vector<double> value = term_values(glint_->x, glint_->y);
  for (std::size_t t = 0; t < term_.size(); ++t) add_numbers(term_[t], value[t], glint_->mean);
}

std::vector<Numbers> SlopeExpansion::sources() const {
  std::vector<Numbers> out = term_;
  out.push_back(glint_ ? glint_->mean : Numbers(mean_.size(), 0.0));
  return out;
}

std::vector<double> SlopeExpansion::variances(const SlopeAverages& averages) const {
  std::vector<double> out = averages.term();
  double rest = 0;
  if (glint_) {
    rest = averages.of_one_slope(glint_->x, glint_->y, glint_->disk_variance);
    const std::vector<double> value = term_values(glint_->x, glint_->y);
    for (std::size_t t = 0; t < out.size(); ++t) rest -= out[t] * value[t] * value[t];
  }
  out.push_back(std::max(0.0, rest));
  return out;
}

}  // namespace irsig
