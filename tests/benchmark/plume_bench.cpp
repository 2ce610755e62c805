// CPU time and memory of a plume of 512 x 128 x 128 voxels on one core: reading it, and marching
// rays through it from the side and aslant.
//   plume_bench [rays across, 100]
// Prints CSV: first the file, then the same gas at half its resolution, then a line for each
// interpolation and step of temperature: rays that meet gas, CPU time of a ray and of a cell, cells
// and segments of a ray, and the relative error of the sum of all rays' grey radiance at 4.3 um
// against a step of 0.002, with the largest of a ray (of the largest radiance) and the root mean
// square of errors over stated errors.
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "core/plume/gas_light.h"
#include "core/plume/march.h"
#include "core/plume/plume_field.h"
#include "core/plume/plume_silhouette.h"
#include "core/plume/vdb_subprocess.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

double cpu_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
double children_cpu_s() {
  rusage use{};
  getrusage(RUSAGE_CHILDREN, &use);
  return static_cast<double>(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

// A bent cone of gas with eddies, 512 x 128 x 128 voxels of 0.1 m, about a third of them filled.
VoxelVolume eddies() {
  VoxelVolume out;
  out.world_from_index = {0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0};
  out.channel = {"temperature", "co2", "h2o", "co", "soot"};
  out.background.assign(5, 0);
  VolumeWriter writer(out);
  std::vector<float> value(512 * 5);
  for (int x = 0; x < 512; x += 8)
    for (int y = 0; y < 128; y += 8)
      for (int z = 0; z < 128; z += 8) {
        VoxelMask mask{};
        for (int v = 0; v < 512; ++v) {
          const double i = x + (v >> 6), j = y + (v >> 3 & 7) - 63.5, k = z + (v & 7);
          const double radius = 6 + 0.09 * i, height = 20 + 4 * std::sqrt(i);
          const double r2 = (j * j + (k - height) * (k - height)) / (radius * radius);
          const double eddy = 1 + 0.3 * std::sin(0.31 * i + 0.2 * j) * std::cos(0.27 * k - 0.1 * i);
          const double f = std::min(1.0, 3 * std::exp(-r2) * eddy * 6 / radius);
          if (f < 0.01) continue;
          mask[static_cast<std::size_t>(v >> 6)] |= std::uint64_t{1} << (v & 63);
          float* to = value.data() + 5 * v;
          const double gas[] = {288 + 362 * f, 0.06 * f, 0.055 * f, 0.0005 * f, 1e-8 * f};
          for (int c = 0; c < 5; ++c) to[c] = static_cast<float>(gas[c]);
        }
        writer.add({x, y, z}, std::vector<VoxelMask>(5, mask), value);
      }
  return out;
}

PlumeGrids grids(PlumeInterpolation interpolation) {
  PlumeGrids out;
  out.temperature = {"temperature", std::nullopt, "K"};
  out.pressure = {"", 101325.0, "Pa"};
  out.co2 = {"co2", std::nullopt, "1"};
  out.h2o = {"h2o", std::nullopt, "1"};
  out.co = {"co", std::nullopt, "1"};
  out.soot = {"soot", std::nullopt, "1"};
  out.interpolation = interpolation;
  return out;
}

std::vector<PlumeRay> rays_of(const PlumeField& field, int across) {
  std::vector<PlumeRay> out;
  for (const Vec<Body> to : {Vec<Body>{0, 1, 0}, normalized(Vec<Body>{1, 0.7, 0.2})}) {
    const GasWindow w = gas_window(field, to);
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < across; ++j)
        out.push_back({w.center + ((2 * i + 1.0) / across - 1) * w.half_width_m * w.right +
                           ((2 * j + 1.0) / across - 1) * w.half_height_m * w.up - 500.0 * to,
                       to, 0, 1000});
  }
  return out;
}

// tau of 1 to 3 through the plume's middle.
constexpr GreyAbsorption kGrey{{0.4, 0.1, 0.2, 1e6}};
double b_43(double t) { return planck_radiance_w_m2_sr_um(4.3, t); }

struct Shaded {
  double emitted = 0, stated = 0;
};
Shaded shade(const std::vector<GasSegment>& segments) {
  std::vector<double> depth, coarse_depth;
  std::vector<SegmentSource> source, coarse_source;
  for (const GasSegment& s : segments) {
    depth.push_back(kGrey.optical_depth(s));
    source.push_back(segment_source(s, b_43));
  }
  const std::vector<CoarseStep> coarse = coarser(segments);
  for (const CoarseStep& c : coarse) {
    coarse_depth.push_back(kGrey.optical_depth(c.segment));
    coarse_source.push_back(segment_source(c.segment, b_43));
  }
  return {light_through(depth, source).emitted,
          step_error(depth, source, coarse, coarse_depth, coarse_source)};
}

int run(int across) {
  const VoxelVolume volume = eddies();
  const auto file = write_vdb_apart(volume);
  if (!file.ok()) return std::fprintf(stderr, "%s\n", file.status().ToString().c_str()), 1;
  const double before = children_cpu_s(), own_before = cpu_s(CLOCK_PROCESS_CPUTIME_ID);
  const double wall_before = cpu_s(CLOCK_MONOTONIC);
  const auto linear = import_plume(*file, "eddies.vdb", grids(PlumeInterpolation::kLinear));
  if (!linear.ok()) return std::fprintf(stderr, "%s\n", linear.status().ToString().c_str()), 1;
  const double wall = cpu_s(CLOCK_MONOTONIC) - wall_before;
  std::printf("file_bytes,values_bytes,gas_voxels,field_bytes,reader_cpu_s,own_cpu_s,wall_s\n");
  std::printf("%zu,%zu,%llu,%zu,%.3f,%.3f,%.3f\n", file->size(), volume.value.size() * 4,
              static_cast<unsigned long long>((*linear)->report().gas_voxels), (*linear)->bytes(),
              children_cpu_s() - before, cpu_s(CLOCK_PROCESS_CPUTIME_ID) - own_before, wall);
  const double half_before = cpu_s(CLOCK_PROCESS_CPUTIME_ID);
  const auto& half = (*linear)->at_half_resolution();
  if (!half.ok()) return std::fprintf(stderr, "%s\n", half.status().ToString().c_str()), 1;
  std::printf("half_voxels,half_bytes,half_cpu_s\n%llu,%zu,%.3f\n",
              static_cast<unsigned long long>((*half)->report().gas_voxels), (*half)->bytes(),
              cpu_s(CLOCK_PROCESS_CPUTIME_ID) - half_before);

  std::printf(
      "interpolation,temperature_step,rays_in_gas,ns_per_ray,ns_per_cell,cells_per_ray,"
      "segments_per_ray,error_of_sum,largest_error,rms_error_of_stated\n");
  for (const PlumeInterpolation how :
       {PlumeInterpolation::kLinear, PlumeInterpolation::kConstant}) {
    const auto field = plume_of(volume, grids(how));
    if (!field.ok()) return 1;
    const std::vector<PlumeRay> rays = rays_of(**field, across);
    std::vector<double> best;
    for (const double step : {0.002, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32}) {
      SegmentSteps steps;
      steps.temperature_step = step;
      steps.grey = kGrey;
      MarchCounts counts;
      std::vector<std::vector<GasSegment>> out(rays.size());
      const double start = cpu_s(CLOCK_THREAD_CPUTIME_ID);
      for (std::size_t r = 0; r < rays.size(); ++r)
        out[r] = march(**field, rays[r], steps, &counts);
      const double took_s = cpu_s(CLOCK_THREAD_CPUTIME_ID) - start;
      std::size_t met = 0, segments = 0;
      double sum = 0, best_sum = 0, worst = 0, most = 0, squares = 0;
      std::vector<double> emitted, stated;
      for (std::size_t r = 0; r < rays.size(); ++r) {
        met += !out[r].empty();
        segments += out[r].size();
        const Shaded light = shade(out[r]);
        emitted.push_back(light.emitted);
        sum += light.emitted;
        stated.push_back(light.stated);
      }
      const bool reference = best.empty();
      if (reference) best = emitted;
      for (const double b : best) {
        best_sum += b;
        most = std::max(most, b);
      }
      // Errors are over the rays that count: where next to no gas is, they are those of rounding.
      std::size_t counted = 0;
      for (std::size_t r = 0; r < rays.size(); ++r) {
        worst = std::max(worst, std::abs(emitted[r] - best[r]));
        if (best[r] < 1e-3 * most || stated[r] < 1e-9 * best[r]) continue;
        squares += std::pow((emitted[r] - best[r]) / stated[r], 2);
        ++counted;
      }
      std::printf("%s,%g,%zu,%.0f,%.1f,%.1f,%.1f,%.1e,%.1e,%.2f\n",
                  how == PlumeInterpolation::kLinear ? "linear" : "constant", step, met,
                  1e9 * took_s / static_cast<double>(met),
                  1e9 * took_s / static_cast<double>(counts.cells),
                  static_cast<double>(counts.cells) / static_cast<double>(met),
                  static_cast<double>(segments) / static_cast<double>(met), sum / best_sum - 1,
                  reference ? 0 : worst / most,
                  reference ? 0 : std::sqrt(squares / static_cast<double>(counted)));
    }
  }
  return 0;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) { return irsig::run(argc > 1 ? std::atoi(argv[1]) : 100); }
