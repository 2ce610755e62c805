// The ship paper's comparison of its ray-facet tests on the whole ship (zhou2026, section 3.8,
// Figure 18), redone: the emitted intensity of the frigate seen from 5 km above, each wavelength by
// rays of its own, with RTM and IRTM in float and double, against exact arithmetic.
//   paper_ship_bench [triangles, 200000] [rays of each wavelength, 150000]
// The paper's tests are those of paper_ray_facet.h. A ray that meets no facet carries nothing, as
// in the paper. CSV: method, band, rays, rays whose facet differs from the exact one, and the
// largest and the mean deviation of the intensity over the band's 11 wavelengths. All methods and
// the exact one follow the same rays, so that a deviation is that of rays which went astray.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "core/scene/generate/generate_mesh.h"
#include "core/spectral/planck.h"
#include "tests/benchmark/paper_ray_facet.h"
#include "verify/watertight/hit_judge.h"

namespace irsig {
namespace {

using Ray = HitJudge::Ray;
using Hit = HitJudge::Hit;

constexpr double kSensor_m = 5000, kHotKelvin = 400, kEmissivity = 0.8;
constexpr std::size_t kWavelengths = 11;

struct ShipBand {
  const char* name;
  double lambda_min_um, lambda_max_um, wall_k;
};

// Makes rays from a point 5 km above (body z points down) to random points of the box's upper face.
std::vector<Ray> rays_from_above(const HitJudge& judge, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const Point3& half = judge.half_size();
  std::vector<Ray> out(count);
  for (Ray& ray : out) {
    ray.origin = {0, 0, -kSensor_m};
    const Point3 at{half[0] * unit(random), half[1] * unit(random), 0};
    for (std::size_t j = 0; j < 3; ++j)
      ray.direction[j] = static_cast<double>(static_cast<float>(at[j] - ray.origin[j]));
  }
  return out;
}

struct Tally {
  std::size_t rays = 0, other_facet = 0;
  std::array<double, kWavelengths> sum{}, exact{};

  void print(const char* method, const char* band) const {
    double largest = 0, mean = 0;
    for (std::size_t k = 0; k < kWavelengths; ++k) {
      const double off = std::abs(sum[k] / exact[k] - 1);
      largest = std::max(largest, off);
      mean += off / kWavelengths;
    }
    std::printf("%s,%s,%zu,%zu,%.6f,%.6f\n", method, band, rays, other_facet, largest, mean);
  }
};

void compare(const Mesh& mesh, const HitJudge& judge, const ShipBand& band, std::size_t rays) {
  const PaperTracer<float> single(judge.vertex(), judge.triangle(), 0);
  const PaperTracer<double> fine(judge.vertex(), judge.triangle(), 0);
  std::array<Tally, 4> tally{};
  for (std::size_t k = 0; k < kWavelengths; ++k) {
    const double lambda_um = band.lambda_min_um + (band.lambda_max_um - band.lambda_min_um) *
                                                      static_cast<double>(k) / (kWavelengths - 1);
    const double wall = kEmissivity * planck_radiance_w_m2_sr_um(lambda_um, band.wall_k),
                 hot = kEmissivity * planck_radiance_w_m2_sr_um(lambda_um, kHotKelvin);
    const auto radiance = [&](const Hit& hit) {
      if (!hit.met()) return 0.0;
      const std::string& group = mesh.group[mesh.triangle_group[hit.facet]];
      return group == "funnel_top" || group == "mast_hot" ? hot : wall;
    };
    for (const Ray& ray : rays_from_above(judge, rays, 20260227 + k)) {
      const Hit truth = judge.truth(ray);
      const double expected = radiance(truth);
      const std::array<Hit, 4> answer{single.nearest(ray.origin, ray.direction, PaperTest::kRtm),
                                      single.nearest(ray.origin, ray.direction, PaperTest::kIrtm),
                                      fine.nearest(ray.origin, ray.direction, PaperTest::kRtm),
                                      fine.nearest(ray.origin, ray.direction, PaperTest::kIrtm)};
      for (std::size_t m = 0; m < tally.size(); ++m) {
        ++tally[m].rays;
        tally[m].other_facet += answer[m].facet != truth.facet ? 1 : 0;
        tally[m].sum[k] += radiance(answer[m]);
        tally[m].exact[k] += expected;
      }
    }
  }
  constexpr std::array<const char*, 4> names{"rtm_float", "irtm_float", "rtm_double",
                                             "irtm_double"};
  for (std::size_t m = 0; m < tally.size(); ++m) tally[m].print(names[m], band.name);
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  using namespace irsig;
  const std::uint64_t triangles = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 200'000;
  const std::size_t rays = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 150'000;
  const Mesh mesh = generate_mesh({"frigate", triangles}).value();
  const HitJudge judge(mesh);
  std::printf("method,band,rays,other_facet,largest_deviation,mean_deviation\n");
  for (const ShipBand& band :
       {ShipBand{"spring 8.5-9.0", 8.5, 9.0, 300.15}, ShipBand{"winter 4.5-5.0", 4.5, 5.0, 293.15}})
    compare(mesh, judge, band, rays);
}
