// CPU time of surface temperatures on one core: elements of a ship's side and decks over 48 hours
// of hourly weather and sunlight of their own, from a stated start.
//   heat_bench [elements, 20000 and 200000]
// Prints CSV: wall, elements, hours, CPU time in s, elements at each level, median, 95 % and
// largest stated error in K, largest closure in W/m2.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <vector>

#include "core/base/constants.h"
#include "core/thermal/heat_solver.h"

namespace irsig {
namespace {

constexpr std::size_t kHours = 48;

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Returns a fraction in [0, 1) that follows from the number, the same on every machine.
double share(std::size_t n) { return std::fmod(static_cast<double>(n) * 0.6180339887498949, 1.0); }

struct Wall {
  const char* name;
  std::vector<Layer> layers;
  InnerSide inner;
};

void run(const Wall& wall, std::size_t elements) {
  HeatRequest request{};
  request.layers = wall.layers;
  request.inner_side = wall.inner;
  for (std::size_t i = 0; i <= kHours; ++i) {
    request.knot_s.push_back(3600.0 * static_cast<double>(i));
    request.output_knot.push_back(i);
  }
  request.output_boundary = {0};
  request.outer.assign(elements, {0.9, kMowitt});
  if (wall.inner == InnerSide::kOpen) request.inner.assign(elements, {0.9, tarp_natural(0)});
  request.start = StatedStart{{290}, 0};
  request.accuracy.tolerance_k = 0.05;

  // Common weather, and each element's own sunlight: a plane that looks somewhere, shadows of
  // masts.
  std::vector<double> air_k, incoming_w_m2, forced_w_m2_k;
  std::vector<std::vector<float>> absorbed_w_m2(kHours + 1, std::vector<float>(elements));
  for (std::size_t i = 0; i <= kHours; ++i) {
    const double hour = static_cast<double>(i), angle = (hour - 15) * std::numbers::pi / 12;
    air_k.push_back(290 + 5 * std::cos(angle) + 1.5 * (share(7 * i) - 0.5));
    incoming_w_m2.push_back(0.8 * kStefanBoltzmannWM2K4 * std::pow(air_k.back(), 4));
    forced_w_m2_k.push_back(mowitt_forced_w_m2_k(8 * share(3 * i), WindSide::kWindward));
    for (std::size_t e = 0; e < elements; ++e) {
      const double looks = 2 * share(e) - 1;  // east to west
      const double sun = std::sin((hour - 6) * std::numbers::pi / 12 + looks);
      const bool shadow = share(e + 31 * i) < 0.1;
      absorbed_w_m2[i][e] = static_cast<float>(sun > 0 ? 700 * sun * (shadow ? 0.1 : 1.0) : 0.0);
    }
  }
  const ExposureOf exposure_of = [&](std::size_t interval, std::span<const std::uint32_t> element,
                                     const Exposure& out) {
    const auto fill = [&](const FaceExposure& face, std::size_t knot, bool sun) {
      for (std::size_t j = 0; j < element.size(); ++j) {
        face.absorbed_w_m2[j] = sun ? static_cast<double>(absorbed_w_m2[knot][element[j]]) : 0.0;
      }
      std::ranges::fill(face.incoming_w_m2, incoming_w_m2[knot]);
      std::ranges::fill(face.fluid_k, sun ? air_k[knot] : 295.0);
      std::ranges::fill(face.forced_h_w_m2_k, sun ? forced_w_m2_k[knot] : 8.0);
    };
    fill(out.outer_begin, interval, true);
    fill(out.outer_end, interval + 1, true);
    fill(out.inner_begin, interval, false);
    fill(out.inner_end, interval + 1, false);
  };

  const double start = cpu_s();
  const auto result = solve_heat(request, exposure_of);
  const double spent = cpu_s() - start;
  if (!result.ok()) {
    std::printf("%s\n", std::string(result.status().message()).c_str());
    std::exit(1);
  }
  std::vector<double> error = result->error_k;
  std::ranges::sort(error);
  std::printf("%s,%zu,%zu,%.2f,", wall.name, elements, kHours, spent);
  for (int level = 1; level <= request.accuracy.max_level; ++level) {
    std::printf("%td%s", std::ranges::count(result->level, level),
                level < request.accuracy.max_level ? "/" : ",");
  }
  std::printf("%.2g,%.2g,%.2g,%.2g\n", error[error.size() / 2], error[error.size() * 19 / 20],
              error.back(), std::ranges::max(result->closure_w_m2));
  std::fflush(stdout);
}

}  // namespace
}  // namespace irsig

int main(int count, char** value) {
  using namespace irsig;
  const Layer paint{0.0003, 0.2, 1400, 1500}, steel{0.008, 50, 7850, 460},
      wool{0.08, 0.04, 60, 840}, lining{0.01, 0.15, 600, 1700};
  const std::vector<Wall> walls = {
      {"side of 5 layers", {paint, steel, wool, lining, paint}, InnerSide::kAir},
      {"painted plate; air", {paint, steel}, InnerSide::kAir},
      {"sheet; two open faces", {paint, {0.002, 160, 2700, 900}, paint}, InnerSide::kOpen},
      {"concrete 0.5 m", {{0.5, 1.4, 2300, 880}}, InnerSide::kAdiabatic}};
  std::puts(
      "wall,elements,hours,cpu_s,elements_at_level,median_error_k,p95_error_k,max_error_k,closure_"
      "w_m2");
  if (count > 1) {
    for (const Wall& wall : walls) run(wall, static_cast<std::size_t>(std::atoll(value[1])));
    return 0;
  }
  for (const Wall& wall : walls) run(wall, 20000);
  run(walls[0], 200000);
}
