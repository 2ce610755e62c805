// CPU time of the air's spectra on one core, 650-3400 cm-1 in 275 bands.
// Prints CSV: what, steps of the path, best and median of 200 runs in ms.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/path_layers.h"

namespace {

using namespace irsig;

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

void report(const char* what, std::size_t steps, const std::function<double()>& run) {
  std::vector<double> ms;
  double sink = 0;
  for (int i = 0; i < 200; ++i) {
    const double start = cpu_ms();
    sink += run();
    ms.push_back(cpu_ms() - start);
  }
  std::ranges::sort(ms);
  std::printf("%s,%zu,%.3f,%.3f\n", what, steps, ms.front(), ms[ms.size() / 2]);
  if (sink < 0) std::puts("");
}

}  // namespace

int main() {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}};
  spec.aerosol.kind = AerosolKind::kMaritime;
  spec.aerosol.visibility_m = 23e3;
  const Atmosphere air = *Atmosphere::make(spec);
  spec.aerosol.kind = AerosolKind::kNone;
  const Atmosphere clean = *Atmosphere::make(spec);

  PathLight sunlight;
  sunlight.sun = SunPlace{45, 90};
  const LightPath high = look(air.profile(), 20e3, 120, kFar);
  const LightPath up = look(air.profile(), 10, 60, kFar);
  const LightPath low = *look_between(air.profile(), 20, 10, 15e3);
  const auto total = [](const PathRadiance& r) { return r.total_w_m2_sr_um[100]; };

  std::puts("what,steps,best_ms,median_ms");
  report("20 km to the sea, clean", high.step_m.size(),
         [&] { return total(clean.radiance(high)); });
  report("20 km to the sea, aerosol", high.step_m.size(),
         [&] { return total(air.radiance(high)); });
  report("20 km to the sea, aerosol, sun", high.step_m.size(),
         [&] { return total(air.radiance(high, sunlight)); });
  report("ground to space, aerosol", up.step_m.size(), [&] { return total(air.radiance(up)); });
  report("15 km over the sea, aerosol", low.step_m.size(),
         [&] { return total(air.radiance(low)); });
  report("transmittance of given amounts", 1,
         [&, amounts = air.amounts(up)] { return transmittance(amounts)[100]; });
  // Only the bands of 8-12 um, as most sweeps have them.
  std::vector<unsigned char> wanted(kAirBandCount, 0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    wanted[b] = air_band_lambda_um(b) >= 8 && air_band_lambda_um(b) <= 12;
  }
  const BandChoice window(wanted);
  const AbsorberAmounts near = air.amounts(low, window);
  const PathLayers layers(air, up, window);
  report("8-12 um: transmittance of given amounts", 1,
         [&] { return transmittance(near, window)[20]; });
  report("8-12 um: ground to space in layers", up.step_m.size(),
         [&] { return PathLayers(air, up, window).thermal_w_m2_sr_um[20]; });
  report("8-12 um: that behind near air", up.step_m.size(),
         [&, through = transmittance(near, window)] {
           return layers.behind(near, through).thermal_w_m2_sr_um[20];
         });
  report("tracing of a ray to space", up.step_m.size(),
         [&] { return look(air.profile(), 10, 60, kFar).bending_deg + 1; });
}
