#include "verify/reference/reference_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

constexpr std::size_t kCells = 512;

}  // namespace

double integral_in_band(const Band& band, const std::function<double(double)>& f,
                        std::span<const double> breaks_um, int points) {
  std::vector<double> end{band.lambda_min_um, band.lambda_max_um};
  for (const SpectralPoint& p : band.response) end.push_back(p.lambda_um);
  end.insert(end.end(), breaks_um.begin(), breaks_um.end());
  std::erase_if(end, [&](double l) { return l < band.lambda_min_um || l > band.lambda_max_um; });
  std::sort(end.begin(), end.end());
  double sum = 0;
  for (std::size_t k = 0; k + 1 < end.size(); ++k) {
    const double width = end[k + 1] - end[k];
    if (!(width > 0)) continue;
    // As dense in each piece as in the whole.
    const int n = 16 + static_cast<int>(points * width / (band.lambda_max_um - band.lambda_min_um));
    double piece = 0;
    for (int i = 0; i < n; ++i) {
      const double lambda_um = end[k] + (i + 0.5) * width / n;
      piece += band_response(band, lambda_um) * f(lambda_um);
    }
    sum += piece * width / n;
  }
  return sum;
}

WavelengthDraw::WavelengthDraw(const Band& band,
                               const std::vector<std::function<double(double)>>& spectra,
                               int strata)
    : band_(band), strata_(strata), sum_(kCells + 1, 0.0) {
  const double step = (band.lambda_max_um - band.lambda_min_um) / kCells;
  std::vector<double> density(kCells, 0.0);
  const auto at = [&](std::size_t cell) {
    return band.lambda_min_um + (static_cast<double>(cell) + 0.5) * step;
  };
  int used = 0;
  for (const auto& spectrum : spectra) {
    double total = 0;
    for (std::size_t k = 0; k < kCells; ++k) total += spectrum(at(k));
    if (!(total > 0)) continue;
    ++used;
    for (std::size_t k = 0; k < kCells; ++k) density[k] += spectrum(at(k)) / total;
  }
  for (std::size_t k = 0; k < kCells; ++k)
    sum_[k + 1] = sum_[k] + density[k] + 0.1 * std::max(used, 1) / kCells;
  for (double& s : sum_) s /= sum_.back();
}

void WavelengthDraw::draw(double u, double* lambda_um, double* weight) const {
  const double width = band_.lambda_max_um - band_.lambda_min_um;
  for (int k = 0; k < strata_; ++k) {
    const double q = (k + u) / strata_;
    const auto above = std::upper_bound(sum_.begin() + 1, sum_.end() - 1, q);
    const double low = *(above - 1), high = *above;
    const auto cell = static_cast<double>(above - sum_.begin() - 1);
    const double t = std::clamp((q - low) / (high - low), 0.0, 1.0);
    lambda_um[k] = band_.lambda_min_um + (cell + t) * width / kCells;
    const double density_per_um = (high - low) * kCells / width;
    weight[k] = band_response(band_, lambda_um[k]) / (density_per_um * strata_);
  }
}

double PlainLight::sky(double lambda_um) const {
  const Surroundings& s = condition->surroundings;
  return s.sky_temperature_k >= 0 ? planck_radiance_w_m2_sr_um(lambda_um, s.sky_temperature_k)
                                  : s.sky_radiance_w_m2_sr_um;
}

double PlainLight::sunlight(double lambda_um) const {
  return sun ? condition->sun_scale * solar_irradiance_w_m2_um(lambda_um) : 0.0;
}

double PlainLight::lower(double lambda_um) const {
  const Surroundings& s = condition->surroundings;
  if (s.kind == SurroundingsKind::kNone) return s.lower_radiance_w_m2_sr_um;
  const double in = sky(lambda_um) + sunlight(lambda_um) *
                                         std::max(0.0, condition->sun_cos_zenith) /
                                         std::numbers::pi;
  return s.sea_emissivity * planck_radiance_w_m2_sr_um(lambda_um, s.sea_temperature_k) +
         (1 - s.sea_emissivity) * in;
}

}  // namespace irsig
