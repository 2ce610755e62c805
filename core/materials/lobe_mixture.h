#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/materials/brdf_model.h"
#include "core/materials/slope_law.h"

namespace irsig {

// One distribution from which directions w_i are drawn:
//   kCosine             cos_i / pi
//   kUniform            1 / (2 pi)
//   kHalfVectors        mirrored at half vectors of a SlopeLobe: p / (4 cos_d); may end below the
//                       surface
//   kVisibleHalfVectors the same for half vectors of an ellipsoid as w_o sees them: D / (4
//                       sigma(cos_o)), sigma = (cos_o + sqrt(cos_o^2 + w^2 sin_o^2)) / 2
//                       [heitz2018]
struct SamplingLobe {
  enum class Kind { kCosine, kUniform, kHalfVectors, kVisibleHalfVectors } kind;
  SlopeLobe slopes{SlopeLaw::kBeckmann, 1};
};

// Several of them. The lobe is chosen with a probability that depends on cos_o only (linear between
// 65 values of sqrt(cos_o)); the density is the sum over all lobes.
class LobeMixture {
 public:
  // strength(cos_o, out[lobes]): how much each lobe reflects; >= 0. A lobe that reflects at any
  // angle is chosen with a probability of at least 0.02 at all of them, so that the density is
  // positive wherever the BRDF is.
  LobeMixture(std::vector<SamplingLobe> lobes,
              const std::function<void(double, std::span<double>)>& strength);

  [[nodiscard]] BrdfModel::Drawn sample(double cos_o, double u_lobe, double u, double cos_phi,
                                        double sin_phi) const;
  [[nodiscard]] double density_per_sr(const ReflectionGeometry& g) const;

 private:
  static constexpr int kCells = 64;
  [[nodiscard]] double probability(std::size_t lobe, double cos_o) const;

  std::vector<SamplingLobe> lobe_;
  std::vector<double> probability_;  // [kCells + 1][lobe]
};

// The common part of models that draw directions from a mixture of lobes.
class LobeModel : public BrdfModel {
 public:
  [[nodiscard]] std::size_t spectra() const override { return spectra_; }
  [[nodiscard]] Drawn sample(double cos_o, double u_lobe, double u, double cos_phi,
                             double sin_phi) const override {
    return mixture_->sample(cos_o, u_lobe, u, cos_phi, sin_phi);
  }
  [[nodiscard]] double density_per_sr(const ReflectionGeometry& g) const override {
    return mixture_->density_per_sr(g);
  }

 protected:
  explicit LobeModel(std::size_t spectra) : spectra_(spectra) {}
  void set_lobes(std::vector<SamplingLobe> lobes,
                 const std::function<void(double, std::span<double>)>& strength) {
    mixture_.emplace(std::move(lobes), strength);
  }

 private:
  std::size_t spectra_;
  std::optional<LobeMixture> mixture_;
};

}  // namespace irsig
