// Rationale: what rows say of hot gas beside its light: the area where it is thick, and what its
// voxels cannot say.
// Expected: a slab's area is all of it below its optical depth and nothing above; a sphere's is
// that of the radius at which a column has the threshold. A field at half its resolution holds the
// same gas; what that changes of a row is about as much as the row is off from one of fine voxels.
// Source: geometry; column spectra of core/gas (tests/physics/gas_test.cpp).
#include <cmath>
#include <numbers>

#include "core/gas/gas_spectrum.h"
#include "core/hot_gas/column_spectra.h"
#include "core/hot_gas/gas_on_view.h"
#include "core/plume/generate_plume.h"
#include "core/plume/march.h"
#include "core/plume/plume_field.h"
#include "tests/physics/plume_fixture.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

std::shared_ptr<const PlumeField> body(UniformPlume spec, PlumeInterpolation interpolation) {
  spec.temperature_k = 700;
  spec.co2 = 0.07;
  spec.h2o = 0.06;
  spec.soot = 1e-7;
  auto made = generate_uniform_plume(spec);
  EXPECT_TRUE(made.ok()) << made.status();
  made->grids.interpolation = interpolation;
  made->grids.position_m = {10, 0, 0};
  auto field = plume_of(made->volume, made->grids);
  EXPECT_TRUE(field.ok()) << field.status();
  return *field;
}
std::shared_ptr<const PlumeField> slab() {
  return body({.kind = "slab", .length_m = 1, .width_m = 4, .height_m = 4, .voxel_m = 0.25},
              PlumeInterpolation::kConstant);
}
std::shared_ptr<const PlumeField> sphere(double voxel_m) {
  return body({.kind = "sphere", .radius_m = 1, .voxel_m = voxel_m}, PlumeInterpolation::kLinear);
}

std::unique_ptr<Simulator> small_disk() {
  SceneSpec scene = scene_of(generated("disk", 20, 0.01), grey(1), mwir());
  scene.band.push_back({"LWIR", 8, 12, 0.25, {}});
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  return simulator_of(scene);
}

// Returns the radiance in each band along the line of sight from ahead at this distance from the
// axis.
std::vector<double> optical_depth(const Simulator& simulator, const PlumeField& field,
                                  double radius_m) {
  std::vector<double> um;
  for (const BandGrid& grid : simulator.band_grids())
    um.insert(um.end(), grid.node_um.begin(), grid.node_um.end());
  const auto wavelengths = GasWavelengths::make(um);
  const GasColumn column = march(field, {{30, radius_m, 0}, {-1, 0, 0}, 0, 40}, view_steps());
  std::vector<double> out(simulator.band_grids().size(), 0.0);
  if (column.empty()) return out;
  const auto hot = HotColumn::make(column, *wavelengths);
  EXPECT_TRUE(hot.ok()) << hot.status();
  const std::vector<double> absorbed = hot->at_near_end().absorbed;
  std::size_t node = 0;
  for (std::size_t b = 0; b < out.size(); ++b) {
    double sum = 0, width = 0;
    for (const double w : simulator.band_grids()[b].band_weight) {
      sum += w * absorbed[node++];
      width += w;
    }
    out[b] = -std::log1p(-sum / width);
  }
  return out;
}

std::vector<SignatureResult> rows_of(const Simulator& simulator,
                                     std::shared_ptr<const PlumeField> field, double threshold) {
  ViewRequest r = request(simulator, 0, 0, 1e5, {300});
  r.condition[0].gas = std::move(field);
  r.plume_area_optical_depth = threshold;
  r.accuracy.samples_per_replicate = 512;
  auto view = simulator.simulate(r);
  EXPECT_TRUE(view.ok()) << view.status();
  return std::move(view->row);
}

TEST(PlumeArea, OfASlabAllOrNothing) {
  const auto simulator = small_disk();
  const auto field = slab();
  const std::vector<double> depth = optical_depth(*simulator, *field, 0.1);
  for (std::size_t b = 0; b < 2; ++b) {
    const SignatureResult below = rows_of(*simulator, field, 0.98 * depth[b])[b];
    // Perspective and the slab's sides: 1e5 m away.
    EXPECT_NEAR(below.plume_area_m2.value, 16, 4 * below.plume_area_m2.stderr_ + 0.005);
    EXPECT_LT(below.plume_area_m2.stderr_, 0.05);
    EXPECT_EQ(rows_of(*simulator, field, 1.02 * depth[b])[b].plume_area_m2.value, 0);
  }
}

TEST(PlumeArea, OfASphereThatOfTheRadiusOfTheThreshold) {
  const auto simulator = small_disk();
  const auto field = sphere(0.1);
  const std::vector<double> most = optical_depth(*simulator, *field, 0);
  for (std::size_t b = 0; b < 2; ++b)
    for (const double share : {0.3, 0.6, 0.9}) {
      double low_m = 0, high_m = 1.3;
      for (int step = 0; step < 12; ++step) {
        const double middle_m = 0.5 * (low_m + high_m);
        (optical_depth(*simulator, *field, middle_m)[b] >= share * most[b] ? low_m : high_m) =
            middle_m;
      }
      const SignatureResult row = rows_of(*simulator, field, share * most[b])[b];
      const double expected = std::numbers::pi * low_m * low_m;
      std::printf("band %zu, %.2g of an optical depth of %.3g: %.4g +- %.2g m2, expected %.4g\n", b,
                  share, most[b], row.plume_area_m2.value, row.plume_area_m2.stderr_, expected);
      // Voxels are no sphere; the optical depth of a ray is known to some 0.5 %, and rises by less
      // than the area falls, but for its top.
      EXPECT_NEAR(row.plume_area_m2.value, expected,
                  4 * row.plume_area_m2.stderr_ + (share < 0.8 ? 0.02 : 0.06) * expected);
    }
}

TEST(PlumeHalf, HoldsTheSameGas) {
  for (const PlumeInterpolation how : {PlumeInterpolation::kLinear, PlumeInterpolation::kConstant})
    for (const int first : {0, -5, 3}) {
      // Hot and cold, dense and thin, with holes; edges that no coarse voxel shares.
      const auto field = plume_fixture::field_of(
          plume_fixture::volume_of(
              {first, first, first}, {first + 12, first + 9, first + 16}, plume_fixture::cubes(0.5),
              [](int i, int j, int k) {
                const int n = 7 * i + 13 * j + 29 * k;
                if (n % 5 == 0) return plume_fixture::Gas{};
                return plume_fixture::Gas{400.0 + 37 * (((n % 11) + 11) % 11),
                                          0.01 * (1 + ((n % 7) + 7) % 7), 0.05};
              }),
          how);
      const auto& half = field->at_half_resolution();
      ASSERT_TRUE(half.ok()) << half.status();
      EXPECT_EQ(&*half, &*field->at_half_resolution());
      EXPECT_EQ((*half)->interpolation(), how);
      EXPECT_NEAR((*half)->voxel_volume_m3() / field->voxel_volume_m3(), 8, 1e-9);
      EXPECT_LT((*half)->report().gas_voxels,
                0.3 * static_cast<double>(field->report().gas_voxels));
      for (const std::size_t species : {0U, 1U})
        EXPECT_NEAR((*half)->report().amount[species] / field->report().amount[species], 1, 1e-6);
      // Places and heat are equal: on parallel rays whose cells lie in those of both.
      const auto heat = [&](const PlumeField& of) {
        std::array<double, 3> sum{};  // of T x gas, and its middle
        for (int i = 0; i < 144; ++i)
          for (int j = 0; j < 152; ++j) {
            const double y = -7 + 0.125 * (i + 0.5), z = -7 + 0.125 * (j + 0.5);
            for (const GasSegment& s : march(of, {{-20, y, z}, {1, 0, 0}, 0, 60}, {})) {
              const double w = s.weight * s.temperature_k;
              sum[0] += w;
              sum[1] += w * y;
              sum[2] += w * z;
            }
          }
        return std::array{sum[0], sum[1] / sum[0], sum[2] / sum[0]};
      };
      const auto fine = heat(*field), coarse = heat(**half);
      EXPECT_NEAR(coarse[0] / fine[0], 1, 1e-6);
      EXPECT_NEAR(coarse[1], fine[1], 0.03);
      EXPECT_NEAR(coarse[2], fine[2], 0.03);
    }
}

TEST(PlumeHalf, OfAUniformBlockIsUniform) {
  VoxelVolume volume;
  volume.world_from_index = plume_fixture::cubes(1);
  volume.channel = {"temperature", "co2", "h2o"};
  volume.background = {0, 0, 0};
  VolumeWriter writer(volume);
  for (const int x : {0, 8})
    for (const int y : {0, 8})
      for (const int z : {0, 8}) writer.add_uniform({x, y, z}, {600, 0.1F, 0.05F});
  const auto field = plume_fixture::field_of(volume, PlumeInterpolation::kConstant);
  const auto& half = field->at_half_resolution();
  ASSERT_TRUE(half.ok()) << half.status();
  EXPECT_EQ((*half)->report().gas_voxels, 512U);
  EXPECT_LT((*half)->bytes(), field->bytes());
  EXPECT_NEAR((*half)->report().least_k, 600, 1e-3);
  const auto along = march(**half, {{-10, 10.3, 5}, {1, 0, 0}, 0, 60}, {});
  ASSERT_EQ(along.size(), 1U);
  EXPECT_NEAR(along[0].length_m(), 16, 1e-9);
  EXPECT_NEAR(along[0].mole_fraction(0), 0.1, 1e-6);
}

// Against voxels of a quarter of the edge.
TEST(PlumeHalf, SaysHowFarVoxelsAreOff) {
  const auto simulator = small_disk();
  const auto fine = rows_of(*simulator, sphere(0.05), 0.1);
  for (const double voxel_m : {0.2, 0.1}) {
    const auto rows = rows_of(*simulator, sphere(voxel_m), 0.1);
    for (std::size_t b = 0; b < 2; ++b) {
      const double off = std::abs(rows[b].plume_emitted_w_sr - fine[b].plume_emitted_w_sr);
      std::printf("voxels of %.2g m, band %zu: off by %.2g %%, stated %.2g %%\n", voxel_m, b,
                  100 * off / fine[b].plume_emitted_w_sr,
                  100 * rows[b].plume_voxel_error_w_sr / rows[b].plume_emitted_w_sr);
      EXPECT_LT(off, rows[b].plume_voxel_error_w_sr + 3 * rows[b].plume_w_sr.stderr_);
      // Twice the edge: 2.5 times as much where errors fall as h^1.8.
      EXPECT_GT(b == 0 ? off : 1, 0.2 * (b == 0 ? rows[b].plume_voxel_error_w_sr : 0));
      // Nothing lies between gas and sensor: the source has all of the gas's model error, too.
      EXPECT_GT(rows[b].plume_model_error_w_sr, 0.005 * rows[b].plume_emitted_w_sr);
      EXPECT_GE(rows[b].model_error_w_sr,
                0.99 * std::hypot(rows[b].plume_model_error_w_sr, rows[b].plume_voxel_error_w_sr));
      EXPECT_GE(rows[b].apparent_model_error_w_sr, 0.99 * rows[b].plume_voxel_error_w_sr);
    }
    EXPECT_GT(rows[0].plume_voxel_error_w_sr, 0);
  }
}

}  // namespace
}  // namespace irsig
