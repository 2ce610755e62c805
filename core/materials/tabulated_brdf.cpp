#include "core/materials/tabulated_brdf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/materials/gauss_legendre.h"

namespace irsig {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

using Grid = std::vector<double>;

struct GridPoint {
  std::size_t cell;
  double t;
};
// Constant beyond the ends. A grid of one point has cell 0, t 0.
GridPoint locate(const Grid& grid, double x) {
  if (grid.size() == 1) return {0, 0};
  auto after = std::upper_bound(grid.begin(), grid.end(), x);
  after = std::clamp(after, grid.begin() + 1, grid.end() - 1);
  const double a = *(after - 1), b = *after;
  return {static_cast<std::size_t>(after - grid.begin()) - 1,
          std::clamp((x - a) / (b - a), 0.0, 1.0)};
}

// The stated table at any angles.
double stated(const TabulatedBrdf& spec, std::size_t lambda, double in_deg, double out_deg,
              double phi_deg) {
  const std::size_t outs = spec.theta_r_deg.size(), azimuths = spec.phi_deg.size();
  const GridPoint i = locate(spec.theta_i_deg, in_deg), o = locate(spec.theta_r_deg, out_deg),
                  p = locate(spec.phi_deg, phi_deg);
  double sum = 0;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t di = corner & 1, d_o = corner >> 1 & 1, dp = corner >> 2;
    const double w = (di ? i.t : 1 - i.t) * (d_o ? o.t : 1 - o.t) * (dp ? p.t : 1 - p.t);
    if (w == 0) continue;
    const std::size_t row = (lambda * spec.theta_i_deg.size() + i.cell + di) * outs + o.cell + d_o;
    sum += w * static_cast<double>(spec.brdf_per_sr[row * azimuths + p.cell + dp]);
  }
  return sum;
}

absl::Status check_grid(const Grid& grid, const char* what, double least, double most) {
  if (grid.empty()) return absl::InvalidArgumentError(absl::StrCat("no ", what));
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (!(grid[i] >= least && grid[i] <= most) || (i > 0 && !(grid[i] > grid[i - 1])))
      return absl::InvalidArgumentError(absl::StrCat(
          what, " ", grid[i], ": they must increase, from ", least, " to ", most, " at most"));
  return absl::OkStatus();
}

absl::Status check_measured(const TabulatedBrdf& spec) {
  for (const auto& status :
       {check_grid(spec.lambda_um, "wavelength [um]", 1e-6, std::numeric_limits<double>::max()),
        check_grid(spec.theta_i_deg, "zenith angle of incidence [deg]", 0, 90),
        check_grid(spec.theta_r_deg, "zenith angle of reflection [deg]", 0, 90),
        check_grid(spec.phi_deg, "azimuth [deg]", 0, 180)})
    if (!status.ok()) return status;
  const std::size_t values = spec.lambda_um.size() * spec.theta_i_deg.size() *
                             spec.theta_r_deg.size() * spec.phi_deg.size();
  if (spec.brdf_per_sr.size() != values)
    return absl::InvalidArgumentError(
        absl::StrCat(spec.brdf_per_sr.size(), " BRDF values for a grid of ", values));
  for (const float f : spec.brdf_per_sr)
    if (!(f >= 0 && std::isfinite(f)))
      return absl::InvalidArgumentError(absl::StrCat("a BRDF of ", f, " 1/sr"));
  return absl::OkStatus();
}

Grid united(Grid a, const Grid& b, std::initializer_list<double> ends) {
  a.insert(a.end(), b.begin(), b.end());
  a.insert(a.end(), ends);
  std::sort(a.begin(), a.end());
  a.erase(std::unique(a.begin(), a.end()), a.end());
  return a;
}

// The integral of each grid point's hat function times `density` (an antiderivative is not needed:
// 8 points per cell are exact to rounding for cells of up to 90 deg).
template <typename Density>
std::vector<double> hat_integrals(const Grid& grid_deg, Density&& density) {
  static const QuadratureRule rule = gauss_legendre(8);
  std::vector<double> out(grid_deg.size(), 0.0);
  for (std::size_t cell = 0; cell + 1 < grid_deg.size(); ++cell) {
    const double a = grid_deg[cell] * kRadians, width = grid_deg[cell + 1] * kRadians - a;
    for (std::size_t i = 0; i < rule.x.size(); ++i) {
      const double w = width * rule.w[i] * density(a + width * rule.x[i]);
      out[cell] += w * (1 - rule.x[i]);
      out[cell + 1] += w * rule.x[i];
    }
  }
  return out;
}

class TabulatedModel final : public BrdfModel {
 public:
  TabulatedModel(const TabulatedBrdf& spec, std::size_t spectra, const std::vector<double>& node_um)
      : spectra_(spectra),
        zenith_(united(spec.theta_i_deg, spec.theta_r_deg, {0, 90})),
        azimuth_(united(spec.phi_deg, {}, {0, 180})) {
    fill(spec, node_um);
    const auto zenith_weight =
        hat_integrals(zenith_, [](double x) { return std::sin(x) * std::cos(x); });
    const auto azimuth_weight = hat_integrals(azimuth_, [](double) { return 2.0; });
    dhr_.assign(zenith_.size() * spectra_, 0.0);
    for (std::size_t o = 0; o < zenith_.size(); ++o)
      for (std::size_t i = 0; i < zenith_.size(); ++i)
        for (std::size_t p = 0; p < azimuth_.size(); ++p)
          for (std::size_t s = 0; s < spectra_; ++s)
            dhr_[o * spectra_ + s] +=
                zenith_weight[i] * azimuth_weight[p] * static_cast<double>(at(i, o, p)[s]);
    make_cells();
  }

  [[nodiscard]] std::size_t spectra() const override { return spectra_; }

  void brdf_per_sr(const ReflectionGeometry& g, float* out) const override {
    const GridPoint i = locate(zenith_, zenith_deg(g.cos_i)),
                    o = locate(zenith_, zenith_deg(g.cos_o)), p = locate(azimuth_, phi_deg(g));
    std::fill_n(out, spectra_, 0.0f);
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t di = corner & 1, d_o = corner >> 1 & 1, dp = corner >> 2;
      const auto w =
          static_cast<float>((di ? i.t : 1 - i.t) * (d_o ? o.t : 1 - o.t) * (dp ? p.t : 1 - p.t));
      const float* f = at(i.cell + di, o.cell + d_o, p.cell + dp);
      for (std::size_t s = 0; s < spectra_; ++s) out[s] += w * f[s];
    }
  }

  void dhr(double cos_o, std::span<double> out) const override {
    const GridPoint o = locate(zenith_, zenith_deg(cos_o));
    for (std::size_t s = 0; s < spectra_; ++s) {
      const double* a = dhr_.data() + o.cell * spectra_ + s;
      out[s] = a[0] + o.t * (a[spectra_] - a[0]);
    }
  }

  [[nodiscard]] double density_per_sr(const ReflectionGeometry& g) const override {
    const GridPoint o = locate(zenith_, zenith_deg(g.cos_o)),
                    i = locate(zenith_, zenith_deg(g.cos_i)), p = locate(azimuth_, phi_deg(g));
    const double total = blend(total_.data() + o.cell, 1, o.t);
    if (!(total > 0)) return 0;
    const double* height =
        height_.data() + o.cell * cells() + i.cell * (azimuth_.size() - 1) + p.cell;
    return blend(height, cells(), o.t) / total * g.cos_i;
  }

  [[nodiscard]] Drawn sample(double cos_o, double u_lobe, double u, double cos_phi,
                             double sin_phi) const override {
    const GridPoint o = locate(zenith_, zenith_deg(cos_o));
    const double near = (1 - o.t) * total_[o.cell], far = o.t * total_[o.cell + 1];
    if (!(near + far > 0)) return {};
    double chance = u_lobe * (near + far);
    const bool second = far > 0 && chance >= near;
    const std::size_t row = o.cell + (second ? 1 : 0);
    chance = second ? (chance - near) / o.t : chance / (1 - o.t);  // in [0, total of the row)
    const auto first = cumulated_.begin() + static_cast<std::ptrdiff_t>(row * cells());
    const auto last = first + static_cast<std::ptrdiff_t>(cells());
    auto found = std::upper_bound(first, last, chance);
    // Rounding may step past the last cell that reflects.
    while (found == last || height_[static_cast<std::size_t>(found - cumulated_.begin())] <= 0)
      --found;
    const auto cell = static_cast<std::size_t>(found - first);
    const std::size_t i = cell / (azimuth_.size() - 1), p = cell % (azimuth_.size() - 1);
    const double sin2_a = sin2(zenith_[i]), sin2_b = sin2(zenith_[i + 1]);
    const double sin2_i = sin2_a + u * (sin2_b - sin2_a);
    const double angle = std::atan2(sin_phi, cos_phi);
    const double azimuth =
        (azimuth_[p] + (azimuth_[p + 1] - azimuth_[p]) * std::abs(angle) / std::numbers::pi) *
        kRadians;
    const double sin_i = std::sqrt(sin2_i), sin_o = std::sqrt((1 - cos_o) * (1 + cos_o));
    Drawn out{sin_i * std::cos(azimuth),
              std::copysign(sin_i * std::sin(azimuth), angle),
              std::sqrt(std::max(0.0, 1 - sin2_i)),
              {},
              0};
    const double hx = out.x + sin_o, hz = out.z + cos_o, h2 = hx * hx + out.y * out.y + hz * hz;
    const double h = std::sqrt(h2);
    if (!(out.z > 0 && h > 0)) return out;
    out.at = {out.z, cos_o, hz / h, (hx * hx + out.y * out.y) / h2, std::min(0.5 * h, 1.0)};
    const double* height = height_.data() + o.cell * cells() + cell;
    out.density_per_sr = blend(height, cells(), o.t) / (near + far) * out.z;
    return out;
  }

  [[nodiscard]] double cos_brdf_limit_per_sr(const ReflectionRange& /*range*/) const override {
    return static_cast<double>(*std::max_element(value_.begin(), value_.end()));
  }

  [[nodiscard]] double narrowest_slope() const override {
    double least_deg = 90;
    for (std::size_t i = 0; i + 1 < zenith_.size(); ++i)
      least_deg = std::min(least_deg, zenith_[i + 1] - zenith_[i]);
    return std::tan(0.5 * least_deg * kRadians);
  }
  [[nodiscard]] double roulette_slope2() const override { return 0; }

 private:
  static double zenith_deg(double cos_theta) {
    return std::acos(std::min(cos_theta, 1.0)) / kRadians;
  }
  static double sin2(double deg) {
    const double s = std::sin(deg * kRadians);
    return s * s;
  }
  static double phi_deg(const ReflectionGeometry& g) {
    const double sines =
        std::sqrt(std::max(0.0, (1 - g.cos_i * g.cos_i) * (1 - g.cos_o * g.cos_o)));
    if (sines < 1e-12) return 90;
    const double c = (2 * g.cos_d * g.cos_d - 1 - g.cos_i * g.cos_o) / sines;
    return std::acos(std::clamp(c, -1.0, 1.0)) / kRadians;
  }
  static double blend(const double* a, std::size_t step, double t) {
    return (1 - t) * a[0] + t * a[step];
  }

  [[nodiscard]] std::size_t index(std::size_t i, std::size_t o, std::size_t p) const {
    return ((i * zenith_.size() + o) * azimuth_.size() + p) * spectra_;
  }
  [[nodiscard]] const float* at(std::size_t i, std::size_t o, std::size_t p) const {
    return value_.data() + index(i, o, p);
  }
  [[nodiscard]] std::size_t cells() const { return (zenith_.size() - 1) * (azimuth_.size() - 1); }

  void fill(const TabulatedBrdf& spec, const std::vector<double>& node_um) {
    value_.resize(zenith_.size() * zenith_.size() * azimuth_.size() * spectra_);
    std::vector<double> known(spec.lambda_um.size());
    for (std::size_t i = 0; i < zenith_.size(); ++i)
      for (std::size_t o = 0; o <= i; ++o)
        for (std::size_t p = 0; p < azimuth_.size(); ++p) {
          for (std::size_t l = 0; l < known.size(); ++l)
            known[l] = 0.5 * (stated(spec, l, zenith_[i], zenith_[o], azimuth_[p]) +
                              stated(spec, l, zenith_[o], zenith_[i], azimuth_[p]));
          for (std::size_t s = 0; s < spectra_; ++s) {
            const GridPoint l = locate(spec.lambda_um, node_um[s]);
            const double f = l.t == 0 ? known[l.cell]
                                      : known[l.cell] + l.t * (known[l.cell + 1] - known[l.cell]);
            value_[index(i, o, p) + s] = value_[index(o, i, p) + s] = static_cast<float>(f);
          }
        }
    const auto weight = hat_integrals(azimuth_, [](double) { return 1 / std::numbers::pi; });
    for (std::size_t o = 0; o < zenith_.size(); ++o)
      for (std::size_t s = 0; s < spectra_; ++s) {
        double mean = 0;
        for (std::size_t p = 0; p < azimuth_.size(); ++p)
          mean += weight[p] * static_cast<double>(value_[index(0, o, p) + s]);
        for (std::size_t p = 0; p < azimuth_.size(); ++p)
          value_[index(0, o, p) + s] = value_[index(o, 0, p) + s] = static_cast<float>(mean);
      }
  }

  // For each w_o of the grid a staircase of w_i that the table does not exceed at any wavelength.
  void make_cells() {
    const std::size_t azimuths = azimuth_.size() - 1;
    for (std::size_t o = 0; o < zenith_.size(); ++o) {
      double sum = 0;
      for (std::size_t cell = 0; cell < cells(); ++cell) {
        const std::size_t i = cell / azimuths, p = cell % azimuths;
        float most = 0;
        for (std::size_t corner = 0; corner < 4; ++corner) {
          const float* f = at(i + (corner & 1), o, p + (corner >> 1));
          most = std::max(most, *std::max_element(f, f + spectra_));
        }
        height_.push_back(static_cast<double>(most));
        // 0.5 (sin^2 b - sin^2 a) x both sides' azimuths
        sum += height_.back() * (sin2(zenith_[i + 1]) - sin2(zenith_[i])) *
               (azimuth_[p + 1] - azimuth_[p]) * kRadians;
        cumulated_.push_back(sum);
      }
      total_.push_back(sum);
    }
  }

  std::size_t spectra_;
  Grid zenith_, azimuth_;
  std::vector<float> value_;                // [in][out][azimuth][spectrum], symmetric in in and out
  std::vector<double> dhr_;                 // [out][spectrum]
  std::vector<double> height_, cumulated_;  // [out][cell]
  std::vector<double> total_;               // [out]
};

}  // namespace

BrdfModelOr prepare_tabulated_brdf(const TabulatedBrdf& spec, const PreparedFor& at) {
  RETURN_IF_ERROR(check_measured(spec));
  const bool grey = spec.lambda_um.size() == 1;
  if (!grey &&
      (spec.lambda_um.front() > at.lambda_min_um || spec.lambda_um.back() < at.lambda_max_um))
    return absl::InvalidArgumentError(
        absl::StrCat("its BRDF table covers ", spec.lambda_um.front(), " to ",
                     spec.lambda_um.back(), " um, but the bands need ", at.lambda_min_um, " to ",
                     at.lambda_max_um, " um (half a step beyond each band)"));
  return std::make_shared<const TabulatedModel>(spec, grey ? 1 : at.node_um.size(), at.node_um);
}

absl::StatusOr<TabulatedBrdfFindings> examine(const TabulatedBrdf& spec) {
  RETURN_IF_ERROR(check_measured(spec));
  const double first = std::max(spec.theta_i_deg.front(), spec.theta_r_deg.front());
  const double last = std::min(spec.theta_i_deg.back(), spec.theta_r_deg.back());
  Grid shared = united(spec.theta_i_deg, spec.theta_r_deg, {});
  std::erase_if(shared, [&](double x) { return x < first || x > last; });
  double largest = 0, difference = 0;
  for (const float f : spec.brdf_per_sr) largest = std::max(largest, static_cast<double>(f));
  for (std::size_t l = 0; l < spec.lambda_um.size(); ++l)
    for (const double in : shared)
      for (const double out : shared)
        for (const double azimuth : spec.phi_deg)
          difference = std::max(difference, std::abs(stated(spec, l, in, out, azimuth) -
                                                     stated(spec, l, out, in, azimuth)));
  const double c = std::cos(last * kRadians);
  return TabulatedBrdfFindings{largest > 0 ? difference / largest : 0, last, c * c};
}

}  // namespace irsig
