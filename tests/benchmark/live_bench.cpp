// Rate and errors of the live view's path.
//
//   live_bench SWEEP [FRAMES] [SAMPLES] [WIDTHxHEIGHT] [THREADS] [CONDITION] [BAND] [ISA]
//
// Flies once around the target while it comes nearer and climbs; prints times of frames, of tables,
// and errors of one frame against the estimator of stored images by class.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include "core/base/check.h"
#include "live/frame.h"
#include "live/place_ahead.h"
#include "planning/load_sweep.h"

namespace irsig {
namespace {

using Clock = std::chrono::steady_clock;
double since_s(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Returns the camera of the first viewpoint: the sweep's own field of view, or one that the target
// fills.
LiveCamera start_camera(const LiveSweep& sweep) {
  const schema::Viewpoint& v = sweep.resolved().viewpoint(0);
  LiveCamera out;
  out.azimuth_deg = v.aspect_azimuth_deg();
  out.elevation_deg = v.aspect_elevation_deg();
  out.range_m = v.range_m();
  out.field_of_view_deg = std::min(
      60.0, 2.6 * std::atan(sweep.simulator().target().radius_m / v.range_m()) * 180 / 3.14159265);
  if (const schema::Image& image = sweep.resolved().sweep().image(); image.kind() == "camera")
    out.field_of_view_deg = image.field_of_view_deg();
  out.look_at_m = sweep.simulator().target().centre;
  return out;
}

// Returns the relative error that 93 % of the pixels of each class without hot gas keep, as a
// session learns it, and at least the 0.2 % that a session states.
std::map<int, double> errors_without_gas(const LiveFrame& frame, const LayerImage& stored) {
  std::map<int, std::vector<double>> off;
  for (std::size_t i = 0; i < stored.value.size(); ++i)
    if (frame.edge[i] == 0 && !(frame.gas_error[i] > 0))
      off[frame.met[i]].push_back(
          std::abs(static_cast<double>(frame.radiance_w_m2_sr[i] / stored.value[i]) - 1));
  std::map<int, double> out;
  for (auto& [met, of] : off) {
    const auto at =
        of.begin() + static_cast<std::ptrdiff_t>(0.93 * static_cast<double>(of.size() - 1));
    std::nth_element(of.begin(), at, of.end());
    out[met] = std::max(0.002, *at);
  }
  return out;
}

// Prints the errors of pixels that show hot gas: the fraction of those that are within the error of
// their class, what the gas states and the estimator's noise; then the same of pixels in which the
// gas itself states more than 0.2 %.
void print_gas(const LiveFrame& frame, const LayerImage& stored) {
  constexpr double kUncertain = 0.002;
  auto of_class = errors_without_gas(frame, stored);
  double gas = 0, held = 0, strong = 0, strong_held = 0, squares = 0;
  std::vector<double> stated;
  for (std::size_t i = 0; i < stored.value.size(); ++i) {
    if (!(frame.gas_error[i] > 0) || frame.edge[i] != 0) continue;
    const double is = static_cast<double>(stored.value[i]),
                 off = std::abs(static_cast<double>(frame.radiance_w_m2_sr[i]) - is),
                 own = static_cast<double>(frame.gas_error[i]);
    const bool holds =
        off <= std::hypot(static_cast<double>(frame.spread[i]), of_class[frame.met[i]] * is,
                          1.645 * static_cast<double>(stored.stderr_[i]));
    ++gas;
    held += holds ? 1 : 0;
    squares += off * off / (is * is);
    stated.push_back(own / is);
    if (own < kUncertain * is) continue;
    ++strong;
    strong_held += holds ? 1 : 0;
  }
  if (gas == 0) return;
  std::sort(stated.begin(), stated.end());
  std::printf(
      "gas        %7.0f pixels  rms %.3f %%  held %.1f %%  stated %.3f %% (median) %.2f %% (95th); "
      "%.0f uncertain by 0.2 %%: held %.1f %%\n",
      gas, 100 * std::sqrt(squares / gas), 100 * held / gas, 100 * stated[stated.size() / 2],
      100 * stated[stated.size() * 95 / 100], strong,
      strong > 0 ? 100 * strong_held / strong : 100.0);
}

int fly(int argc, char** argv) {
  const auto number = [&](int i, int otherwise) {
    return argc > i ? std::atoi(argv[i]) : otherwise;
  };
  if (argc > 8) IRSIG_CHECK(pin_isa(argv[8]).ok());
  auto begin = Clock::now();
  auto loaded = load_sweep(argv[1], {});
  if (!loaded.ok()) {
    std::fprintf(stderr, "%s\n", std::string(loaded.status().message()).c_str());
    return 2;
  }
  IRSIG_CHECK(have_temperatures(*loaded).ok());
  std::printf("sweep read in %.2f s\n", since_s(begin));
  begin = Clock::now();
  auto sweep = LiveSweep::make(loaded->resolved, loaded->assets, loaded->heat);
  IRSIG_CHECK(sweep.ok());
  std::printf("scene built in %.2f s\n", since_s(begin));
  const int frames = number(2, 100), samples = number(3, 2);
  LiveCamera camera = start_camera(**sweep);
  if (argc > 4) std::sscanf(argv[4], "%ux%u", &camera.width_px, &camera.height_px);
  const LiveChoice choice{
      static_cast<std::uint32_t>(number(6, 0)), static_cast<std::uint32_t>(number(7, 0)), {}};
  begin = Clock::now();
  auto lights = PlaceLights::make(*sweep, nullptr, choice, camera.viewpoint());
  if (!lights.ok()) std::printf("%s\n", std::string(lights.status().message()).c_str());
  IRSIG_CHECK(lights.ok());
  std::printf("tables begun in %.3f s\n", since_s(begin));
  begin = Clock::now();
  IRSIG_CHECK((*lights)->at(camera.viewpoint()).ok());
  std::printf("tables of one place: %.1f ms\n", 1e3 * since_s(begin));
  PlaceGrid grid(**lights);
  TileThreads threads(static_cast<std::uint32_t>(number(5, 2)));
  begin = Clock::now();
  std::unique_ptr<const LandRays> land;
  if ((*sweep)->land() != nullptr) {
    auto rays = LandRays::make(*(*sweep)->land(), (*lights)->land_bend_per_m(camera.viewpoint()));
    IRSIG_CHECK(rays.ok());
    land = *std::move(rays);
    std::printf("land built in %.2f s\n", since_s(begin));
  }
  FrameTracer tracer(**sweep, land.get(), **lights, grid, threads);
  begin = Clock::now();
  IRSIG_CHECK(tracer.draw(camera, static_cast<std::uint32_t>(samples), LiveLight::kTotal).ok());
  std::printf("first frame: %.1f ms\n", 1e3 * since_s(begin));

  auto request = (*sweep)->request(choice.condition, choice.band, camera);
  IRSIG_CHECK(request.ok());
  request->image->samples = 64;
  request->accuracy = {};
  request->accuracy.samples_per_replicate = 64;
  request->effects = {};
  begin = Clock::now();
  const auto planned = (*sweep)->simulator().prepare(*request);
  IRSIG_CHECK(planned.ok());
  std::printf("estimator prepared in %.3f s\n", since_s(begin));
  begin = Clock::now();
  const auto truth = (*sweep)->simulator().measure(*request, *planned);
  IRSIG_CHECK(truth.ok());
  std::printf("estimator, 64 samples: %.3f s\n", since_s(begin));
  const auto frame = tracer.draw(camera, static_cast<std::uint32_t>(samples), LiveLight::kTotal);
  const LayerImage& stored = truth->row.front().layer.front();
  struct Sum {
    double n = 0, squares = 0, difference = 0, noise = 0, mean = 0;
    std::vector<double> all;
  };
  std::map<int, Sum> by_class;
  Sum interior;
  double edges = 0;
  const std::size_t pixels = stored.value.size();
  for (std::size_t i = 0; i < pixels; ++i) {
    if (frame->edge[i]) {
      ++edges;
      continue;
    }
    const double is = static_cast<double>(stored.value[i]),
                 difference = (static_cast<double>(frame->radiance_w_m2_sr[i]) - is) / is;
    for (Sum* sum : {&by_class[frame->met[i]], &interior}) {
      ++sum->n;
      sum->squares += difference * difference;
      sum->difference += difference;
      sum->mean += is;
      sum->noise += std::pow(static_cast<double>(stored.stderr_[i]) / is, 2);
      sum->all.push_back(std::abs(difference));
    }
  }
  const auto print = [](const std::string& name, Sum& sum) {
    std::sort(sum.all.begin(), sum.all.end());
    std::printf(
        "%-10s %7.0f pixels  mean %.4g  rms %.3f %%  bias %+.3f %%  99th %.3f %%  noise %.3f %%\n",
        name.c_str(), sum.n, sum.mean / sum.n, 100 * std::sqrt(sum.squares / sum.n),
        100 * sum.difference / sum.n, 100 * sum.all[static_cast<std::size_t>(0.99 * (sum.n - 1))],
        100 * std::sqrt(sum.noise / sum.n));
  };
  for (auto& [met, sum] : by_class) print("class " + std::to_string(met), sum);
  if (interior.n > 0) print("interior", interior);
  print_gas(*frame, stored);
  std::printf("edges: %.1f %%\n", 100 * edges / static_cast<double>(pixels));

  std::vector<double> ms;
  const std::clock_t cpu_begin = std::clock();
  const LiveCamera first = camera;
  PlaceAhead ahead(grid);
  for (int i = 0; i < frames; ++i) {
    camera.azimuth_deg = std::fmod(first.azimuth_deg + 0.36 * i, 360.0);
    camera.elevation_deg = first.elevation_deg + 8 * std::sin(0.01 * i) * std::sin(0.01 * i);
    camera.range_m = first.range_m * (1 - 0.5 * std::sin(3.1 * i / frames));
    ahead.moved(camera.viewpoint());
    begin = Clock::now();
    const auto drawn = tracer.draw(camera, static_cast<std::uint32_t>(samples), LiveLight::kTotal);
    if (!drawn.ok()) std::printf("%s\n", std::string(drawn.status().message()).c_str());
    ms.push_back(1e3 * since_s(begin));
  }
  std::vector<double> sorted = ms;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double f) {
    return sorted[static_cast<std::size_t>(f * static_cast<double>(sorted.size() - 1))];
  };
  std::printf(
      "%zu frames: median %.1f ms (%.1f/s), 95th percentile %.1f ms (%.1f/s), most %.1f ms; CPU "
      "%.1f ms a frame; %zu nodes\n",
      ms.size(), at(0.5), 1e3 / at(0.5), at(0.95), 1e3 / at(0.95), at(1),
      1e3 * static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC /
          static_cast<double>(ms.size()),
      grid.nodes());
  if (std::FILE* status = std::fopen("/proc/self/status", "r")) {
    char line[256];
    while (std::fgets(line, sizeof line, status) != nullptr)
      if (std::string(line).starts_with("VmHWM")) std::printf("%s", line);
    std::fclose(status);
  }
  return 0;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr,
                 "usage: live_bench SWEEP [FRAMES] [SAMPLES] [WIDTHxHEIGHT] [THREADS] [CONDITION] "
                 "[BAND] [ISA]\n");
    return 2;
  }
  return irsig::fly(argc, argv);
}
