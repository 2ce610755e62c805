// Rationale: rays that lie on what separates voxels, and gas at the ends of what there is, are
// where marches hang, skip or count twice. Expected: amounts from the definition of the field, to
// rounding. Source: sums by hand.
#include <gmock/gmock.h>

#include "core/spectral/planck.h"
#include "tests/physics/plume_fixture.h"

namespace irsig {
namespace {

using namespace plume_fixture;
using enum PlumeInterpolation;
constexpr double kHardPressurePa = 101325, kHardR = 8.31446261815324;

double amount(const std::vector<GasSegment>& segments) {
  double sum = 0;
  for (const GasSegment& s : segments) sum += s.amount[0];
  return sum;
}
// [mol/m3] of CO2 in a voxel.
double hard_density(const Gas& gas) {
  return gas.co2 * kHardPressurePa / (kHardR * gas.temperature_k);
}

const Gas kWarm{600, 0.1, 0.05};

// 16 x 8 x 8 voxels of 1 m: two blocks.
std::shared_ptr<const PlumeField> bar(PlumeInterpolation interpolation) {
  return field_of(volume_of({0, 0, 0}, {15, 7, 7}, cubes(1), [](int, int, int) { return kWarm; }),
                  interpolation);
}

TEST(PlumeHard, RayAlongAFace) {
  // kConstant: y = 3.5 is the face between voxels 3 and 4, of the upper; y = 7.5 and -0.5 are the
  // outermost faces.
  const auto along = [](PlumeInterpolation how, double y, double z, double x_step = 1) {
    return amount(march(*bar(how), {{x_step > 0 ? -5.0 : 25.0, y, z}, {x_step, 0, 0}, 0, 100}, {}));
  };
  const double whole = 16 * hard_density(kWarm);
  for (const double direction : {1.0, -1.0}) {
    EXPECT_NEAR(along(kConstant, 3.5, 3.5, direction), whole, 1e-6 * whole);
    EXPECT_NEAR(along(kConstant, 3.5, 2, direction), whole, 1e-6 * whole);
    EXPECT_NEAR(along(kConstant, -0.5, 2, direction), whole, 1e-6 * whole);
    EXPECT_EQ(along(kConstant, 7.5, 2, direction), 0);
    // kLinear is continuous: whole along centres, half between the last and nothing.
    EXPECT_NEAR(along(kLinear, 7, 3, direction), whole, 1e-6 * whole);
    EXPECT_NEAR(along(kLinear, 0, 0, direction), whole, 1e-6 * whole);
    EXPECT_NEAR(along(kLinear, 7.5, 3, direction), whole / 2, 1e-6 * whole);
    EXPECT_NEAR(along(kLinear, -1, 3, direction), 0, 1e-12 * whole);
  }
}

TEST(PlumeHard, RayThroughTheCornerOfATile) {
  // The corner at (7.5, 7.5, 7.5) of a uniform block, and the diagonal of it.
  VoxelVolume volume;
  volume.world_from_index = cubes(1);
  volume.channel = {"temperature", "co2", "h2o"};
  volume.background = {0, 0, 0};
  VolumeWriter writer(volume);
  writer.add_uniform({0, 0, 0}, {600, 0.1F, 0.05F});
  writer.add_uniform({8, 8, 8}, {600, 0.1F, 0.05F});
  writer.add_uniform({128, 128, 128}, {600, 0.1F, 0.05F});
  const double root3 = std::sqrt(3.0);
  for (const PlumeInterpolation how : {kConstant, kLinear}) {
    const auto field = field_of(volume, how);
    const Vec<Body> diagonal = normalized(Vec<Body>{1, 1, 1});
    const double whole = amount(march(*field, {{-3, -3, -3}, diagonal, 0, 1000}, {}));
    // 8 voxels each; linear: cubic ramps of length root3 at ends, joined where blocks touch: the
    // sum of (1 - s)^3 over a ramp is a quarter, of 1 - 3 s (1 - s) over the joint a half.
    const double n = hard_density(kWarm), joint = 0.5 * root3;
    const double expected =
        how == kConstant ? 24 * root3 * n : (3 * 7 * root3 + 4 * root3 / 4 + joint) * n;
    EXPECT_NEAR(whole, expected, 1e-6 * expected);
    // Past the corner where the first two touch, from outside to outside.
    const Vec<Body> past = normalized(Vec<Body>{1, -1, 0});
    const double touch = amount(march(*field, {{7.5 - 6, 7.5 + 6, 7.5}, past, 0, 1000}, {}));
    if (how == kConstant) {
      EXPECT_LT(touch, 1e-12);
    } else {
      EXPECT_GT(touch, 0);
    }
  }
}

TEST(PlumeHard, OneVoxel) {
  for (const PlumeInterpolation how : {kConstant, kLinear}) {
    const auto field = field_of(
        volume_of({3, 4, 5}, {3, 4, 5}, cubes(1), [](int, int, int) { return kWarm; }), how);
    // Through its centre along an axis: 1 m of it, or two ramps of 1 m.
    for (const Vec<Body> to : {Vec<Body>{1, 0, 0}, Vec<Body>{0, -1, 0}, Vec<Body>{0, 0, 1}}) {
      const auto segments = march(*field, {Vec<Body>{3, 4, 5} - 10.0 * to, to, 0, 20}, {});
      EXPECT_NEAR(amount(segments), hard_density(kWarm), 1e-6 * hard_density(kWarm));
      ASSERT_EQ(segments.size(), 1U);
      EXPECT_NEAR(segments[0].temperature_k, 600, 1e-9);
      EXPECT_NEAR(segments[0].temperature_spread_k, 0, 1e-4);
    }
    // Ends of the ray inside.
    EXPECT_NEAR(amount(march(*field, {{3, 4, 5}, {1, 0, 0}, 0, 20}, {})), hard_density(kWarm) / 2,
                1e-6 * hard_density(kWarm));
    EXPECT_EQ(amount(march(*field, {{3, 4, 5}, {1, 0, 0}, 20, 20}, {})), 0);
    EXPECT_EQ(amount(march(*field, {{3, 4, 5}, {1, 0, 0}, 2, 20}, {})), 0);
  }
}

// 1e9 voxels of nothing between two voxels, and far ones aside: few steps, both found.
TEST(PlumeHard, FarAwayVoxel) {
  VoxelVolume volume =
      volume_of({0, 0, 0}, {0, 0, 0}, cubes(0.001), [](int, int, int) { return kWarm; });
  const VoxelVolume one = volume;
  for (const std::array<std::int32_t, 3> origin :
       {std::array<std::int32_t, 3>{1'000'000'000, 0, 0}, {0, -800'000'000, 0}, {4096, 4096, 0}}) {
    volume.block.push_back({origin, VoxelBlock::Form::kPacked});
    volume.mask.insert(volume.mask.end(), one.mask.begin(), one.mask.end());
    volume.value.insert(volume.value.end(), one.value.begin(), one.value.end());
  }
  const auto field = field_of(volume, kLinear);
  MarchCounts counts;
  const auto segments = march(*field, {{-1, 0, 0}, {1, 0, 0}, 0, 2e6}, {}, &counts);
  ASSERT_EQ(segments.size(), 2U);
  EXPECT_NEAR(amount(segments), 0.002 * hard_density(kWarm), 1e-6 * hard_density(kWarm));
  EXPECT_LT(counts.skips + counts.cells, 200U);
  EXPECT_LT(field->bytes(), 200'000U);
}

// A hair of gas in front of a wall of it.
TEST(PlumeHard, ThinAndThickInOneRay) {
  const double thin = 1e-12, thick = 1e4, per_m = thick / (4 * hard_density({2000, 0.5, 0}));
  const double thin_x = thin / (per_m * 4) * kHardR * 300 / kHardPressurePa;
  const auto field = field_of(volume_of({0, -8, -8}, {23, 8, 8}, cubes(1),
                                        [&](int i, int, int) {
                                          if (i >= 4 && i < 12) return Gas{};
                                          if (i < 4) return Gas{300, thin_x, 0};
                                          return i >= 16 && i < 20 ? Gas{2000, 0.5, 0} : Gas{};
                                        }),
                              kConstant);
  const GreyAbsorption grey = grey_co2(per_m);
  const auto b = [](double t) { return planck_radiance_w_m2_sr_um(4.3, t); };
  const auto from_thin = march(*field, {{-5, 0, 0}, {1, 0, 0}, 0, 100}, {});
  ASSERT_EQ(from_thin.size(), 2U);
  EXPECT_NEAR(grey.optical_depth(from_thin[0]) / thin, 1, 1e-6);
  EXPECT_NEAR(grey.optical_depth(from_thin[1]) / thick, 1, 1e-6);
  const GasLight front = light(from_thin, grey, b, b(2000));
  EXPECT_NEAR(front.emitted / b(2000), 1, 1e-12);
  // Before a background as hot as the wall, all that is left is what the hair takes.
  EXPECT_NEAR(front.contrast / (thin * (b(300) - b(2000))), 1, 1e-6);
  const GasLight only = light({from_thin[0]}, grey, b);
  EXPECT_NEAR(only.emitted / (thin * b(300)), 1, 1e-6);
  EXPECT_NEAR(only.absorptance / thin, 1, 1e-6);
  const GasLight back = light(march(*field, {{30, 0, 0}, {-1, 0, 0}, 0, 100}, {}), grey, b);
  EXPECT_NEAR(back.emitted / b(2000), 1, 1e-12);
}

// 2000 K against a cold background, and gas as warm as what is behind it: through zero.
TEST(PlumeHard, ContrastThroughZero) {
  const auto b = [](double t) { return planck_band_radiance_w_m2_sr(3, 5, t); };
  for (const double tau : {1e-9, 1.0, 100.0}) {
    const auto contrast = [&](double t) {
      const double depth[] = {tau};
      const SegmentSource source[] = {{b(t), 0}};
      return light_through(depth, source, b(300)).contrast;
    };
    EXPECT_EQ(contrast(300), 0);
    EXPECT_GT(contrast(300.001), 0);
    EXPECT_LT(contrast(299.999), 0);
    EXPECT_NEAR(contrast(300.001) / -contrast(299.999), 1, 1e-4);
    EXPECT_NEAR(contrast(2000) / ((b(2000) - b(300)) * -std::expm1(-tau)), 1, 1e-12);
  }
}

// A lattice that is scaled differently along its axes, turned and sheared: lengths are the world's.
TEST(PlumeHard, AnyAffineLattice) {
  const std::array<double, 12> sheared{0.5, 0.1, 0, 3, 0.05, 0.2, 0, -2, 0, 0.03, 1.5, 7};
  const auto field = field_of(
      volume_of({-20, -20, -20}, {20, 20, 20}, sheared, [](int, int, int) { return kWarm; }),
      kConstant);
  // The ray goes from face to face along an edge of a voxel: 41 edges.
  const Vec<Body> edges[] = {{0.5, 0.05, 0}, {0.1, 0.2, 0.03}, {0, 0, 1.5}};
  for (const Vec<Body>& edge : edges) {
    const double expected = 41 * length(edge) * hard_density(kWarm);
    const Vec<Body> to = normalized(edge);
    const double got = amount(march(*field, {Vec<Body>{3, -2, 7} - 60.0 * to, to, 0, 1000}, {}));
    EXPECT_NEAR(got, expected, 1e-6 * expected);
  }
}

}  // namespace
}  // namespace irsig
