#include "core/materials/sandford_robertson.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/materials/lobe_mixture.h"
#include "core/materials/lobe_quadrature.h"
#include "core/materials/spectra.h"

namespace irsig {
namespace {

// g / G.
class GrazingFall {
 public:
  explicit GrazingFall(double b) : b2_(b * b) {
    const double kappa = 1 - b2_;
    // The series about b = 1 where the closed form cancels.
    mean_ = b2_ == 0       ? 1
            : kappa < 1e-3 ? 0.5 + kappa / 6 + kappa * kappa / 12
                           : (1 + b2_ * std::log(b2_) / kappa) / kappa;
  }
  [[nodiscard]] double operator()(double cos_theta) const {
    const double c2 = cos_theta * cos_theta;
    return c2 / ((c2 + b2_ * (1 - c2)) * mean_);
  }
  [[nodiscard]] double mean() const { return mean_; }

 private:
  double b2_, mean_;
};

// e^2 h / (4 pi)
double sandford_lobe_per_sr(const ReflectionGeometry& g, double e) {
  const double q = e * e * g.cos_h * g.cos_h + g.sin2_h;
  return e * e / (4 * std::numbers::pi * q * q);
}

// s(theta) = base(theta) x a cubic through values at equal steps of asinh(cos / e): steps of cos
// below e, of ln cos above it, where the lobe's width in cos is e.
class AngleGrid {
 public:
  static constexpr std::size_t kPoints = 161;

  explicit AngleGrid(double e) : e_(e), last_(std::asinh(1 / e)) {}
  [[nodiscard]] double cos_of(std::size_t point) const {
    return std::min(1.0, e_ * std::sinh(last_ * static_cast<double>(point) / (kPoints - 1)));
  }
  // s is about sqrt(rho_S / (H cos)) where cos > e, and finite at grazing.
  [[nodiscard]] double base(double c) const { return 1 / std::sqrt(c * c + e_ * e_); }

  // Four neighbouring points and their weights at an angle.
  struct Stencil {
    std::size_t first;
    std::array<double, 4> weight;
  };
  [[nodiscard]] Stencil stencil(double c) const {
    const double x = std::asinh(c / e_) / last_ * (kPoints - 1);
    const auto cell = std::clamp(static_cast<std::size_t>(x), std::size_t{1}, kPoints - 3);
    const double t = x - static_cast<double>(cell);
    return {cell - 1,
            {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2,
             -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6}};
  }

 private:
  double e_, last_;
};

// The lobe's integral over w_i at one w_o, spread over the grid points between which s(i) is
// interpolated. It depends on the lobe's width alone, and takes most of the time in which a
// material is prepared: scenes with other emissivities, and other wavelengths, ask for the same.
// Any number of threads may ask.
class LobeMoments {
 public:
  explicit LobeMoments(double width)
      : width_(width), grid_(width), quadrature_({SlopeLaw::kEllipsoid, width}) {}

  // Returns the integrals of a width; those of the widths last asked for are kept.
  static std::shared_ptr<LobeMoments> of(double width) {
    constexpr std::size_t kWidths = 4;
    static std::mutex mutex;
    static std::deque<std::shared_ptr<LobeMoments>> known;
    const std::lock_guard lock(mutex);
    for (const auto& moments : known)
      if (moments->width_ == width) return moments;
    known.push_back(std::make_shared<LobeMoments>(width));
    if (known.size() > kWidths) known.pop_front();
    return known.back();
  }

  [[nodiscard]] std::vector<double> at(double cos_o) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto row = known_.find(cos_o); row != known_.end()) return row->second;
    }
    std::vector<double> out(AngleGrid::kPoints, 0.0);
    quadrature_.visit(cos_o, [&](const ReflectionGeometry& g, double, double solid_angle_weight) {
      const double w =
          solid_angle_weight * sandford_lobe_per_sr(g, width_) * g.cos_i * grid_.base(g.cos_i);
      const AngleGrid::Stencil s = grid_.stencil(g.cos_i);
      for (std::size_t j = 0; j < 4; ++j) out[s.first + j] += w * s.weight[j];
    });
    constexpr std::size_t kRows = 1024;  // grid and table of directional reflectance have 420
    const std::lock_guard lock(mutex_);
    if (known_.size() < kRows) known_.emplace(cos_o, out);
    return out;
  }

 private:
  const double width_;
  const AngleGrid grid_;
  const LobeQuadrature quadrature_;
  std::mutex mutex_;
  std::map<double, std::vector<double>> known_;  // [cos_o]
};

class SandfordRobertsonModel final : public LobeModel {
 public:
  SandfordRobertsonModel(const SandfordRobertson& spec, std::size_t spectra,
                         const std::vector<double>& node_um)
      : LobeModel(spectra),
        fall_(spec.grazing),
        e_(spec.lobe_width),
        grid_(spec.lobe_width),
        moments_(LobeMoments::of(spec.lobe_width)) {
    for (std::size_t i = 0; i < spectra; ++i) {
      diffuse_.push_back(spectrum_at(spec.diffuse, node_um[i]));
      not_specular_.push_back(diffuse_.back() + spectrum_at(spec.emissivity, node_um[i]));
    }
    balance();
    find_limits();
    const double most_diffuse = *std::max_element(diffuse_.begin(), diffuse_.end());
    const double least = *std::min_element(not_specular_.begin(), not_specular_.end());
    set_lobes({{SamplingLobe::Kind::kVisibleHalfVectors, {SlopeLaw::kEllipsoid, e_}},
               {SamplingLobe::Kind::kCosine}},
              [&](double cos_o, std::span<double> out) {
                out[0] = std::max(0.0, 1 - least * fall_(cos_o));
                out[1] = most_diffuse * fall_(cos_o);
              });
  }

  void brdf_per_sr(const ReflectionGeometry& g, float* out) const override {
    const AngleGrid::Stencil i = grid_.stencil(g.cos_i), o = grid_.stencil(g.cos_o);
    const double lobe = sandford_lobe_per_sr(g, e_) * grid_.base(g.cos_i) * grid_.base(g.cos_o);
    const double diffuse = fall_(g.cos_i) * fall_(g.cos_o) / std::numbers::pi;
    for (std::size_t k = 0; k < spectra(); ++k)
      out[k] = static_cast<float>(diffuse_[k] * diffuse + lobe * scale(k, i) * scale(k, o));
  }

  void dhr(double cos_o, std::span<double> out) const override {
    const std::vector<double> row = moments_->at(cos_o);
    const AngleGrid::Stencil o = grid_.stencil(cos_o);
    const double base = grid_.base(cos_o), fall = fall_(cos_o);
    for (std::size_t k = 0; k < spectra(); ++k) {
      const double sum =
          std::inner_product(row.begin(), row.end(), scale_.begin() + offset(k), 0.0);
      out[k] = diffuse_[k] * fall + base * scale(k, o) * sum;
    }
  }

  [[nodiscard]] double cos_brdf_limit_per_sr(const ReflectionRange& range) const override {
    const double q = (e_ * e_ + range.tan2_h_min) / (1 + range.tan2_h_min);
    const double lobe = e_ * e_ / (4 * std::numbers::pi * q * q);
    const double diffuse = *std::max_element(diffuse_.begin(), diffuse_.end());
    return diffuse / (std::numbers::pi * fall_.mean() * fall_.mean()) +
           lobe * most_of_light_[cell_of(range.cos_i_min)] * most_seen_[cell_of(range.cos_o_min)];
  }

  [[nodiscard]] double narrowest_slope() const override { return e_; }
  [[nodiscard]] double roulette_slope2() const override { return 0; }  // the lobe's tail is heavy

 private:
  static std::ptrdiff_t offset(std::size_t spectrum) {
    return static_cast<std::ptrdiff_t>(spectrum * AngleGrid::kPoints);
  }
  [[nodiscard]] double scale(std::size_t spectrum, const AngleGrid::Stencil& at) const {
    const double* s = scale_.data() + offset(spectrum) + at.first;
    return s[0] * at.weight[0] + s[1] * at.weight[1] + s[2] * at.weight[2] + s[3] * at.weight[3];
  }

  // The largest s(cos) base(cos) cos and s(cos) base(cos) from each grid cell on: base falls and
  // base x cos rises, and the weights of a cubic through four neighbours add up to at most 1.25.
  void find_limits() {
    most_of_light_.assign(AngleGrid::kPoints, 0.0);
    most_seen_.assign(AngleGrid::kPoints, 0.0);
    double light = 0, seen = 0;
    for (std::size_t cell = AngleGrid::kPoints; cell-- > 0;) {
      double scale = 0;
      for (std::size_t k = 0; k < spectra(); ++k)
        for (std::size_t i = cell < 2 ? 0 : cell - 2; i < std::min(cell + 4, AngleGrid::kPoints);
             ++i)
          scale = std::max(scale, scale_[k * AngleGrid::kPoints + i]);
      const double from = grid_.cos_of(cell),
                   to = grid_.cos_of(std::min(cell + 1, AngleGrid::kPoints - 1));
      light = std::max(light, 1.25 * scale * grid_.base(to) * to);
      seen = std::max(seen, 1.25 * scale * grid_.base(from));
      most_of_light_[cell] = light;
      most_seen_[cell] = seen;
    }
  }
  [[nodiscard]] std::size_t cell_of(double cosine) const {
    return grid_.stencil(std::clamp(cosine, 0.0, 1.0)).first;
  }

  // s <- sqrt(s rho_S / (K s)) until DHR is rho_S at every grid point: 30 rounds reach 1e-9 for all
  // widths.
  void balance() {
    constexpr std::size_t kN = AngleGrid::kPoints;
    std::vector<std::vector<double>> kernel;
    std::vector<double> base, fall;
    for (std::size_t o = 0; o < kN; ++o) {
      const double c = std::max(grid_.cos_of(o), 1e-8);
      kernel.push_back(moments_->at(c));
      base.push_back(grid_.base(c));
      fall.push_back(fall_(c));
    }
    std::vector<double> s(kN, 1.0), next(kN);
    for (std::size_t k = 0; k < spectra(); ++k) {
      for (int round = 0; round < 60; ++round) {
        double change = 0;
        for (std::size_t o = 0; o < kN; ++o) {
          const double reflected =
              base[o] * std::inner_product(s.begin(), s.end(), kernel[o].begin(), 0.0);
          const double rho = std::max(0.0, 1 - not_specular_[k] * fall[o]);
          next[o] = reflected > 0 ? std::sqrt(s[o] * rho / reflected) : 0;
          change = std::max(change, std::abs(next[o] - s[o]));
        }
        s = next;
        if (change < 1e-10) break;
      }
      scale_.insert(scale_.end(), s.begin(), s.end());
      // The next wavelength's start; nothing may stay at 0.
      for (double& x : s) x = std::max(x, 1e-3);
    }
  }

  GrazingFall fall_;
  double e_;
  AngleGrid grid_;
  std::shared_ptr<LobeMoments> moments_;
  std::vector<double> diffuse_, not_specular_;     // rho_D, rho_D + epsilon
  std::vector<double> most_of_light_, most_seen_;  // [grid point]
  std::vector<double> scale_;                      // s / base [spectrum][grid point]
};

}  // namespace

BrdfModelOr prepare_sandford_robertson(const SandfordRobertson& spec, const PreparedFor& at) {
  RETURN_IF_ERROR(first_failure(
      {check_fraction(spec.emissivity, "emissivity", at.lambda_min_um, at.lambda_max_um),
       check_fraction(spec.diffuse, "diffuse reflectance", at.lambda_min_um, at.lambda_max_um),
       check_between(spec.lobe_width, "lobe width", 1e-4, 1),
       check_between(spec.grazing, "grazing fall", 0, 0.999999)}));
  const GrazingFall fall(spec.grazing);
  for (const double lambda_um : at.node_um) {
    const double sum =
        spectrum_at(spec.emissivity, lambda_um) + spectrum_at(spec.diffuse, lambda_um);
    if (sum > fall.mean() * (1 + 1e-12))
      return absl::InvalidArgumentError(absl::StrCat(
          "emissivity + diffuse reflectance = ", sum, " at ", lambda_um,
          " um leaves less than nothing for the lobe at normal incidence: with a grazing fall of ",
          spec.grazing, " the sum may be ", fall.mean(), " at most"));
  }
  const bool grey = spec.emissivity.size() == 1 && spec.diffuse.size() == 1;
  return std::make_shared<const SandfordRobertsonModel>(spec, grey ? 1 : at.node_um.size(),
                                                        at.node_um);
}

}  // namespace irsig
