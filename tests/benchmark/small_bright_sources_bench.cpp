// Measures the cost of scenes with one small bright thing to 1 %, against the scene without it: CPU
// time of Simulator::simulate (plan and stored run; median of runs), and all rays.
//
//   build/release/bin/small_bright_sources_bench [RUNS]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "core/signature/simulator.h"
#include "verify/cases/small_bright_sources.h"

namespace {

using namespace irsig;

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Cost {
  ViewResult view;
  double ms = 0;
};

Cost cost_of(const RareLightScene& scene, int runs) {
  const auto simulator = Simulator::create(scene.scene);
  if (!simulator.ok()) {
    std::fprintf(stderr, "%s: %s\n", scene.name.c_str(),
                 std::string(simulator.status().message()).c_str());
    std::exit(1);
  }
  Cost out;
  std::vector<double> ms;
  for (int k = 0; k < runs; ++k) {
    const double start = cpu_s();
    auto view = (*simulator)->simulate(scene.request);
    ms.push_back(1e3 * (cpu_s() - start));
    if (!view.ok()) {
      std::fprintf(stderr, "%s: %s\n", scene.name.c_str(),
                   std::string(view.status().message()).c_str());
      std::exit(1);
    }
    out.view = *std::move(view);
  }
  std::nth_element(ms.begin(), ms.begin() + runs / 2, ms.end());
  out.ms = ms[static_cast<std::size_t>(runs / 2)];
  return out;
}

const char* name_of(StopReason reason) {
  switch (reason) {
    case StopReason::kTargetReached:
      return "accuracy_reached";
    case StopReason::kTargetMissed:
      return "accuracy_not_reached";
    case StopReason::kSampleLimit:
      return "sample_limit";
    default:
      return "other";
  }
}

void print(const RareLightScene& scene, const Cost& cost, const Cost& plain) {
  const SignatureResult& r = cost.view.row.front();
  const auto rays = [](const Cost& c) { return static_cast<double>(c.view.rays); };
  std::printf("%-46s %10.5g %8.3f %% %-14s %8llu %9.3g %9.2f %7.1f %7.1f\n", scene.name.c_str(),
              r.intensity_w_sr.value, 100 * r.numerical_error_w_sr / r.intensity_w_sr.value,
              name_of(r.stop_reason),
              static_cast<unsigned long long>(cost.view.samples_per_replicate), rays(cost), cost.ms,
              cost.ms / plain.ms, rays(cost) / rays(plain));
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  std::printf("%-46s %10s %10s %-14s %8s %9s %9s %7s %7s\n", "scene", "W/sr", "error",
              "why it stopped", "samples", "rays", "CPU ms", "x CPU", "x rays");
  for (const auto& [rare, plain] : small_bright_source_scenes()) {
    const Cost of_plain = cost_of(plain, runs);
    print(plain, of_plain, of_plain);
    print(rare, cost_of(rare, runs), of_plain);
  }
}
