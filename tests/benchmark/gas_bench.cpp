// CPU time of hot gas: spectra of a funnel's columns over 3-5 and 8-12 um, on one core.
//   gas_bench [rays across, 12]
// Prints CSV: first the funnel's generation and the march of its rays at the steps of views; then
// for steps of temperature that make short and long columns: microseconds of a column that is
// prepared and seen at its near end, and seen behind air once it is prepared, each beside the
// formulas one by one (tests/physics/plain_gas) in the same run, with the ratio; and of the air
// itself, once.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/hot_gas/column_spectra.h"
#include "core/hot_gas/gas_on_view.h"
#include "core/plume/generate_plume.h"
#include "core/plume/march.h"
#include "core/plume/plume_field.h"
#include "core/plume/plume_silhouette.h"
#include "tests/physics/plain_gas/plain_gas.h"

namespace irsig {
namespace {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Least of some runs.
template <typename What>
double least_s(int runs, const What& what) {
  double out = 1e300;
  for (int r = 0; r < runs; ++r) {
    const double start = cpu_s();
    what();
    out = std::min(out, cpu_s() - start);
  }
  return out;
}

FunnelPlume funnel() {
  FunnelPlume out;
  out.exit = {1.2, 20, 650};
  out.exhaust.excess_air = 1.2;
  out.exhaust.soot_g_per_kg = 0.3;
  out.wind_m_s = 6;
  out.wind_from_deg = 40;
  out.length_m = 40;
  out.voxel_m = 0.4;
  return out;
}

std::vector<GasLayer> layers_of(const GasColumn& column) {
  std::vector<GasLayer> out;
  for (const GasSegment& s : column)
    out.push_back({{s.temperature_k, s.pressure_pa, s.mole_fraction(1), s.mole_fraction(0),
                    s.mole_fraction(2), s.amount[kSoot] / s.length_m()},
                   s.length_m(),
                   s.temperature_spread_k});
  return out;
}

void report(double step, const std::vector<GasColumn>& columns, const GasWavelengths& wavelengths,
            const AbsorberAmounts& amounts) {
  // The formulas one by one: each column and its coarser one.
  double sum = 0;
  const auto plain = [&](bool behind) {
    for (const GasColumn& column : columns) {
      GasColumn coarse;
      for (const CoarseStep& pair : coarser(column)) coarse.push_back(pair.segment);
      for (const GasColumn* one : {&column, static_cast<const GasColumn*>(&coarse)})
        for (const GasBands& range : wavelengths.ranges())
          sum += behind ? plain::gas_through_air(layers_of(*one), amounts, range)
                              ->spectrum.radiance_w_m2_sr_um[0]
                        : plain::gas_spectrum(layers_of(*one), range)->radiance_w_m2_sr_um[0];
    }
  };
  std::vector<HotColumn> hot;
  const auto prepare = [&] {
    hot.clear();
    for (const GasColumn& column : columns) {
      hot.push_back(*HotColumn::make(column, wavelengths));
      sum += hot.back().at_near_end().emitted_w_m2_sr_um[0];
    }
  };
  prepare();
  plain(false);
  const auto air = AirBeforeColumns::make(amounts, wavelengths);
  if (!air.ok()) return;
  const double plain_alone_s = least_s(3, [&] { plain(false); }),
               plain_behind_s = least_s(3, [&] { plain(true); }), alone_s = least_s(5, prepare),
               air_s =
                   least_s(5, [&] { sum += AirBeforeColumns::make(amounts, wavelengths).ok(); }),
               behind_s = least_s(5, [&] {
                 for (const HotColumn& one : hot) sum += one.behind(*air).emitted_w_m2_sr_um[0];
               });
  std::size_t layers = 0;
  for (const GasColumn& column : columns) layers += column.size();
  const auto n = static_cast<double>(columns.size());
  std::printf("%g,%zu,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f\n", step, columns.size(),
              static_cast<double>(layers) / n, 1e6 * alone_s / n, 1e6 * plain_alone_s / n,
              plain_alone_s / alone_s, 1e6 * behind_s / n, 1e6 * plain_behind_s / n,
              plain_behind_s / behind_s, 1e6 * air_s);
  if (!(sum > 0)) std::printf("no light\n");
}

int run(int across) {
  absl::StatusOr<GeneratedPlume> made = absl::UnknownError("");
  const double generate_s = least_s(3, [&] { made = generate_funnel_plume(funnel()); });
  if (!made.ok()) return 1;
  const auto field = plume_of(made->volume, made->grids);
  if (!field.ok()) return 1;
  const Vec<Body> to = normalized(Vec<Body>{0.3, -0.9, -0.3});
  const GasWindow w = gas_window(**field, to);
  std::vector<PlumeRay> rays;
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < across; ++j)
      rays.push_back({w.center + ((2 * i + 1.0) / across - 1) * w.half_width_m * w.right +
                          ((2 * j + 1.0) / across - 1) * w.half_height_m * w.up + w.front_m * to,
                      to, 0, w.back_m - w.front_m});
  MarchCounts counts;
  std::size_t met = 0;
  const double march_s = least_s(5, [&] {
    counts = {};
    met = 0;
    for (const PlumeRay& ray : rays)
      met += march(**field, ray, view_steps(), &counts).empty() ? 0 : 1;
  });
  std::printf("generate_s,march_us_per_ray,march_ns_per_cell\n%.4f,%.2f,%.1f\n", generate_s,
              1e6 * march_s / static_cast<double>(met),
              1e9 * march_s / static_cast<double>(counts.cells));
  std::vector<double> um;
  for (std::size_t b = kGasBandCount; b-- > 0;)
    if (const double x = gas_band_lambda_um(b); (x > 3 && x < 5) || (x > 8 && x < 12))
      um.push_back(x);
  const auto wavelengths = GasWavelengths::make(um);
  if (!wavelengths.ok()) return 1;
  const AbsorberAmounts amounts =
      Atmosphere::make({afgl_profile(AfglProfile::kMidlatitudeSummer), {}})
          ->amounts(level_path(10, 5000));

  std::printf(
      "temperature_step,columns,layers_per_column,near_end_us,formulas_us,ratio,background_air_us,"
      "formulas_us,ratio,air_once_us\n");
  for (const double step : {0.06, 0.01, 0.003}) {
    SegmentSteps steps;
    steps.temperature_step = step;
    std::vector<GasColumn> columns;
    for (const PlumeRay& ray : rays)
      if (GasColumn column = march(**field, ray, steps); !column.empty())
        columns.push_back(std::move(column));
    report(step, columns, *wavelengths, amounts);
  }
  return 0;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) { return irsig::run(argc > 1 ? std::atoi(argv[1]) : 12); }
