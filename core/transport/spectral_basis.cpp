#include "core/transport/spectral_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/sobol.h"

namespace irsig {
namespace {

// A fixed sequence of random numbers: the basis is a function of the materials alone.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  float operator()() { return unit_float(static_cast<std::uint32_t>(mix64(++state_) >> 32)); }
  std::size_t below(std::size_t n) {
    return std::min(static_cast<std::size_t>((*this)() * static_cast<float>(n)), n - 1);
  }

 private:
  std::uint64_t state_;
};

using Matrix = std::vector<std::vector<double>>;

// Scales to a largest value of 1 and returns what it was; 0 if there is nothing.
double normalise(std::vector<double>& row) {
  double largest = 0;
  for (const double v : row) largest = std::max(largest, std::abs(v));
  if (!(largest > 0) || !std::isfinite(largest)) return 0;
  for (double& v : row) v /= largest;
  return largest;
}

class RandomProducts {
 public:
  RandomProducts(std::span<const Material> materials, std::uint64_t seed)
      : random_(seed), nodes_(materials.front().nodes()), row_(nodes_) {
    for (const Material& m : materials)
      if (!m.grey()) spectral_.push_back(&m);
  }

  // Draws a product of `reflections` reflections by spectral materials that ends with an emission,
  // sunlight on one more reflection, or nothing spectral. Its largest value is the largest fraction
  // of a path's weight that is left after these reflections: what roulette lets through.
  std::vector<double> draw(std::size_t reflections) {
    for (;;) {
      std::vector<double> product(nodes_, 1.0);
      double left = 1;
      for (std::size_t k = 0; k < reflections && left > 0; ++k) {
        multiply_by_reflection(product);
        left *= std::min(normalise(product), 1.0);
      }
      if (reflections == 0 || random_() < 0.7f) {
        any().spectral_emissivity(grazing_or_not(), row_.data());
        for (std::size_t i = 0; i < nodes_; ++i) product[i] *= static_cast<double>(row_[i]);
      }
      if (left == 0 || normalise(product) == 0) continue;
      for (double& v : product) v *= left;
      return product;
    }
  }

 private:
  const Material& any() { return *spectral_[random_.below(spectral_.size())]; }
  float grazing_or_not() { return std::max(random_(), 1e-3f); }

  void multiply_by_reflection(std::vector<double>& product) {
    const Material& material = any();
    const float cos_o = grazing_or_not();
    if (random_() < 0.7f) {  // a drawn direction
      const float phi = 2 * static_cast<float>(std::numbers::pi) * random_();
      const float u_lobe = random_(), u = random_();
      const Material::Sampled s = material.sample(cos_o, u_lobe, u, std::cos(phi), std::sin(phi));
      if (!(s.weight > 0)) return;
      material.spectral_weight(s, row_.data());
    } else {  // aimed at a light
      const float cos_i = grazing_or_not(), phi = static_cast<float>(std::numbers::pi) * random_();
      const float sin_o = std::sqrt(1 - cos_o * cos_o), sin_i = std::sqrt(1 - cos_i * cos_i);
      const float hx = sin_o + sin_i * std::cos(phi), hy = sin_i * std::sin(phi),
                  hz = cos_o + cos_i;
      const float inverse = 1 / std::sqrt(hx * hx + hy * hy + hz * hz);
      material.spectral_brdf_per_sr(
          {cos_i, cos_o, hz * inverse, (hx * hx + hy * hy) * inverse * inverse,
           std::min((sin_o * hx + cos_o * hz) * inverse, 1.0f)},
          row_.data());
      if (!(*std::max_element(row_.begin(), row_.end()) > 0)) return;
    }
    for (std::size_t i = 0; i < nodes_; ++i) product[i] *= static_cast<double>(row_[i]);
  }

  Random random_;
  std::size_t nodes_;
  std::vector<const Material*> spectral_;
  std::vector<float> row_;
};

// Interpolation at the chosen nodes by functions, the j-th of which is 1 at node j and 0 at those
// before it.
struct Interpolation {
  std::vector<std::uint32_t> node;
  Matrix function;

  // Takes from a row what is interpolated: leaves the error.
  void reduce(std::vector<double>& row, std::size_t from = 0) const {
    for (std::size_t j = from; j < node.size(); ++j) {
      const double c = row[node[j]];
      if (c == 0) continue;
      const std::vector<double>& f = function[j];
      for (std::size_t i = 0; i < row.size(); ++i) row[i] -= c * f[i];
    }
  }
};

double largest(const std::vector<double>& row, std::size_t& where) {
  double out = -1;
  for (std::size_t i = 0; i < row.size(); ++i)
    if (std::abs(row[i]) > out) {
      out = std::abs(row[i]);
      where = i;
    }
  return out;
}

SpectralBasis every_node(std::size_t nodes) {
  SpectralBasis basis;
  basis.nodes = nodes;
  for (std::uint32_t i = 0; i < nodes; ++i) basis.carried.push_back(i);
  return basis;
}

constexpr std::size_t kTraining = 1000, kHeldOut = 2000;
constexpr int kRounds = 8;
constexpr std::size_t kTrainingReflections = 8, kHeldOutReflections = 12;

}  // namespace

void SpectralBasis::to_nodes(const double* carried_weight, std::size_t first,
                             std::span<double> out) const {
  if (identity()) {
    std::copy_n(carried_weight + first, out.size(), out.begin());
    return;
  }
  const std::size_t k_count = columns();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double* row = expand.data() + (first + i) * k_count;
    double sum = 0;
    for (std::size_t k = 0; k < k_count; ++k) sum += row[k] * carried_weight[k];
    out[i] = sum;
  }
}

std::vector<double> SpectralBasis::fold(std::size_t first, std::span<const double> values) const {
  std::vector<double> out(columns(), 0.0);
  if (identity()) {
    std::copy(values.begin(), values.end(), out.begin() + static_cast<std::ptrdiff_t>(first));
    return out;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double* row = expand.data() + (first + i) * columns();
    for (std::size_t k = 0; k < columns(); ++k) out[k] += values[i] * row[k];
  }
  return out;
}

SpectralBasis make_spectral_basis(std::span<const Material> materials, double tolerance) {
  const std::size_t nodes = materials.front().nodes();
  if (nodes <= 8 ||
      std::all_of(materials.begin(), materials.end(), [](const Material& m) { return m.grey(); }))
    return every_node(nodes);

  RandomProducts training(materials, 1), held_out(materials, 2);
  Matrix error;
  for (std::size_t k = 0; k < kTraining; ++k)
    error.push_back(training.draw(k % (kTrainingReflections + 1)));
  Interpolation interpolation;
  double measured = 0;
  // Held-out products that are worse than the tolerance join the training, and others are drawn.
  // The goal stays well above the rounding of the tables, which are in single precision: 1e-6 of an
  // emissivity of a few per cent.
  for (int round = 0; round < kRounds; ++round) {
    for (;;) {
      std::size_t row = 0, node = 0;
      double worst = 0;
      for (std::size_t k = 0; k < error.size(); ++k) {
        std::size_t where = 0;
        if (const double e = largest(error[k], where); e > worst) {
          worst = e;
          row = k;
          node = where;
        }
      }
      if (worst <= tolerance / 2) break;
      if (2 * (interpolation.node.size() + 1) > nodes) return every_node(nodes);
      std::vector<double> function = error[row];
      const double scale = function[node];
      for (double& v : function) v /= scale;
      interpolation.node.push_back(static_cast<std::uint32_t>(node));
      interpolation.function.push_back(std::move(function));
      for (std::vector<double>& e : error) interpolation.reduce(e, interpolation.node.size() - 1);
    }
    measured = 0;
    for (std::size_t k = 0; k < kHeldOut; ++k) {
      std::vector<double> product = held_out.draw(k % (kHeldOutReflections + 1));
      interpolation.reduce(product);
      std::size_t where = 0;
      const double e = largest(product, where);
      measured = std::max(measured, e);
      if (e > tolerance) error.push_back(std::move(product));
    }
    if (measured <= tolerance) break;
  }

  // function coefficients c of a product with values v at the nodes: c_j = v_j - sum over i < j of
  // c_i function_i(node_j). Row j of `coefficient` gives c_j from v.
  SpectralBasis basis;
  basis.nodes = nodes;
  basis.carried = interpolation.node;
  basis.relative_error = measured;
  const std::size_t count = interpolation.node.size();
  Matrix coefficient(count, std::vector<double>(count, 0.0));
  for (std::size_t j = 0; j < count; ++j) {
    coefficient[j][j] = 1;
    for (std::size_t i = 0; i < j; ++i) {
      const double f = interpolation.function[i][interpolation.node[j]];
      for (std::size_t k = 0; k <= i; ++k) coefficient[j][k] -= f * coefficient[i][k];
    }
  }
  basis.expand.assign(nodes * count, 0.0);
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t i = 0; i < nodes; ++i) {
      const double f = interpolation.function[j][i];
      for (std::size_t k = 0; k <= j; ++k) basis.expand[i * count + k] += f * coefficient[j][k];
    }
  return basis;
}

}  // namespace irsig
