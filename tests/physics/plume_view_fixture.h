#pragma once

// Gas beside targets, and what single columns of it send and take.

#include <algorithm>
#include <memory>
#include <vector>

#include "core/environment/environment.h"
#include "core/gas/gas_spectrum.h"
#include "core/hot_gas/column_spectra.h"
#include "core/plume/generate_plume.h"
#include "core/plume/march.h"
#include "core/plume/plume_field.h"
#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig::fixture {

inline constexpr double kGasK = 700, kAreaM2 = 16;

// 4 x 4 m, 1 m thick, `ahead_m` before the origin, across the line of sight from ahead.
inline std::shared_ptr<const PlumeField> slab(double ahead_m, double kelvin = kGasK,
                                              double starboard_m = 0) {
  UniformPlume spec;
  spec.kind = "slab";
  spec.length_m = 1;
  spec.width_m = spec.height_m = 4;
  spec.temperature_k = kelvin;
  spec.co2 = 0.07;
  spec.h2o = 0.06;
  spec.soot = 1e-8;
  spec.voxel_m = 0.25;
  auto made = generate_uniform_plume(spec);
  EXPECT_TRUE(made.ok()) << made.status();
  made->grids.interpolation = PlumeInterpolation::kConstant;
  made->grids.position_m = {ahead_m, starboard_m, 0};
  auto field = plume_of(made->volume, made->grids);
  EXPECT_TRUE(field.ok()) << field.status();
  return *field;
}

inline GasLayer slab_layer(double kelvin = kGasK) {
  return {{kelvin, 101325, 0.06, 0.07, 0, 1e-8}, 1.0};
}

inline std::unique_ptr<Simulator> disk(double radius_m) {
  SceneSpec scene = scene_of(generated("disk", 200, radius_m), grey(1), mwir());
  scene.band.push_back({"LWIR", 8, 12, 0.25, {}});
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  return simulator_of(scene);
}

inline std::vector<double> nodes_of(const Simulator& simulator) {
  std::vector<double> um;
  for (const BandGrid& grid : simulator.band_grids())
    um.insert(um.end(), grid.node_um.begin(), grid.node_um.end());
  return um;
}

inline double in_band_of(const Simulator& simulator, std::size_t band,
                         const std::vector<double>& spectrum) {
  std::size_t first = 0;
  for (std::size_t b = 0; b < band; ++b) first += simulator.band_grids()[b].node_um.size();
  const BandGrid& grid = simulator.band_grids()[band];
  double sum = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    sum += grid.band_weight[i] * spectrum[first + i];
  return sum;
}

// Emission and absorption of one column of the slab, from core/gas alone. [node]
struct Column {
  std::vector<double> emitted, absorbed;
};
inline Column column_of(const Simulator& simulator, const GasLayer& layer,
                        const AbsorberAmounts* air) {
  Column out;
  const std::vector<GasLayer> path = {layer};
  for (const double um : nodes_of(simulator)) {
    const std::size_t band = *gas_band(um);
    const double shape =
        planck_radiance_w_m2_sr_um(um, layer.state.temperature_k) /
        planck_radiance_w_m2_sr_um(gas_band_lambda_um(band), layer.state.temperature_k);
    if (air == nullptr) {
      const auto alone = gas_spectrum(path, {band, band + 1});
      out.emitted.push_back(shape * alone->radiance_w_m2_sr_um[0]);
      out.absorbed.push_back(alone->absorptance[0]);
    } else {
      const auto through = gas_through_air(path, *air, {band, band + 1});
      out.emitted.push_back(shape * through->spectrum.radiance_w_m2_sr_um[0]);
      out.absorbed.push_back(through->spectrum.absorptance[0] / through->air_transmittance[0]);
    }
  }
  return out;
}

// Other random numbers scatter a quantity of the first row as they say.
inline void expect_seeds_scatter_as_stated(const Simulator& simulator, ViewRequest r,
                                           Estimate SignatureResult::*quantity) {
  std::vector<double> value;
  double variance = 0;
  constexpr int kSeeds = 24;
  for (int seed = 0; seed < kSeeds; ++seed) {
    r.seed = static_cast<std::uint64_t>(seed + 1);
    const auto view = simulator.simulate(r);
    ASSERT_TRUE(view.ok()) << view.status();
    const Estimate& e = view->row[0].*quantity;
    value.push_back(e.value);
    variance += e.stderr_ * e.stderr_ / kSeeds;
  }
  double mean = 0, scatter = 0;
  for (const double v : value) mean += v / kSeeds;
  for (const double v : value) scatter += (v - mean) * (v - mean) / (kSeeds - 1);
  std::printf("scatter over stated: %.2f\n", std::sqrt(scatter / variance));
  EXPECT_GT(std::sqrt(scatter / variance), 0.6);
  EXPECT_LT(std::sqrt(scatter / variance), 1.5);
}

}  // namespace irsig::fixture
