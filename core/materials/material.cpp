#include "core/materials/material.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/materials/beard_maxwell.h"
#include "core/materials/brdf_model.h"
#include "core/materials/cook_torrance.h"
#include "core/materials/dhr_table.h"
#include "core/materials/prisse.h"
#include "core/materials/sandford_robertson.h"
#include "core/materials/spectra.h"
#include "core/materials/tabulated_brdf.h"
#include "core/materials/ward.h"

namespace irsig {

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
  if (node_um.empty()) return absl::InvalidArgumentError("no wavelengths");
  Material out;
  out.nodes_ = node_um.size();
  absl::Status status;
  if (const auto* lambert = std::get_if<Lambert>(&spec.model)) {
    status = out.prepare_lambert(*lambert, node_um, lambda_min_um, lambda_max_um);
  } else if (const auto* lobe = std::get_if<CookTorrance>(&spec.model)) {
    status = first_failure(
        {check_between(lobe->roughness, "roughness", 1e-4, 1),
         lobe->normal_emissivity < 0 ? absl::OkStatus()
                                     : check_between(lobe->normal_emissivity, "emissivity", 0, 1),
         lobe->forced_emissivity < 0 ? absl::OkStatus()
                                     : check_between(lobe->forced_emissivity, "emissivity", 0, 1)});
    if (status.ok())
      status = out.prepare_cook_torrance(*lobe, node_um, lambda_min_um, lambda_max_um);
  } else if (const auto* facets = std::get_if<PriestGermer>(&spec.model)) {
    status = check_between(facets->roughness, "roughness", 1e-4, 1);
    if (status.ok())
      status = out.prepare_cook_torrance(as_cook_torrance(*facets), node_um, lambda_min_um,
                                         lambda_max_um);
  } else {
    status = out.prepare_model(spec, node_um, lambda_min_um, lambda_max_um);
  }
  if (!status.ok()) return status;
  out.set_limits();
  out.thrown_light_ = ThrownLight(out);
  return out;
}

CookTorrance as_cook_torrance(const PriestGermer& spec) {
  CookTorrance lobe;
  lobe.constants = spec.constants;
  lobe.roughness = std::numbers::sqrt2 * spec.roughness;
  lobe.masking = spec.published ? Masking::kNone : Masking::kVGroove;
  return lobe;
}

void Material::set_tables(const DhrTable& dhr, double forced_emissivity) {
  dhr_cells_ = dhr.cells;
  emissivity_dhr_.clear();
  spectral_emissivity_.clear();
  for (std::size_t row = 0; row <= static_cast<std::size_t>(dhr.cells); ++row) {
    const double* reflected = dhr.value.data() + row * dhr.spectra;
    double largest = 0;
    for (std::size_t i = 0; i < nodes_; ++i) {
      const double r = reflected[dhr.spectra == 1 ? 0 : i];
      const double e = forced_emissivity >= 0 ? forced_emissivity : std::max(0.0, 1 - r);
      if (e + r > 1 + 1e-4) creates_energy_ = true;
      largest = std::max(largest, r);
      if (i == 0) emissivity_dhr_.push_back(static_cast<float>(e));
      spectral_emissivity_.push_back(static_cast<float>(e));
    }
    emissivity_dhr_.push_back(static_cast<float>(largest));
  }
}

absl::Status Material::prepare_lambert(const Lambert& spec, const std::vector<double>& node_um,
                                       double lambda_min_um, double lambda_max_um) {
  RETURN_IF_ERROR(check_fraction(spec.emissivity, "emissivity", lambda_min_um, lambda_max_um));
  roughness_ = 0;
  narrowest_slope_ = std::numeric_limits<float>::infinity();
  grey_ = spec.emissivity.size() == 1;
  DhrTable dhr{1, nodes_, {}};
  for (int row = 0; row < 2; ++row)
    for (const double lambda_um : node_um)
      dhr.value.push_back(1 - spectrum_at(spec.emissivity, lambda_um));
  set_tables(dhr, -1);
  largest_reflectance_ = {
      static_cast<float>(*std::max_element(dhr.value.begin(), dhr.value.end()))};
  reflectance_.assign(kFresnelCells + 1, static_cast<float>(dhr.value.front()));
  // Nothing depends on angle, but the lookup is that of the other materials.
  for (int row = 0; row <= kSpectralFresnelCells; ++row)
    for (std::size_t i = 0; i < nodes_; ++i)
      spectral_reflectance_.push_back(static_cast<float>(dhr.value[i]));
  return absl::OkStatus();
}

absl::Status Material::prepare_cook_torrance(const CookTorrance& spec,
                                             const std::vector<double>& node_um,
                                             double lambda_min_um, double lambda_max_um) {
  RETURN_IF_ERROR(check_covers(spec.constants, lambda_min_um, lambda_max_um));
  const double m = spec.roughness;
  roughness_ = static_cast<float>(m);
  narrowest_slope_ = roughness_;
  roulette_slope2_ = roughness_ * roughness_;
  masking_ = spec.masking;
  grey_ = spec.constants.size() == 1;

  const std::size_t spectra = grey_ ? 1 : nodes_;
  const int cells = grey_ ? kFresnelCells : kSpectralFresnelCells;
  std::vector<std::vector<double>> fresnel;
  for (std::size_t i = 0; i < spectra; ++i)
    fresnel.push_back(fresnel_table(constants_at(spec.constants, node_um[i]), spec.fresnel, cells));
  const LobeQuadrature quadrature({SlopeLaw::kBeckmann, m});
  const auto moments = [&](double cos_o) {
    return lobe_moments(quadrature, cos_o, cells, [&](const ReflectionGeometry& g) {
      return cook_torrance_weight(g, m, spec.masking);
    });
  };
  if (spec.normal_emissivity >= 0) {
    const auto normal = moments(1.0);
    for (auto& table : fresnel) {
      const double scale = (1 - spec.normal_emissivity) / dot(normal, table);
      for (double& f : table) f *= scale;
    }
  }
  set_tables(tabulate_dhr(spectra,
                          [&](double cos_o, std::span<double> out) {
                            const auto lobe = moments(cos_o);
                            for (std::size_t i = 0; i < spectra; ++i)
                              out[i] = dot(lobe, fresnel[i]);
                          }),
             spec.forced_emissivity);
  largest_reflectance_.assign(static_cast<std::size_t>(cells) + 1, 0.0f);
  for (std::size_t entry = largest_reflectance_.size(); entry-- > 0;) {
    float& here = largest_reflectance_[entry];
    if (entry + 1 < largest_reflectance_.size()) here = largest_reflectance_[entry + 1];
    for (const auto& table : fresnel) here = std::max(here, static_cast<float>(table[entry]));
  }
  if (grey_)
    for (const double f : fresnel.front()) reflectance_.push_back(static_cast<float>(f));
  const int stride = cells / kSpectralFresnelCells;
  for (int entry = 0; entry <= cells; entry += stride)
    for (std::size_t i = 0; i < nodes_; ++i)
      spectral_reflectance_.push_back(
          static_cast<float>(fresnel[grey_ ? 0 : i][static_cast<std::size_t>(entry)]));
  return absl::OkStatus();
}

double Material::lobe_limit_per_sr(const ReflectionRange& range) const {
  // F D G / (4 cos_o): V-grooves have G <= 2 cos_h cos_o / cos_d; Smith's G <= G1(cos_o), and
  // G1(cos_o) / cos_o falls with cos_o.
  const double m = static_cast<double>(roughness_), m2 = m * m;
  const double bell = largest_bell(range.tan2_h_min, m2, 2) / (std::numbers::pi * m2);
  double grazing = groove_grazing(range);
  if (masking_ == Masking::kNone) grazing = open_grazing(range);
  if (masking_ == Masking::kSmith) {
    const double c = std::max(range.cos_o_min, 1e-9);
    grazing = std::max(0.25, 0.25 * smith_masking(1, c, m) / c);
  }
  const double position = std::sqrt(std::clamp(range.cos_d_min(), 0.0, 1.0)) *
                          static_cast<double>(largest_reflectance_.size() - 1);
  return static_cast<double>(largest_reflectance_[static_cast<std::size_t>(position)]) * bell *
         grazing;
}

double Material::cos_brdf_limit_per_sr(const ReflectionRange& range) const {
  if (roughness_ == 0) return static_cast<double>(largest_reflectance_.front()) / std::numbers::pi;
  return roughness_ < 0 ? model_->cos_brdf_limit_per_sr(range) : lobe_limit_per_sr(range);
}

namespace {

// Angles to the normal; narrower towards grazing, where limits rise.
constexpr std::size_t kLimitCells = 64;
double limit_cos(std::size_t cell) {
  const double x = 1 - static_cast<double>(cell) / kLimitCells;
  return std::sin(0.5 * std::numbers::pi * x * x);
}
std::size_t limit_cell(double cosine) {
  const double x = std::sqrt(2 / std::numbers::pi * std::asin(std::clamp(cosine, 0.0, 1.0)));
  return std::min(static_cast<std::size_t>((1 - x) * kLimitCells), kLimitCells - 1);
}

double largest_between(const std::vector<double>& limit, double cos_min, double cos_max) {
  const std::size_t first = limit_cell(cos_max), last = limit_cell(cos_min);
  return *std::max_element(limit.begin() + static_cast<std::ptrdiff_t>(first),
                           limit.begin() + static_cast<std::ptrdiff_t>(last) + 1);
}

}  // namespace

void Material::set_limits() {
  limit_of_light_.assign(kLimitCells, 0.0);
  limit_seen_.assign(kLimitCells, 0.0);
  std::vector<double> angle;
  for (std::size_t k = 0; k <= kLimitCells; ++k) angle.push_back(std::acos(limit_cos(k)));
  constexpr double kEdge = 1e-9;  // rounding of an angle that lies between two cells
  for (std::size_t i = 0; i < kLimitCells; ++i)
    for (std::size_t o = 0; o < kLimitCells; ++o) {
      // The half vector lies at least half way between angles that differ.
      const double apart =
          std::max({0.0, angle[i] - angle[o + 1] - kEdge, angle[o] - angle[i + 1] - kEdge});
      const double limit = cos_brdf_limit_per_sr(
          {std::max(0.0, limit_cos(i + 1) - kEdge), std::max(0.0, limit_cos(o + 1) - kEdge),
           std::pow(std::tan(0.5 * apart), 2), limit_cos(i) + kEdge, limit_cos(o) + kEdge});
      limit_of_light_[i] = std::max(limit_of_light_[i], limit);
      limit_seen_[o] = std::max(limit_seen_[o], limit);
    }
}

double Material::limit_of_light_per_sr(double cos_i_min, double cos_i_max) const {
  return largest_between(limit_of_light_, cos_i_min, cos_i_max);
}

double Material::limit_seen_per_sr(double cos_o_min, double cos_o_max) const {
  return largest_between(limit_seen_, cos_o_min, cos_o_max);
}

namespace {

// One overload a model: a model without one does not compile.
struct PrepareModel {
  const PreparedFor& at;
  BrdfModelOr operator()(const Ward& m) const { return prepare_ward(m, at); }
  BrdfModelOr operator()(const SandfordRobertson& m) const {
    return prepare_sandford_robertson(m, at);
  }
  BrdfModelOr operator()(const BeardMaxwell& m) const { return prepare_beard_maxwell(m, at); }
  BrdfModelOr operator()(const Prisse& m) const { return prepare_prisse(m, at); }
  BrdfModelOr operator()(const TabulatedBrdf& m) const { return prepare_tabulated_brdf(m, at); }
  // Material::prepare() has these three itself.
  BrdfModelOr operator()(const Lambert& m) const { return own(m); }
  BrdfModelOr operator()(const CookTorrance& m) const { return own(m); }
  BrdfModelOr operator()(const PriestGermer& m) const { return own(m); }

 private:
  template <typename Model>
  static BrdfModelOr own(const Model& m) {
    return absl::InternalError(absl::StrCat(std::string(m.kind()), " is not prepared as a model"));
  }
};

}  // namespace

absl::Status Material::prepare_model(const MaterialSpec& spec, const std::vector<double>& node_um,
                                     double lambda_min_um, double lambda_max_um) {
  const PreparedFor at{node_um, lambda_min_um, lambda_max_um};
  BrdfModelOr model = std::visit(PrepareModel{at}, spec.model);
  if (!model.ok()) return model.status();
  model_ = *std::move(model);
  roughness_ = -1;
  grey_ = model_->spectra() == 1;
  narrowest_slope_ = static_cast<float>(model_->narrowest_slope());
  roulette_slope2_ = static_cast<float>(model_->roulette_slope2());
  set_tables(tabulate_dhr(model_->spectra(),
                          [&](double cos_o, std::span<double> out) { model_->dhr(cos_o, out); }),
             -1);
  return absl::OkStatus();
}

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
  blend_rows(spectral_reflectance_, nodes_, kSpectralFresnelCells, std::sqrt(cos_d), out);
}

void Material::spectral_brdf_per_sr(const Reflection& r, float* out) const {
  if (roughness_ < 0) {
    model_->brdf_per_sr(widen(r), out);
    if (grey_) std::fill_n(out, nodes_, out[0]);
    return;
  }
  spectral_reflectance(r.cos_d, out);
  const float shape = shape_per_sr(r);
  for (std::size_t i = 0; i < nodes_; ++i) out[i] *= shape;
}

void Material::spectral_weight(const Sampled& s, float* out) const {
  if (grey_) {  // its weight holds the reflectance already
    std::fill_n(out, nodes_, s.weight);
    return;
  }
  if (roughness_ < 0)
    model_->brdf_per_sr(widen(s.at), out);
  else
    spectral_reflectance(s.at.cos_d, out);
  for (std::size_t i = 0; i < nodes_; ++i) out[i] *= s.weight;
}

void Material::spectral_emissivity(float cos_o, float* out) const {
  blend_rows(spectral_emissivity_, nodes_, dhr_cells_, std::sqrt(cos_o), out);
}

float Material::model_brdf_per_sr(const Reflection& r) const {
  float out = 0;
  model_->brdf_per_sr(widen(r), &out);
  return out;
}

float Material::model_density_per_sr(const Reflection& r) const {
  return static_cast<float>(model_->density_per_sr(widen(r)));
}

Material::Sampled Material::model_sample(float cos_o, float u_lobe, float u, float cos_phi,
                                         float sin_phi) const {
  const BrdfModel::Drawn d = model_->sample(cos_o, u_lobe, u, cos_phi, sin_phi);
  Sampled out{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), {}, 0};
  if (!(d.density_per_sr > 0) || out.z <= 0) return out;
  out.at = {static_cast<float>(d.at.cos_i), cos_o, static_cast<float>(d.at.cos_h),
            static_cast<float>(d.at.sin2_h), static_cast<float>(d.at.cos_d)};
  // The factor multiplies the BRDF; where the BRDF is one number, the weight contains it.
  const double factor = d.at.cos_i / d.density_per_sr;
  out.weight = static_cast<float>(factor);
  if (grey_) {
    float brdf = 0;
    model_->brdf_per_sr(d.at, &brdf);
    out.weight = static_cast<float>(factor * brdf);
  }
  return out;
}

}  // namespace irsig
