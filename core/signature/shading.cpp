#include "core/signature/shading.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/base/clones.h"
#include "core/environment/sea_glint.h"
#include "core/environment/sea_surface.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {

namespace {

// Sixteen partial sums: their order is fixed, and the compiler can keep them in vectors.
IRSIG_CLONES double long_dot(const double* a, const double* b, std::size_t n) {
  constexpr std::size_t kLanes = 16;
  double part[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) part[k] += a[i + k] * b[i + k];
  for (std::size_t k = 0; i < n; ++i, ++k) part[k] += a[i] * b[i];
  double sum = 0;
  for (const double p : part) sum += p;
  return sum;
}

// Most are over the few nodes of a bin, where that would cost more than it saves.
double dot(const double* a, const double* b, std::size_t n) {
  if (n >= 32) return long_dot(a, b, n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

double in_band(const std::vector<double>& radiance, const BandGrid& grid, std::size_t node_offset) {
  return dot(grid.band_weight.data(), radiance.data() + node_offset, grid.node_um.size());
}

// Sum over rows [first, last) of a table's entries times the weights.
double over_rows(const std::vector<double>& entry, const SourceTable& table,
                 const RowWeights& weights, std::uint32_t first, std::uint32_t last) {
  const std::size_t n = table.columns;
  if (n == weights.columns)
    return dot(entry.data() + first * n, weights.value.data() + first * n, (last - first) * n);
  double sum = 0;
  for (std::uint32_t row = first; row < last; ++row)
    sum += dot(entry.data() + row * n,
               weights.value.data() + row * weights.columns + table.first_column, n);
  return sum;
}

}  // namespace

std::size_t quantities(std::size_t parts, const BandGrid& grid, bool spectra) {
  return 1 + kCauses + 2 + parts + 2 + (spectra ? (4 + kCauses) * grid.lambda_um.size() : 0);
}

RowWeights row_weights(std::span<const double> weight, const SourceClasses& classes,
                       std::size_t columns) {
  RowWeights out{classes.parts + classes.count() - 1, columns, {}};
  out.value.assign(out.rows * columns, 0.0);
  for (std::uint32_t f = 0; f < classes.parts; ++f) {
    const double* of_part = weight.data() + static_cast<std::size_t>(f) * classes.count() * columns;
    std::copy_n(of_part, columns, out.value.data() + f * columns);
    double* shared = out.value.data() + classes.parts * columns;
    for (std::size_t k = columns; k < classes.count() * columns; ++k)
      shared[k - columns] += of_part[k];
  }
  return out;
}

std::vector<double> on_nodes(const RowWeights& weights, const SpectralBasis& basis) {
  std::vector<double> out(weights.rows * basis.nodes);
  for (std::uint32_t row = 0; row < weights.rows; ++row)
    basis.to_nodes(weights.value.data() + row * weights.columns, 0,
                   {out.data() + row * basis.nodes, basis.nodes});
  return out;
}

ViewEnvironment plain_environment(const ConditionSpec& condition, const Air& air, double range_m,
                                  bool sun, const std::vector<double>& node_um) {
  const std::size_t n = node_um.size();
  AirPath path = air_path(air, condition.air_temperature_k, range_m, node_um);
  ViewEnvironment out;
  out.sun.assign(n, 0.0);
  std::vector<double> sky(n), lower(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (sun) out.sun[i] = condition.sun_scale * solar_irradiance_w_m2_um(node_um[i]);
    sky[i] = sky_radiance_w_m2_sr_um(condition.surroundings, node_um[i]);
    lower[i] = lower_radiance_w_m2_sr_um(condition.surroundings, node_um[i], out.sun[i],
                                         condition.sun_cos_zenith);
  }
  const auto behind_air = [&](const std::vector<double>& radiance) {
    std::vector<double> seen(n);
    for (std::size_t i = 0; i < n; ++i) seen[i] = radiance[i] * path.transmittance[i];
    return seen;
  };
  out.sun_apparent = behind_air(out.sun);
  out.node_apparent = {behind_air(sky), behind_air(lower)};
  out.behind_apparent = out.node_apparent;
  out.node = {std::move(sky), std::move(lower)};
  out.transmittance = std::move(path.transmittance);
  out.path_radiance = std::move(path.path_radiance_w_m2_sr_um);
  return out;
}

ConditionShading::ConditionShading(const ConditionSpec& condition,
                                   const ViewEnvironment& environment, const SourceClasses& classes,
                                   int sun_index, const std::vector<double>& node_um,
                                   const EffectSet& effects, const EffectSet::Sun& sun)
    : classes_(classes),
      sky_(effects.sky),
      lower_(effects.lower),
      parts_(effects.parts),
      direct_sun_(sun.direct),
      sun_index_(sun_index),
      nodes_(node_um.size()),
      none_(node_um.size(), 0.0),
      environment_(&environment) {
  for (const double t : condition.part_temperature_k) {
    std::vector<double>& radiance = part_.emplace_back(nodes_);
    std::vector<double>& seen = part_apparent_.emplace_back(nodes_);
    for (std::size_t i = 0; i < nodes_; ++i) {
      radiance[i] = planck_radiance_w_m2_sr_um(node_um[i], t);
      seen[i] = radiance[i] * environment_->transmittance[i];
    }
  }
  if (classes_.glint_nodes == 0 || sun_index_ < 0) return;
  for (const float cosine : kGlintCosines) {
    std::vector<double>& radiance = glint_.emplace_back(nodes_);
    std::vector<double>& seen = glint_apparent_.emplace_back(nodes_);
    for (std::size_t i = 0; i < nodes_; ++i) {
      const double reflectance =
          water_reflectance(sea_water_index(node_um[i]), static_cast<double>(cosine));
      radiance[i] = reflectance * environment_->sun[i];
      seen[i] = reflectance * environment_->sun_apparent[i];
    }
  }
}

bool ConditionShading::is_dark(std::uint32_t c) const {
  if (c < classes_.sky()) return !parts_;
  if (c < classes_.lower()) return !sky_;
  if (c < classes_.sun(0)) return !lower_;
  return !direct_sun_ && c < classes_.glint(0);
}

const std::vector<double>& ConditionShading::source(std::uint32_t first, std::uint32_t c) const {
  if (c == classes_.own()) return part_[first];
  if (is_dark(c)) return none_;
  if (c < classes_.sky()) return part_[c - classes_.part(0)];
  if (c < classes_.sun(0)) return environment_->node[c - classes_.sky()];
  if (c >= classes_.behind(0)) return none_;
  if (c < classes_.glint(0))
    return static_cast<int>(c - classes_.sun(0)) == sun_index_ ? environment_->sun : none_;
  const std::uint32_t j = (c - classes_.glint(0)) / classes_.glint_nodes;
  return static_cast<int>(j) == sun_index_ ? glint_[c - classes_.glint(j)] : none_;
}

const std::vector<double>& ConditionShading::apparent(std::uint32_t first, std::uint32_t c) const {
  if (c == classes_.own()) return part_apparent_[first];
  if (is_dark(c)) return none_;
  if (c < classes_.sky()) return part_apparent_[c - classes_.part(0)];
  if (c < classes_.sun(0)) return environment_->node_apparent[c - classes_.sky()];
  if (c >= classes_.behind(0)) return environment_->behind_apparent[c - classes_.behind(0)];
  if (c < classes_.glint(0))
    return static_cast<int>(c - classes_.sun(0)) == sun_index_ ? environment_->sun_apparent : none_;
  const std::uint32_t j = (c - classes_.glint(0)) / classes_.glint_nodes;
  return static_cast<int>(j) == sun_index_ ? glint_apparent_[c - classes_.glint(j)] : none_;
}

SourceTable ConditionShading::table(const SpectralBasis* basis, std::size_t first_node,
                                    std::span<const double> weight) const {
  const std::uint32_t rows = classes_.parts + classes_.count() - 1;
  const std::size_t n = weight.size();
  SourceTable out;
  if (basis != nullptr && basis->identity()) {
    out.first_column = first_node;
    out.columns = n;
  } else if (basis != nullptr) {
    out.columns = basis->columns();
  }
  const std::size_t columns = out.columns;
  out.source.assign(rows * columns, 0.0);
  out.apparent.assign(rows * columns, 0.0);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const std::uint32_t c = class_of_row(row), f = row < classes_.parts ? row : 0;
    const double* radiance = source(f, c).data() + first_node;
    const double* seen = apparent(f, c).data() + first_node;
    double* s = out.source.data() + row * columns;
    double* a = out.apparent.data() + row * columns;
    if (basis == nullptr) {
      *s = dot(weight.data(), radiance, n);
      *a = dot(weight.data(), seen, n);
      continue;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double at_target = weight[i] * radiance[i], at_sensor = weight[i] * seen[i];
      if (basis->identity()) {
        s[i] = at_target;
        a[i] = at_sensor;
        continue;
      }
      const double* expand = basis->expand.data() + (first_node + i) * columns;
      for (std::size_t k = 0; k < columns; ++k) {
        s[k] += at_target * expand[k];
        a[k] += at_sensor * expand[k];
      }
    }
  }
  return out;
}

// Of several suns the condition's own alone: no sum may depend on what is computed beside.
std::array<std::array<ConditionShading::Rows, 2>, kCauses> ConditionShading::cause_rows() const {
  static_assert(static_cast<int>(Cause::kPartsReflected) == 4 && kCauses == 5);
  const auto rows = [&](std::uint32_t first_class, std::uint32_t classes) {
    const std::uint32_t first = row_of_class(first_class);
    return Rows{first, first + classes};
  };
  const bool lit = sun_index_ >= 0;
  const auto j = static_cast<std::uint32_t>(std::max(sun_index_, 0));
  return {{{Rows{0, classes_.parts}, Rows{0, 0}},
           {rows(classes_.sun(j), lit ? 1 : 0), Rows{0, 0}},
           {rows(classes_.sky(), classes_.sky_nodes), Rows{0, 0}},
           {rows(classes_.lower(), classes_.lower_nodes),
            rows(classes_.glint(j), lit ? classes_.glint_nodes : 0)},
           {rows(classes_.part(0), classes_.parts), Rows{0, 0}}}};
}

ConditionShading::Shares ConditionShading::shares(const RowWeights& rows,
                                                  const SourceClasses& classes,
                                                  const SourceTable& unit) {
  const auto sum = [&](std::uint32_t first, std::uint32_t last) {
    double total = 0;
    for (std::uint32_t row = first; row < last; ++row)
      total += dot(unit.source.data(), rows.value.data() + row * rows.columns + unit.first_column,
                   unit.columns);
    return total;
  };
  const auto row_of = [&](std::uint32_t c) { return classes.parts + c - 1; };
  return {sum(0, row_of(classes.sky())), sum(row_of(classes.sky()), row_of(classes.lower())),
          sum(row_of(classes.lower()), row_of(classes.sun(0)))};
}

SourceTable unit_table(const SpectralBasis* basis, std::size_t first_node,
                       std::span<const double> weight) {
  double whole = 0;
  for (const double w : weight) whole += w;
  SourceTable out;
  if (basis != nullptr && basis->identity()) {
    out.first_column = first_node;
    out.columns = weight.size();
    for (const double w : weight) out.source.push_back(w / whole);
    return out;
  }
  if (basis == nullptr) {
    out.source.push_back(1);
    return out;
  }
  out.columns = basis->columns();
  out.source.assign(out.columns, 0.0);
  for (std::size_t i = 0; i < weight.size(); ++i)
    for (std::size_t k = 0; k < out.columns; ++k)
      out.source[k] += weight[i] / whole * basis->expand[(first_node + i) * out.columns + k];
  return out;
}

double ConditionShading::in_band_w_sr(const RowWeights& rows, const SourceTable& in_band) const {
  double sum = 0;
  for (const auto& of_cause : cause_rows())
    for (const Rows& piece : of_cause)
      sum += over_rows(in_band.source, in_band, rows, piece.first, piece.last);
  return sum;
}

void ConditionShading::evaluate(std::span<const PathWeights> weights,
                                std::span<const RowWeights> rows, const SpectralBasis* basis,
                                const BandGrid& grid, std::size_t node_offset, bool spectra,
                                std::vector<std::vector<double>>& values) const {
  const std::size_t bins = grid.lambda_um.size(), parts = classes_.parts;
  values.assign(weights.size(), std::vector<double>(quantities(parts, grid, spectra), 0.0));

  const auto causes = cause_rows();
  const std::uint32_t behind = row_of_class(classes_.behind(0));
  // One integral over wavelength: what of each replicate goes where.
  struct Out {
    std::size_t total, cause, cause_stride, apparent, contrast, background;
  };
  const auto integrate = [&](const SourceTable& table, double path_radiance, const Out& to) {
    for (std::size_t r = 0; r < weights.size(); ++r) {
      double* out = values[r].data();
      double total = 0, seen = 0;
      for (std::size_t c = 0; c < kCauses; ++c) {
        double value = 0;
        for (const auto& [first, last] : causes[c]) {
          value += over_rows(table.source, table, rows[r], first, last);
          seen += over_rows(table.apparent, table, rows[r], first, last);
        }
        out[to.cause + c * to.cause_stride] = value;
        total += value;
      }
      const double instead = over_rows(table.apparent, table, rows[r], behind, rows[r].rows);
      const double area = weights[r].projected_area_m2;
      out[to.total] = total;
      out[to.apparent] = seen + area * path_radiance;
      out[to.contrast] = seen - instead;
      out[to.background] = area > 0 ? instead / area + path_radiance : path_radiance;
    }
  };

  const std::size_t at_area = kAreaQuantity, at_parts = at_area + 1,
                    at_contrast = contrast_quantity(parts);
  const SourceTable band = table(basis, node_offset, grid.band_weight);
  double path = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    path += grid.band_weight[i] * environment_->path_radiance[node_offset + i];
  integrate(band, path, {0, 1, 1, 1 + kCauses, at_contrast, at_contrast + 1});
  for (std::size_t r = 0; r < weights.size(); ++r) {
    values[r][at_area] = weights[r].projected_area_m2;
    for (std::uint32_t f = 0; f < classes_.parts; ++f) {
      double sum = 0;
      for (std::uint32_t c = 0; c < classes_.behind(0); ++c) {
        const std::uint32_t row = c == classes_.own() ? f : row_of_class(c);
        const double* s = band.source.data() + row * band.columns;
        const double* w = weights[r].weight.data() +
                          (static_cast<std::size_t>(f) * classes_.count() + c) * rows[r].columns +
                          band.first_column;
        sum += dot(s, w, band.columns);
      }
      values[r][at_parts + f] = sum;
    }
  }
  if (!spectra) return;
  const std::size_t at_spectra = at_contrast + 2;
  for (std::size_t k = 0; k < bins; ++k) {
    const std::size_t first = grid.bin_first[k], count = grid.bin_first[k + 1] - first;
    const std::span<const double> weight(grid.bin_weight.data() + first, count);
    double path_in_bin = 0;
    for (std::size_t i = 0; i < count; ++i)
      path_in_bin += weight[i] * environment_->path_radiance[node_offset + first + i];
    const auto at = [&](std::size_t spectrum) { return at_spectra + spectrum * bins + k; };
    integrate(table(basis, node_offset + first, weight), path_in_bin,
              {at(0), at(1), bins, at(1 + kCauses), at(2 + kCauses), at(3 + kCauses)});
  }
}

double ConditionShading::largest_in_band_w_sr(const std::vector<double>& row_on_node,
                                              const BandGrid& grid, std::size_t node_offset) const {
  double sum = 0;
  const std::uint32_t rows = row_of_class(classes_.behind(0));
  for (std::uint32_t row = 0; row < rows; ++row) {
    const double* w = row_on_node.data() + row * nodes_;
    const double largest = *std::max_element(w, w + nodes_);
    if (!(largest > 0)) continue;
    sum += largest *
           in_band(source(row < classes_.parts ? row : 0, class_of_row(row)), grid, node_offset);
  }
  return sum;
}

double ConditionShading::sun_w_m2(const BandGrid& grid, std::size_t node_offset) const {
  return sun_index_ >= 0 ? in_band(environment_->sun, grid, node_offset) : 0;
}

double ConditionShading::part_w_m2_sr(std::uint32_t part, const BandGrid& grid,
                                      std::size_t node_offset) const {
  return in_band(part_[part], grid, node_offset);
}

double ConditionShading::brightest_thermal_w_m2_sr(const BandGrid& grid,
                                                   std::size_t node_offset) const {
  double thermal = 0;
  for (const auto& node : environment_->node)
    thermal = std::max(thermal, in_band(node, grid, node_offset));
  for (const auto& p : part_) thermal = std::max(thermal, in_band(p, grid, node_offset));
  return thermal;
}

double ConditionShading::brightest_w_m2_sr(const BandGrid& grid, std::size_t node_offset) const {
  return brightest_thermal_w_m2_sr(grid, node_offset) +
         sun_w_m2(grid, node_offset) / std::numbers::pi;
}

}  // namespace irsig
