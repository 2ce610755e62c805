#include "core/gas/gas_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/atmosphere/gas_terms.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/gas/gas_loops.h"
#include "core/gas/hot_lines.h"
#include "core/gas/narrow_band.h"
#include "core/gas/soot.h"
#include "core/gas/step.h"
#include "core/gas/water_through_air.h"

namespace irsig {
namespace {

constexpr std::array<HotGas, 3> kGases = {HotGas::kH2o, HotGas::kCo2, HotGas::kCo};
constexpr std::array<Gas, 3> kSameInAir = {Gas::kH2o, Gas::kCo2, Gas::kCo};

double mole_fraction(HotGas gas, const GasState& s) {
  return gas == HotGas::kH2o ? s.h2o : gas == HotGas::kCo2 ? s.co2 : s.co;
}

// Column of a gas along a segment.                                                [mol/m2]
double amount_mol_m2(HotGas gas, const GasLayer& segment) {
  const GasState& s = segment.state;
  return mole_fraction(gas, s) * s.pressure_pa / (kGasConstantJMolK * s.temperature_k) *
         segment.length_m;
}

double product(const GasTerms& terms) {
  if (terms.depth.empty()) return 1;
  double sum = 0;
  for (std::size_t i = 0; i < terms.depth.size(); ++i) {
    sum += terms.weight[i] * std::exp(-terms.depth[i]);
  }
  return sum;
}

absl::Status check(GasBands bands, GasBands within) {
  if (bands.first >= bands.last || bands.first < within.first || bands.last > within.last) {
    return absl::InvalidArgumentError(absl::StrFormat("gas bands %d to %d: expected %d to %d",
                                                      bands.first, bands.last, within.first,
                                                      within.last));
  }
  return absl::OkStatus();
}

// One gas along a path in some bands of a range: those in which its lines are at random, or its
// own.
class OwnBands {
 public:
  OwnBands(HotGas gas, GasBands bands) : gas_(gas) {
    for (std::size_t b = bands.first; b < bands.last; ++b) {
      const HotLineBand* lines = hot_line_band(gas, b);
      if (lines == nullptr) {
        if (!narrow_band_exists(gas, gas_band_centre_cm1(b))) continue;
        narrow_.push_back(b - bands.first);
        centre_cm1_.push_back(gas_band_centre_cm1(b));
      } else if (!lines->joint) {
        with_lines_.push_back({b - bands.first, lines, lines->weight});
        decay_.resize(std::max(decay_.size(), lines->weight.size()));
      }
    }
    for (auto* v : {&sum_weak_, &sum_lorentz_, &sum_doppler_, &depth_, &weak_, &lorentz_, &doppler_,
                    &from_, &by_})
      v->assign(narrow_.size(), 0.0);
    band_.resize(narrow_.size());
  }

  // Writes the bands that it has.
  void add(const GasLayer& layer, const HotLinePlace& place, double* from, double* by) {
    const double t = layer.state.temperature_k, amount = amount_cm_atm(gas_, layer);
    narrow_bands(gas_, centre_cm1_, t, band_);
    const double lorentz = lorentz_width_cm1(gas_, layer.state),
                 doppler_per_cm1 = doppler_width_cm1(gas_, 1, t);
    for (std::size_t i = 0; i < narrow_.size(); ++i) {
      weak_[i] = band_[i].strength_per_cm_atm * amount;
      lorentz_[i] = lorentz * band_[i].lines_per_cm1;
      doppler_[i] = doppler_per_cm1 * centre_cm1_[i] * band_[i].lines_per_cm1;
    }
    grow(narrow_.size(),
         {sum_weak_.data(), sum_lorentz_.data(), sum_doppler_.data(), depth_.data()}, weak_.data(),
         lorentz_.data(), doppler_.data(), {from_.data(), by_.data()});
    for (std::size_t i = 0; i < narrow_.size(); ++i) {
      from[narrow_[i]] = from_[i];
      by[narrow_[i]] = by_[i];
    }
    const double mol_m2 = amount_mol_m2(gas_, layer);
    for (Lines& one : with_lines_) {
      const std::size_t points = one.left.size();
      line_decay(points, one.lines->thousandth_ln.data(), place, mol_m2, decay_.data());
      const LineStep step = through_lines(points, decay_.data(), one.left.data());
      from[one.band] = step.from;
      by[one.band] = step.by;
    }
  }

 private:
  struct Lines {
    std::size_t band;
    const HotLineBand* lines;
    std::vector<double> left;
  };
  HotGas gas_;
  std::vector<std::size_t> narrow_;
  std::vector<double> centre_cm1_, sum_weak_, sum_lorentz_, sum_doppler_, depth_;
  std::vector<double> weak_, lorentz_, doppler_, from_, by_;
  std::vector<NarrowBand> band_;
  std::vector<Lines> with_lines_;
  std::vector<double> decay_;
};

// Absorption of a layer's water in each band where it is thin, and its spread over the band's
// wavenumbers: a curve of LorenzCurves, from the lines' density of narrow_band.h.
class WaterShapes {
 public:
  explicit WaterShapes(GasBands bands) {
    for (std::size_t b = bands.first; b < bands.last; ++b) {
      centre_cm1_.push_back(gas_band_centre_cm1(b));
      lines_.push_back(hot_line_band(HotGas::kH2o, b));
    }
    band_.resize(centre_cm1_.size());
  }

  void find(const GasLayer& layer, const HotLinePlace& place, double* weak, double* shape) {
    narrow_bands(HotGas::kH2o, centre_cm1_, layer.state.temperature_k, band_);
    const double cm_atm = amount_cm_atm(HotGas::kH2o, layer),
                 mol_m2 = amount_mol_m2(HotGas::kH2o, layer),
                 lorentz = lorentz_width_cm1(HotGas::kH2o, layer.state);
    for (std::size_t b = 0; b < band_.size(); ++b) {
      weak[b] = lines_[b] == nullptr ? band_[b].strength_per_cm_atm * cm_atm
                : mol_m2 > 0         ? mean_absorption_m2_mol(*lines_[b], place) * mol_m2
                                     : 0;
      if (weak[b] > 0)
        shape[b] = LorenzCurves::place_of_shape(2 * lorentz * band_[b].lines_per_cm1);
    }
  }

 private:
  std::vector<double> centre_cm1_;
  std::vector<const HotLineBand*> lines_;
  std::vector<NarrowBand> band_;
};

// Points of joint lines, before anything.
std::vector<double> weights(const std::vector<JointLines>& joint) {
  std::vector<double> out;
  for (const JointLines& one : joint)
    out.insert(out.end(), one.lines->weight.begin(), one.lines->weight.end());
  return out;
}

}  // namespace

std::vector<JointLines> joint_lines(GasBands bands) {
  std::vector<JointLines> out;
  std::size_t first = 0;
  for (std::size_t g = 0; g < kGases.size(); ++g)
    for (std::size_t b = bands.first; b < bands.last; ++b) {
      const HotLineBand* lines = hot_line_band(kGases[g], b);
      if (lines == nullptr || !lines->joint) continue;
      out.push_back({g, b - bands.first, first, lines});
      first += lines->weight.size();
    }
  return out;
}

absl::StatusOr<ForegroundAir> ForegroundAir::make(const AbsorberAmounts& air, GasBands bands) {
  RETURN_IF_ERROR(check(bands, kAirGasBands));
  ForegroundAir out;
  out.bands_ = bands;
  for (std::size_t band = bands.first; band < bands.last; ++band) {
    const std::size_t air_band = band - kAirGasBands.first;
    double others = 1;
    for (std::size_t g = 1; g < kGases.size(); ++g) {
      const HotLineBand* lines = hot_line_band(kGases[g], band);
      if (lines == nullptr || !lines->joint)
        others *= product(gas_terms(air, kSameInAir[g], air_band));
    }
    for (const Gas gas : {Gas::kO3, Gas::kN2o, Gas::kCh4, Gas::kCfc11, Gas::kCfc12})
      others *= product(gas_terms(air, gas, air_band));
    double grey = 0;
    for (const AirSpectrum& depth : air.optical_depth) grey += depth[air_band];
    out.others_.push_back(others * std::exp(-grey));
    out.add_water(air_band, air);
    out.transmittance_.push_back(out.others_.back() * out.water_.back());
  }
  out.point_begin_.push_back(out.place_.size());
  out.add_lines(air);
  return out;
}

void ForegroundAir::add_water(std::size_t band, const AbsorberAmounts& air) {
  point_begin_.push_back(place_.size());
  GasTerms cold = gas_terms(air, Gas::kH2o, band);
  water_.push_back(product(cold));
  thin_air_.push_back(water_thin_air_spread(water_.back()));
  if (cold.depth.empty()) cold = {{0}, {1}};  // no lines of cold water here
  std::vector<std::size_t> order(cold.depth.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return cold.depth[i]; });
  double sum = 0;
  for (const std::size_t i : order) {
    const double through = std::exp(-cold.depth[i]);
    // Four bins of each term, as the hot gas's absorption varies within it.
    for (const double share : {0.4, 0.3, 0.2, 0.1}) {
      const double w = cold.weight[i] * share;
      sum += w;
      const LorenzCurves::Place place = LorenzCurves::place_of_share(sum);
      place_.push_back(static_cast<std::int32_t>(place.low));
      on_.push_back(place.on);
      weight_.push_back(w);
      inverse_weight_.push_back(1 / w);
      air_.push_back(through);
    }
  }
  while ((place_.size() - point_begin_.back()) % kGasLanes != 0) {  // of no weight
    place_.push_back(place_.back());
    on_.push_back(on_.back());
    for (auto* v : {&weight_, &inverse_weight_, &air_}) v->push_back(0);
  }
  IRSIG_CHECK(place_.size() - point_begin_.back() <= kMostWaterPoints);
}

void ForegroundAir::add_lines(const AbsorberAmounts& air) {
  const std::vector<JointLines> joint = joint_lines(bands_);
  joint_ = weights(joint);
  for (const JointLines& one : joint) {
    const GasTerms cold =
        gas_terms(air, kSameInAir[one.gas], bands_.first + one.band - kAirGasBands.first);
    IRSIG_CHECK(cold.depth.size() == one.lines->term_weight.size());
    double sum = 0;
    for (std::size_t i = 0; i < one.lines->weight.size(); ++i) {
      double& left = joint_[one.first + i];
      left *= std::exp(-cold.depth[one.lines->term_of[i]]);
      sum += left;
    }
    transmittance_[one.band] *= sum;
  }
}

absl::StatusOr<GasPath> GasPath::make(std::span<const GasLayer> path, GasBands bands) {
  RETURN_IF_ERROR(check(bands, {}));
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (const absl::Status status = check_gas(path[i]); !status.ok()) {
      return absl::Status(status.code(),
                          absl::StrFormat("segment %d: %s", i + 1, status.message()));
    }
  }
  GasPath out;
  out.bands_ = bands;
  out.compute(path);
  return out;
}

void GasPath::compute(std::span<const GasLayer> path) {
  const std::size_t n = bands_.size();
  joint_ = joint_lines(bands_);
  std::vector<double> left = weights(joint_);
  layers_ = path.size();
  points_ = left.size();
  of_band_.assign(layers_ * kKinds * n, 0.0);
  decay_.assign(layers_ * points_, 0.0);
  std::vector<double> um, planck_scale, soot_per_m, soot_depth(n, 0.0);
  for (std::size_t b = bands_.first; b < bands_.last; ++b) {
    const double lambda = gas_band_lambda_um(b);
    um.push_back(lambda);
    planck_scale.push_back(kC1LWUm4M2Sr / (lambda * lambda * lambda * lambda * lambda));
    soot_per_m.push_back(soot_absorption_per_m(gas_band_centre_cm1(b)));
  }
  std::array<OwnBands, 3> own = {OwnBands(kGases[0], bands_), OwnBands(kGases[1], bands_),
                                 OwnBands(kGases[2], bands_)};
  WaterShapes shapes(bands_);
  std::vector<double> whole_from(n), whole_by(n), from(n), by(n), emitted(n, 0.0), taken(n, 0.0);
  std::vector<double> others(2 * n, 1.0), joint_through(n, 1.0);
  for (const JointLines& one : joint_) {
    double sum = 0;
    for (const double w : one.lines->weight) sum += w;
    joint_through[one.band] *= sum;
  }
  through_.assign(n, 1.0);
  water_through_.assign(n, 1.0);
  for (std::size_t layer = 0; layer < layers_; ++layer) {
    const GasLayer& segment = path[layer];
    const double t = segment.state.temperature_k, spread = segment.temperature_spread_k;
    const HotLinePlace place = hot_line_place(t, segment.state.pressure_pa);
    const Steps rest{of(layer, kFrom), of(layer, kBy)};
    soot_step(n, segment.state.soot * segment.length_m, soot_per_m.data(), soot_depth.data(), rest);
    std::copy(rest.from, rest.from + n, of(layer, kSootFrom));
    std::fill(through_.begin(), through_.end(), 1.0);
    for (std::size_t g = 1; g < kGases.size(); ++g) {
      std::fill(from.begin(), from.end(), 1.0);
      std::fill(by.begin(), by.end(), 0.0);
      own[g].add(segment, place, from.data(), by.data());
      multiply(n, rest, {from.data(), by.data()});
      for (std::size_t b = 0; b < n; ++b) through_[b] *= from[b] + by[b];
    }
    double *water_from = of(layer, kWaterFrom), *water_by = of(layer, kWaterBy);
    std::fill(water_from, water_from + n, 1.0);
    const HotLinePlace water_place =
        hot_line_place(t, line_pressure_pa(HotGas::kH2o, segment.state));
    own[0].add(segment, water_place, water_from, water_by);
    for (std::size_t b = 0; b < n; ++b) water_through_[b] = water_from[b] + water_by[b];
    shapes.find(segment, water_place, of(layer, kWeak), of(layer, kShape));
    independence_.push_back(water_independence(t));
    spread_.push_back(water_independence_spread(t));
    planck_mean(n, um.data(), planck_scale.data(), t - spread, t + spread, of(layer, kEmitted));

    // The gas alone.
    std::copy(rest.from, rest.from + n, whole_from.begin());
    std::copy(rest.by, rest.by + n, whole_by.begin());
    const Steps whole{whole_from.data(), whole_by.data()};
    multiply(n, whole, {water_from, water_by});
    if (!joint_.empty()) {
      std::fill(joint_through.begin(), joint_through.end(), 1.0);
      double* decay = decay_.data() + layer * points_;
      for (const JointLines& one : joint_) {
        const std::size_t points = one.lines->weight.size();
        line_decay(points, one.lines->thousandth_ln.data(), place,
                   amount_mol_m2(kGases[one.gas], segment), decay + one.first);
        const LineStep step = through_lines(points, decay + one.first, left.data() + one.first);
        const Step product =
            Step{whole_from[one.band], whole_by[one.band]} * Step{step.from, step.by};
        whole_from[one.band] = product.from;
        whole_by[one.band] = product.by;
        joint_through[one.band] *= step.from + step.by;
      }
    }
    const double* light = of(layer, kEmitted);
    for (std::size_t b = 0; b < n; ++b) {
      taken[b] -= whole_by[b];
      emitted[b] -= whole_by[b] * light[b];
    }
  }
  for (std::size_t b = 0; b < n; ++b) through_[b] *= std::exp(-soot_depth[b]);
  alone_.bands = bands_;
  for (std::size_t b = 0; b < n; ++b)
    alone_.transmittance.push_back(through_[b] * water_through_[b] * joint_through[b]);
  alone_.absorptance = std::move(taken);
  alone_.radiance_w_m2_sr_um = std::move(emitted);
}

GasThroughAir GasPath::through(const ForegroundAir& air) const {
  IRSIG_CHECK(air.bands_.first == bands_.first);
  IRSIG_CHECK(air.bands_.last == bands_.last);
  const std::size_t n = bands_.size();
  std::vector<double> joint_left = air.joint_, water_left = air.weight_, water = air.water_;
  std::vector<double> whole_from(n), whole_by(n), rest_from(n), joint_through(n, 1.0);
  GasThroughAir out{
      {bands_, std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)},
      air.transmittance_,
      std::vector<double>(n)};
  const auto& curves = LorenzCurves::curves();
  if (layers_ == 0)
    for (const JointLines& one : joint_) {
      double sum = 0;
      for (std::size_t i = 0; i < one.lines->weight.size(); ++i) sum += joint_left[one.first + i];
      joint_through[one.band] *= sum;
    }
  for (std::size_t layer = 0; layer < layers_; ++layer) {
    const double *from = of(layer, kFrom), *by = of(layer, kBy), *soot = of(layer, kSootFrom),
                 *water_by = of(layer, kWaterBy), *weak = of(layer, kWeak),
                 *shape = of(layer, kShape), *light = of(layer, kEmitted);
    for (std::size_t b = 0; b < n; ++b) {
      whole_from[b] = air.others_[b] * from[b];
      whole_by[b] = air.others_[b] * by[b];
      // The error was compared without soot.
      rest_from[b] = soot[b] > 0 ? whole_from[b] / soot[b] : 0;
      joint_through[b] = 1;
    }
    const double* decay = decay_.data() + layer * points_;
    for (const JointLines& one : joint_) {
      const std::size_t points = one.lines->weight.size();
      const LineStep step = through_lines(points, decay + one.first, joint_left.data() + one.first);
      const Step product =
          Step{whole_from[one.band], whole_by[one.band]} * Step{step.from, step.by};
      whole_from[one.band] = product.from;
      whole_by[one.band] = product.by;
      rest_from[one.band] *= step.from;
      joint_through[one.band] *= step.from + step.by;
    }
    const double w = independence_[layer];
    for (std::size_t b = 0; b < n; ++b) {
      Step step{water[b], 0};
      if (weak[b] > 0) {
        const std::size_t first = air.point_begin_[b], points = air.point_begin_[b + 1] - first;
        const std::size_t low =
            std::min(static_cast<std::size_t>(shape[b]), LorenzCurves::kShapes - 2);
        const WaterTaken taken = through_water(
            points,
            {&air.place_[first], &air.on_[first], &air.inverse_weight_[first], &air.air_[first]},
            curves[low].data(), curves[low + 1].data(), shape[b] - static_cast<double>(low),
            weak[b], &water_left[first]);
        const double ranked = taken.all > 0 ? taken.through / taken.all : air.air_[first],
                     product = air.water_[b];
        step.by = water_by[b] * ((1 - w) * ranked + w * product);
        const double spread =
            std::sqrt(spread_[layer] * spread_[layer] + air.thin_air_[b] * air.thin_air_[b]);
        out.water_correlation_error_w_m2_sr_um[b] +=
            std::abs(water_by[b] * (product - ranked)) * spread * rest_from[b] * light[b];
      }
      const Step all = Step{whole_from[b], whole_by[b]} * step;
      water[b] = step.to();
      out.spectrum.absorptance[b] -= all.by;
      out.spectrum.radiance_w_m2_sr_um[b] -= all.by * light[b];
    }
  }
  for (std::size_t b = 0; b < n; ++b)
    out.spectrum.transmittance[b] = air.others_[b] * through_[b] * water[b] * joint_through[b];
  return out;
}

}  // namespace irsig
