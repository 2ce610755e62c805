#include "core/gas/gas_spectrum.h"

#include <array>

#include "absl/strings/str_format.h"
#include "core/gas/curve_of_growth.h"
#include "core/gas/narrow_band.h"
#include "core/gas/soot.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr std::array<HotGas, 3> kGases = {HotGas::kH2o, HotGas::kCo2, HotGas::kCo};

// One band's transmittance from the eye to the end of what was added.
class BandPath {
 public:
  explicit BandPath(std::size_t band) : centre_cm1_(gas_band_centre_cm1(band)) {}

  // What the segment takes from it.
  Step add(const GasSegment& segment) {
    const GasState& s = segment.state;
    Step depth = {soot_, soot_absorption_per_m(centre_cm1_) * s.soot * segment.length_m};
    soot_ += depth.by;
    for (std::size_t g = 0; g < kGases.size(); ++g) {
      depth = depth + add(kGases[g], growth_[g], segment);
    }
    return exp_minus(depth);
  }

 private:
  Step add(HotGas gas, CurveOfGrowth& growth, const GasSegment& segment) const {
    const double amount = amount_cm_atm(gas, segment);
    if (!(amount > 0)) return {growth.depth(), 0};
    const double t = segment.state.temperature_k;
    const NarrowBand band = narrow_band(gas, centre_cm1_, t);
    return growth.add(band.strength_per_cm_atm * amount,
                      lorentz_width_cm1(gas, segment.state) * band.lines_per_cm1,
                      doppler_width_cm1(gas, centre_cm1_, t) * band.lines_per_cm1);
  }

  double centre_cm1_;
  std::array<CurveOfGrowth, kGases.size()> growth_;
  double soot_ = 0;
};

}  // namespace

double gas_band_centre_cm1(std::size_t band) {
  return kGasFirstCm1 + kGasBandWidthCm1 * (static_cast<double>(band) + 0.5);
}
double gas_band_lambda_um(std::size_t band) { return 1e4 / gas_band_centre_cm1(band); }

absl::StatusOr<GasSpectrum> gas_spectrum(std::span<const GasSegment> path, GasBands bands) {
  if (bands.first >= bands.last || bands.last > kGasBandCount) {
    return absl::InvalidArgumentError(absl::StrFormat("gas bands %d to %d: expected 0 to %d",
                                                      bands.first, bands.last, kGasBandCount));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (const absl::Status status = check_gas(path[i]); !status.ok()) {
      return absl::Status(status.code(),
                          absl::StrFormat("segment %d: %s", i + 1, status.message()));
    }
  }
  GasSpectrum out{bands, {}, {}, {}};
  for (std::size_t band = bands.first; band < bands.last; ++band) {
    BandPath along(band);
    double transmittance = 1, absorptance = 0, radiance = 0;
    for (const GasSegment& segment : path) {
      const Step t = along.add(segment);
      transmittance = t.to();
      absorptance -= t.by;
      radiance -=
          t.by * planck_radiance_w_m2_sr_um(gas_band_lambda_um(band), segment.state.temperature_k);
    }
    out.transmittance.push_back(transmittance);
    out.absorptance.push_back(absorptance);
    out.radiance_w_m2_sr_um.push_back(radiance);
  }
  return out;
}

}  // namespace irsig
