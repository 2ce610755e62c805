#include "core/materials/material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/materials/fresnel.h"

namespace irsig {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSpectralFresnelCells = 256;
constexpr int kSpectralDhrCells = Material::kDhrCells;

double interpolate(const std::vector<SpectralPoint>& table, double lambda_um) {
  if (table.size() == 1) return table.front().value;
  const auto after =
      std::upper_bound(table.begin(), table.end(), lambda_um,
                       [](double x, const SpectralPoint& p) { return x < p.lambda_um; });
  const auto b = after == table.end() ? table.end() - 1 : after;
  const auto a = b - 1;
  const double t = (lambda_um - a->lambda_um) / (b->lambda_um - a->lambda_um);
  return a->value + t * (b->value - a->value);
}

OpticalConstant interpolate(const std::vector<OpticalConstant>& table, double lambda_um) {
  if (table.size() == 1) return table.front();
  const auto after =
      std::upper_bound(table.begin(), table.end(), lambda_um,
                       [](double x, const OpticalConstant& p) { return x < p.lambda_um; });
  const auto b = after == table.end() ? table.end() - 1 : after;
  const auto a = b - 1;
  const double t = (lambda_um - a->lambda_um) / (b->lambda_um - a->lambda_um);
  return {lambda_um, a->n + t * (b->n - a->n), a->k + t * (b->k - a->k)};
}

template <typename Point>
absl::Status check_covers(const std::vector<Point>& table, const char* what, double lambda_min_um,
                          double lambda_max_um) {
  if (table.empty()) return absl::InvalidArgumentError(absl::StrCat("no ", what));
  if (table.size() == 1) return absl::OkStatus();
  if (table.front().lambda_um > lambda_min_um || table.back().lambda_um < lambda_max_um)
    return absl::InvalidArgumentError(
        absl::StrCat("its ", what, " covers ", table.front().lambda_um, " to ",
                     table.back().lambda_um, " um, but the bands need ", lambda_min_um, " to ",
                     lambda_max_um, " um (half a step beyond each band)"));
  return absl::OkStatus();
}

double masking_v_groove(double cos_i, double cos_o, double cos_h, double cos_d) {
  return std::min(1.0, 2.0 * cos_h * std::min(cos_i, cos_o) / cos_d);
}

double smith_lambda(double cos_theta, double m) {
  if (cos_theta >= 1.0) return 0.0;
  const double a = cos_theta / (m * std::sqrt(1.0 - cos_theta * cos_theta));
  return 0.5 * (std::erf(a) - 1.0) + std::exp(-a * a) / (2.0 * a * std::sqrt(kPi));
}

struct GaussLegendre {
  std::vector<double> x, w;  // on [0, 1]
};
GaussLegendre gauss_legendre(int n) {
  GaussLegendre rule{std::vector<double>(static_cast<std::size_t>(n)),
                     std::vector<double>(static_cast<std::size_t>(n))};
  for (int i = 0; i < n; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), derivative = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p0 = 1, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      derivative = n * (x * p1 - p0) / (x * x - 1);
      const double step = p1 / derivative;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.x[static_cast<std::size_t>(i)] = 0.5 * (1 - x);
    rule.w[static_cast<std::size_t>(i)] = 1 / ((1 - x * x) * derivative * derivative);
  }
  return rule;
}

// The distribution of cos_d in the lobe's hemispherical integral at one cos_o: DHR(lambda) = sum
// over cells of weight[cell] F(lambda, cos_d of the cell), linear between cells.
//
// Over half vectors h with density D cos_h: DHR = E[ F 4 (w_o h) cos_i shape / (D cos_h) ] = E[ F G
// (w_o h)/(cos_o cos_h) ]. tan(theta_h) = m s, density 2 s exp(-s^2), s in [0, 6.5] (exp(-6.5^2) =
// 4e-19). In azimuth the integrand has kinks where V-groove masking changes its form and an end
// where w_i sinks below the surface, all at known cos_d: each piece gets its own Gauss points. 256
// x (up to 5 x 8) points and the table leave 2e-5 against
// tests/physics/values/cook_torrance_dhr.csv; midpoints regardless of the kinks left 4e-4.
std::vector<double> lobe_moments(double cos_o, double m, Masking masking, int cells) {
  static const GaussLegendre slopes = gauss_legendre(256), azimuths = gauss_legendre(8);
  constexpr double kLast = 6.5;
  std::vector<double> moments(static_cast<std::size_t>(cells) + 1, 0.0);
  const double sin_o = std::sqrt(std::max(0.0, 1 - cos_o * cos_o));
  std::vector<double> edge;
  for (std::size_t i = 0; i < slopes.x.size(); ++i) {
    const double s = kLast * slopes.x[i];
    const double density = kLast * slopes.w[i] * 2 * s * std::exp(-s * s);
    const double tan_h = m * s;
    const double cos_h = 1 / std::sqrt(1 + tan_h * tan_h);
    const double sin_h = tan_h * cos_h;
    // cos_d = sin_o sin_h cos(phi) + cos_o cos_h, falling from phi = 0 to pi. w_i is above the
    // surface while cos_d > cos_o / (2 cos_h); G = min(1, 2 cos_h cos_i / cos_d, 2 cos_h cos_o /
    // cos_d) changes at the other three.
    const double middle = cos_o * cos_h, amplitude = sin_o * sin_h;
    const double kinks[] = {cos_o / (2 * cos_h), cos_o / cos_h, 2 * cos_o * cos_h,
                            2 * cos_o / (4 * cos_h - 1 / cos_h)};
    edge.assign({0, kPi});
    for (const double k : kinks)
      if (std::abs(k - middle) < amplitude) edge.push_back(std::acos((k - middle) / amplitude));
    std::sort(edge.begin(), edge.end());
    for (std::size_t e = 0; e + 1 < edge.size(); ++e) {
      const double width = edge[e + 1] - edge[e];
      for (std::size_t j = 0; j < azimuths.x.size(); ++j) {
        const double cos_d = amplitude * std::cos(edge[e] + width * azimuths.x[j]) + middle;
        const double cos_i = 2 * cos_d * cos_h - cos_o;
        if (cos_d <= 0 || cos_i <= 0) continue;
        const double g = masking == Masking::kVGroove ? masking_v_groove(cos_i, cos_o, cos_h, cos_d)
                                                      : smith_masking(cos_i, cos_o, m);
        const double weight = density * azimuths.w[j] * width / kPi * g * cos_d / (cos_o * cos_h);
        const double position = std::min(cos_d, 1.0) * cells;
        const auto cell =
            std::min(static_cast<std::size_t>(position), static_cast<std::size_t>(cells) - 1);
        const double t = position - static_cast<double>(cell);
        moments[cell] += weight * (1 - t);
        moments[cell + 1] += weight * t;
      }
    }
  }
  return moments;
}

double dhr(const std::vector<double>& moments, const std::vector<double>& fresnel) {
  double sum = 0;
  for (std::size_t i = 0; i < moments.size(); ++i) sum += moments[i] * fresnel[i];
  return sum;
}

std::vector<double> fresnel_table(const CookTorrance& model, const OpticalConstant& c, int cells) {
  std::vector<double> table(static_cast<std::size_t>(cells) + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double cos_d = static_cast<double>(i) / cells;
    table[i] = model.fresnel == Fresnel::kExact ? fresnel_exact(cos_d, c.n, c.k)
                                                : fresnel_schlick(cos_d, c.n, c.k);
  }
  return table;
}

// cos(theta) of a DHR table entry; the entry at grazing stands for 90 deg - 1e-4 rad.
double dhr_cos(int entry, int cells) {
  const double x = static_cast<double>(entry) / cells;
  return std::max(x * x, 1e-4);
}

}  // namespace

double smith_masking(double cos_i, double cos_o, double m) {
  return 1.0 / (1.0 + smith_lambda(cos_i, m) + smith_lambda(cos_o, m));
}

absl::StatusOr<MaterialSpec> builtin_material(const std::string& kind) {
  CookTorrance lobe;
  lobe.constants = {{0, 1.2, 5.0}};
  lobe.roughness = 0.3;
  if (kind == "hull")
    lobe.normal_emissivity = 0.8;
  else if (kind == "hull_paper")
    lobe.forced_emissivity = 0.8;
  else if (kind != "hull_index")
    return absl::NotFoundError(absl::StrCat("no material of kind ", kind));
  return MaterialSpec{kind, lobe};
}

absl::StatusOr<Material> Material::prepare(const MaterialSpec& spec,
                                           const std::vector<double>& node_um, double lambda_min_um,
                                           double lambda_max_um) {
  Material out;
  out.nodes_ = node_um.size();
  const auto columns = static_cast<std::size_t>(kDhrCells) + 1;
  out.emissivity_dhr_.resize(2 * columns);

  if (const auto* lambert = std::get_if<Lambert>(&spec.model)) {
    if (auto status = check_covers(lambert->emissivity, "emissivity", lambda_min_um, lambda_max_um);
        !status.ok())
      return status;
    for (const SpectralPoint& p : lambert->emissivity)
      if (!(p.value >= 0 && p.value <= 1))
        return absl::InvalidArgumentError(
            absl::StrCat("emissivity ", p.value, " is not between 0 and 1"));
    out.roughness_ = 0;
    out.grey_ = lambert->emissivity.size() == 1;
    double dhr_largest = 0;
    std::vector<float> emissivity(node_um.size());
    for (std::size_t i = 0; i < node_um.size(); ++i) {
      const double e = interpolate(lambert->emissivity, node_um[i]);
      emissivity[i] = static_cast<float>(e);
      dhr_largest = std::max(dhr_largest, 1 - e);
    }
    for (std::size_t i = 0; i < columns; ++i) {
      out.emissivity_dhr_[2 * i] = emissivity[0];
      out.emissivity_dhr_[2 * i + 1] = static_cast<float>(dhr_largest);
    }
    out.reflectance_.assign(kFresnelCells + 1, 1.0f - emissivity[0]);
    // One row of each spectral table is enough: nothing depends on angle; two rows keep the lookup
    // uniform.
    for (int row = 0; row <= kSpectralFresnelCells; ++row)
      for (const float e : emissivity) out.spectral_reflectance_.push_back(1.0f - e);
    for (int row = 0; row <= kSpectralDhrCells; ++row)
      out.spectral_emissivity_.insert(out.spectral_emissivity_.end(), emissivity.begin(),
                                      emissivity.end());
    return out;
  }

  const auto& lobe = std::get<CookTorrance>(spec.model);
  if (auto status =
          check_covers(lobe.constants, "table of optical constants", lambda_min_um, lambda_max_um);
      !status.ok())
    return status;
  if (!(lobe.roughness >= 0.03 && lobe.roughness <= 1))
    return absl::InvalidArgumentError(
        absl::StrCat("roughness ", lobe.roughness, " is not between 0.03 and 1"));
  out.roughness_ = static_cast<float>(lobe.roughness);
  out.masking_ = lobe.masking;
  out.grey_ = lobe.constants.size() == 1;

  const std::size_t spectra = out.grey_ ? 1 : node_um.size();
  std::vector<std::vector<double>> fresnel(spectra);
  for (std::size_t i = 0; i < spectra; ++i)
    fresnel[i] =
        fresnel_table(lobe, interpolate(lobe.constants, node_um[i]), kSpectralFresnelCells);
  std::vector<double> scale(spectra, 1.0);
  if (lobe.normal_emissivity >= 0) {
    const auto moments = lobe_moments(1.0, lobe.roughness, lobe.masking, kSpectralFresnelCells);
    for (std::size_t i = 0; i < spectra; ++i)
      scale[i] = (1 - lobe.normal_emissivity) / dhr(moments, fresnel[i]);
  }

  std::vector<float> row_emissivity(spectra);
  for (std::size_t column = 0; column < columns; ++column) {
    const double cos_o = dhr_cos(static_cast<int>(column), kDhrCells);
    const auto moments = lobe_moments(cos_o, lobe.roughness, lobe.masking, kSpectralFresnelCells);
    double largest = 0;
    for (std::size_t i = 0; i < spectra; ++i) {
      const double reflected = scale[i] * dhr(moments, fresnel[i]);
      const double e =
          lobe.forced_emissivity >= 0 ? lobe.forced_emissivity : std::max(0.0, 1 - reflected);
      if (e + reflected > 1 + 1e-4) out.creates_energy_ = true;
      row_emissivity[i] = static_cast<float>(e);
      largest = std::max(largest, reflected);
    }
    out.emissivity_dhr_[2 * column] = row_emissivity[0];
    out.emissivity_dhr_[2 * column + 1] = static_cast<float>(largest);
    constexpr std::size_t kStride = kDhrCells / kSpectralDhrCells;
    if (column % kStride == 0)
      for (std::size_t i = 0; i < node_um.size(); ++i)
        out.spectral_emissivity_.push_back(row_emissivity[out.grey_ ? 0 : i]);
  }
  if (out.grey_) {
    const auto fine = fresnel_table(lobe, lobe.constants.front(), kFresnelCells);
    for (const double f : fine) out.reflectance_.push_back(static_cast<float>(scale[0] * f));
  }
  for (std::size_t cell = 0; cell <= kSpectralFresnelCells; ++cell)
    for (std::size_t i = 0; i < node_um.size(); ++i) {
      const std::size_t s = out.grey_ ? 0 : i;
      out.spectral_reflectance_.push_back(static_cast<float>(scale[s] * fresnel[s][cell]));
    }
  return out;
}

float Material::emissivity(float cos_o) const { return emissivity_and_dhr(cos_o).emissivity; }
float Material::dhr_max(float cos_o) const { return emissivity_and_dhr(cos_o).dhr_max; }

namespace {
void blend_rows(const std::vector<float>& table, std::size_t columns, int cells, float x,
                float* out) {
  const float position = x * static_cast<float>(cells);
  const int cell = std::clamp(static_cast<int>(position), 0, cells - 1);
  const float t = position - static_cast<float>(cell);
  const float* a = table.data() + static_cast<std::size_t>(cell) * columns;
  const float* b = a + columns;
  for (std::size_t i = 0; i < columns; ++i) out[i] = a[i] + t * (b[i] - a[i]);
}
}  // namespace

void Material::spectral_reflectance(float cos_d, float* out) const {
  blend_rows(spectral_reflectance_, nodes_, kSpectralFresnelCells, cos_d, out);
}
void Material::spectral_emissivity(float cos_o, float* out) const {
  blend_rows(spectral_emissivity_, nodes_, kSpectralDhrCells, std::sqrt(cos_o), out);
}

}  // namespace irsig
