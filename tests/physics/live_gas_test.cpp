// Rationale: frames show hot gas by weights of a few test gases, fitted to columns that were
// computed in full, along rays that are dense only where the light changes.
// Expected: emission, and the fraction that the gas takes of each kind of light behind it, are
// those of the column's own spectrum, within the stated error; gas is before a surface, behind it,
// or partly before it; its edges are as sharp as pixels; gas that no ray meets is flagged.
// Source: column spectra of core/hot_gas, summed over the band.
#include "live/live_gas.h"

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "core/atmosphere/atmosphere.h"
#include "core/hot_gas/gas_on_view.h"
#include "core/sources/view_sources.h"
#include "live/gas_rays.h"
#include "tests/physics/plume_view_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kRangeM = 100;

// A slab across the line of sight from ahead, 1 m thick.
std::shared_ptr<const PlumeField> slab_at(Vec<Body> middle, double side_m, double voxel_m) {
  UniformPlume spec;
  spec.kind = "slab";
  spec.length_m = 1;
  spec.width_m = spec.height_m = side_m;
  spec.temperature_k = kGasK;
  spec.co2 = 0.07;
  spec.h2o = 0.06;
  spec.soot = 1e-8;
  spec.voxel_m = voxel_m;
  auto made = generate_uniform_plume(spec);
  EXPECT_TRUE(made.ok()) << made.status();
  made->grids.interpolation = PlumeInterpolation::kConstant;
  made->grids.position_m = middle;
  auto field = plume_of(made->volume, made->grids);
  EXPECT_TRUE(field.ok()) << field.status();
  return *field;
}

// A sunlit place whose light differs from kind to kind: the sun shines below 3.6 um, a background
// around 4.4 um, another one elsewhere.
struct PlaceOfGas {
  std::vector<ConditionSpec> condition;
  std::unique_ptr<const ViewSources> sources;
  [[nodiscard]] const ConditionSources& light() const { return sources->wanted(0); }
};
PlaceOfGas place_of(const Simulator& simulator, const AbsorberAmounts* air = nullptr,
                    const AbsorberAmounts* overcast = nullptr) {
  PlaceOfGas out;
  ConditionSpec& c = out.condition.emplace_back();
  c.part_temperature_k = {320};
  c.sun = true;
  c.sun_scale = 1;
  c.sun_direction = {0, 0.6, -0.8};
  c.sun_cos_zenith = 0.8;
  c.sun_angular_radius_deg = 0.27;
  ViewEnvironment e;
  std::vector<double> hot, other;
  for (const double um : simulator.scene().axis.node_um()) {
    e.transmittance.push_back(um < 4 ? 0.9 : 0.3);
    e.path_radiance.push_back(0);
    e.sun.push_back(1);
    e.sun_apparent.push_back(um < 3.6 ? 1 : 1e-3);
    const bool in_band = um > 4.2 && um < 4.6;
    hot.push_back(in_band ? 1 : 1e-3);
    other.push_back(in_band ? 1e-3 : 1);
  }
  e.background_apparent = {hot, other};
  e.around = IncidentRadiance::of_spectra(e.background_apparent, e.background_apparent);
  if (air != nullptr) e.air = std::make_shared<const AbsorberAmounts>(*air);
  if (overcast != nullptr) {
    e.overcast_air = std::make_shared<const AbsorberAmounts>(*overcast);
    e.overcast_fraction = 0.4;
  }
  auto environments = std::make_shared<ViewEnvironments>();
  environments->condition = {e};
  const std::vector<std::uint32_t> wanted{0};
  out.sources = std::make_unique<const ViewSources>(
      SourceRequest{.condition = out.condition, .wanted = wanted, .parts = 1},
      EffectSet::everything(1, 1), environments, simulator.scene().axis.node_um());
  return out;
}

// Emission in the first band, then the fractions taken of surfaces', the sun's and the background's
// light.
using InBandGas = std::array<double, 4>;
InBandGas in_first_band(const Simulator& simulator, const ConditionSources& light,
                        std::size_t background, const ColumnLight& column,
                        std::span<const double> transmittance) {
  const BandOnAxis band = simulator.scene().axis.band(0);
  const std::array<std::span<const double>, 3> behind = {
      light.apparent(light.layout().seen(0)), light.apparent(light.layout().sun(0)),
      light.environment().background_apparent[background]};
  InBandGas out{};
  std::array<double, 3> all{};
  for (std::size_t i = 0; i < band.nodes(); ++i) {
    const double w = band.grid.band_weight[i];
    out[0] += w * column.emitted_w_m2_sr_um[i] *
              (transmittance.empty() ? 1 : transmittance[band.first_node + i]);
    for (std::size_t k = 0; k < 3; ++k) {
      all[k] += w * behind[k][band.first_node + i];
      out[1 + k] += w * behind[k][band.first_node + i] * column.absorbed[i];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) out[1 + k] /= all[k];
  return out;
}

PlumeRay ray_through(Vec<Body> at, Vec<Body> towards) {
  const Vec<Body> d = normalized(towards);
  return {at - 1000.0 * d, d, 0, 2000};
}

// Rays that none of the fitted columns is: across, aslant, near an edge.
const std::vector<PlumeRay> kRays = {
    ray_through({0.1, 0.1, 0.1}, {1, 0.05, 0.02}), ray_through({0.2, -1.1, 0.7}, {1, 0.6, -0.2}),
    ray_through({-0.3, 1.7, -1.2}, {0.4, 1, 0.3}), ray_through({0.1, 0.9, 1.4}, {0.2, -0.3, 1})};

void expect_light(const LiveGas& gas, const std::vector<float>& weights, const GasColumn& column,
                  const InBandGas& exact) {
  const GasOnRay found = gas.light_of(column, weights);
  EXPECT_NEAR(static_cast<double>(found.emitted_w_m2_sr), exact[0],
              2 * static_cast<double>(gas.emitted_error(weights)) * exact[0]);
  for (std::size_t k = 0; k < kBehindGas; ++k)
    EXPECT_NEAR(static_cast<double>(found.absorbed[k]), exact[1 + k],
                2 * static_cast<double>(gas.absorbed_error(weights)) * exact[1 + k])
        << k;
}

TEST(LiveGas, ColumnsHaveTheLightOfTheirSpectra) {
  const auto simulator = disk(1);
  const auto field = slab_at({0, 0, 0}, 4, 0.25);
  const PlaceOfGas place = place_of(*simulator);
  auto wavelengths = GasWavelengths::make(simulator->scene().axis.band(0).grid.node_um);
  ASSERT_TRUE(wavelengths.ok()) << wavelengths.status();
  std::array<InBandGas, 2> of_background;
  for (const std::size_t background : {0, 1}) {
    const auto gas = LiveGas::make(simulator->scene(), field, place.light(), 0, background);
    ASSERT_TRUE(gas.ok()) << gas.status();
    const auto weights = (*gas)->weights(place.light(), background);
    ASSERT_TRUE(weights.ok()) << weights.status();
    EXPECT_GE((*gas)->emitted_error(*weights), 0.01f);
    EXPECT_LT((*gas)->emitted_error(*weights), 0.05f);
    EXPECT_GE((*gas)->absorbed_error(*weights), 0.01f);
    EXPECT_LT((*gas)->absorbed_error(*weights), 0.05f);
    for (const PlumeRay& ray : kRays) {
      const auto column = HotColumn::make(march(*field, ray, view_steps()), *wavelengths);
      ASSERT_TRUE(column.ok()) << column.status();
      of_background[background] =
          in_first_band(*simulator, place.light(), background, column->at_near_end(),
                        place.light().environment().transmittance);
      expect_light(**gas, *weights, march(*field, ray, frame_steps()), of_background[background]);
    }
  }
  // Each kind of light loses another fraction.
  EXPECT_GT(of_background[0][3], 2 * of_background[1][3]);
  EXPECT_GT(of_background[0][1], 1.5 * of_background[0][2]);
}

TEST(LiveGas, ABrokenSkysAirIsThatOfBothItsSkies) {
  SceneSpec scene = scene_of(generated("disk", 200, 1), grey(1), {"MWIR", 3.2, 5, 0.25, {}});
  scene.spectral_breaks_um = air_band_edges_um(3.2, 5);
  const auto simulator = simulator_of(scene);
  const auto field = slab_at({0, 0, 0}, 4, 0.25);
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}, 425, 0, 0};
  const Atmosphere atmosphere = *Atmosphere::make(spec);
  const AbsorberAmounts near = atmosphere.amounts(level_path(0, 1000)),
                        far = atmosphere.amounts(level_path(0, 20'000));
  const PlaceOfGas place = place_of(*simulator, &near, &far);
  const auto gas = LiveGas::make(simulator->scene(), field, place.light(), 0, 0);
  ASSERT_TRUE(gas.ok()) << gas.status();
  const auto weights = (*gas)->weights(place.light(), 0);
  ASSERT_TRUE(weights.ok()) << weights.status();
  auto wavelengths = GasWavelengths::make(simulator->scene().axis.band(0).grid.node_um);
  const auto clear = AirBeforeColumns::make(near, *wavelengths),
             overcast = AirBeforeColumns::make(far, *wavelengths);
  ASSERT_TRUE(clear.ok() && overcast.ok());
  for (const PlumeRay& ray : kRays) {
    const auto column = HotColumn::make(march(*field, ray, view_steps()), *wavelengths);
    ASSERT_TRUE(column.ok()) << column.status();
    const ColumnLight seen = mixed(column->behind(*clear), column->behind(*overcast), 0.4);
    expect_light(**gas, *weights, march(*field, ray, frame_steps()),
                 in_first_band(*simulator, place.light(), 0, seen, {}));
  }
}

// A picture of 64 x 64 pixels of 0.125 m at the target, and the rays of its gas.
struct PictureOfGas {
  std::unique_ptr<Simulator> simulator = disk(1);
  std::shared_ptr<const PlumeField> field;
  ViewFrame frame;
  PictureFrame pictures;
  std::unique_ptr<const LiveGas> gas;
  std::vector<float> weights;
  std::unique_ptr<GasRays> rays;
  double full = 0;  // emission of the slab, straight through

  explicit PictureOfGas(std::shared_ptr<const PlumeField> of) : field(std::move(of)) {
    const PlaceOfGas place = place_of(*simulator);
    const Target& target = simulator->scene().target;
    frame = make_view_frame(target, {0, 0, kRangeM});
    pictures = {{-4, -4, 8, 8}, frame.plane_m, 64, 64};
    auto made = LiveGas::make(simulator->scene(), field, place.light(), 0, 0);
    EXPECT_TRUE(made.ok()) << made.status();
    gas = *std::move(made);
    weights = *gas->weights(place.light(), 0);
    full = static_cast<double>(
        gas->light_of(march(*field, ray_through(middle_of(), frame.forward), frame_steps()),
                      weights)
            .emitted_w_m2_sr);
    EXPECT_GT(full, 0);
    rays = std::make_unique<GasRays>(*gas, weights, target.centre, frame, pictures,
                                     static_cast<float>(full));
    for (std::uint32_t pitch = GasRays::kPitch; pitch > 0; pitch /= 2) {
      const std::uint32_t groups = rays->choose(pitch);
      for (std::uint32_t g = 0; g < groups; ++g) rays->trace_group(g);
    }
  }
  [[nodiscard]] Vec<Body> middle_of() const {
    Vec<Body> sum{};
    for (const PlumePoint& p : field->points()) sum = sum + p.at;
    return (1.0 / static_cast<double>(field->points().size())) * sum;
  }
  // Returns the place in the picture, from its top left, of a point. [px]
  [[nodiscard]] std::array<double, 2> pixel_of(Vec<Body> at) const {
    const Vec<Body> q = at - simulator->scene().target.centre - frame.sensor;
    const double per_m = frame.plane_m / dot(q, frame.forward) / 0.125;
    return {32 + per_m * dot(q, frame.right), 32 - per_m * dot(q, frame.up)};
  }
  // Returns the emission at a place, as a fraction of that of the whole slab.
  [[nodiscard]] double emission(double x, double y, double range_m = 0) const {
    GasRays::Seen seen;
    return rays->at(x, y, range_m, seen) ? static_cast<double>(seen.light.emitted_w_m2_sr) / full
                                         : 0;
  }
};

// 10 m before the target, to starboard and above the middle of the picture.
TEST(GasRays, GasIsSeenWhereItIsAndBeforeWhatItIsBefore) {
  const PictureOfGas p(slab_at({10, 1, -1.5}, 2, 0.125));
  const auto [x, y] = p.pixel_of({10, 1, -1.5});
  EXPECT_LT(y, 28);
  EXPECT_GT(std::abs(x - 32), 4);
  EXPECT_NEAR(p.emission(x, y), 1, 0.01);
  EXPECT_EQ(p.emission(64 - x, y), 0);
  EXPECT_EQ(p.emission(x, 64 - y), 0);
  GasRays::Seen before, behind, within;
  ASSERT_TRUE(p.rays->at(x, y, 80, before) && p.rays->at(x, y, 100, behind) &&
              p.rays->at(x, y, 90.25, within));
  EXPECT_EQ(before.light.emitted_w_m2_sr, 0);
  EXPECT_EQ(before.error.emitted_w_m2_sr, 0);
  EXPECT_NEAR(static_cast<double>(behind.light.emitted_w_m2_sr), p.full, 0.01 * p.full);
  // Three quarters of the slab are before the surface, and may be all or none.
  EXPECT_NEAR(static_cast<double>(within.light.emitted_w_m2_sr), 0.75 * p.full, 0.05 * p.full);
  EXPECT_GT(static_cast<double>(within.error.emitted_w_m2_sr), 0.7 * p.full);
  for (std::size_t k = 0; k < kBehindGas; ++k) {
    EXPECT_EQ(before.light.absorbed[k], 0);
    EXPECT_GT(behind.light.absorbed[k], 0);
    EXPECT_NEAR(within.light.absorbed[k], 0.75f * behind.light.absorbed[k], 0.04f);
    EXPECT_GT(within.error.absorbed[k], 0.7f * behind.light.absorbed[k]);
  }
}

TEST(GasRays, EdgesAreAsSharpAsPixels) {
  const PictureOfGas p(slab_at({10, 1, -1.5}, 2, 0.125));
  const auto [x, y] = p.pixel_of({10, 1, -1.5});
  const double half = 1 / 0.125 / 0.9;  // of the slab's side [px]
  for (const double side : {-1.0, 1.0}) {
    EXPECT_NEAR(p.emission(x + side * (half - 2), y), 1, 0.02);
    EXPECT_NEAR(p.emission(x, y + side * (half - 2)), 1, 0.02);
    EXPECT_EQ(p.emission(x + side * (half + 2), y), 0);
    EXPECT_EQ(p.emission(x, y + side * (half + 2)), 0);
  }
  // Across the pixel of the edge light changes from one side to the other, and errs by half of it.
  const double left = std::floor(x - half), row = std::floor(y) + 0.5;
  EXPECT_NEAR(p.emission(left + 0.9, row), 0.9, 0.03);
  EXPECT_NEAR(p.emission(left + 0.1, row), 0.1, 0.03);
  const double top = std::floor(y - half), column = std::floor(x) + 0.5;
  // Rays there pass through less than all of the slab.
  EXPECT_NEAR(p.emission(column, top + 0.9) / p.emission(column, top + 0.1), 9, 0.5);
  GasRays::Seen seen;
  ASSERT_TRUE(p.rays->at(left + 0.5, row, 0, seen));
  EXPECT_GT(static_cast<double>(seen.error.emitted_w_m2_sr), 0.49 * p.full);
}

// Voxels of 8.9 pixels reach into cells in which none of the field's points is.
TEST(GasRays, CoarseGasIsSeenToItsEnds) {
  const Vec<Body> middle{10, 1, -1.5};
  const PictureOfGas p(slab_at(middle, 2, 1));
  const auto [x, y] = p.pixel_of(middle);
  for (const double off : {-6.5, 6.5}) {
    EXPECT_GT(p.emission(x + off, y), 0.9);
    EXPECT_GT(p.emission(x, y + off), 0.9);
  }
}

// Gas of 2.7 pixels between the first rays is found; gas within one pixel, which none of the rays
// through corners can meet, is flagged where it is.
TEST(GasRays, SmallGasIsDrawnOrFlagged) {
  for (const double side_m : {0.3, 0.05}) {
    const bool drawn = side_m > 0.1;
    // Two or two and a half pixels from a corner of a cell, near the middle of the picture.
    const double off_m = 0.125 * 0.9 * (drawn ? 2 : 2.5);
    const Vec<Body> middle{10, off_m, off_m};
    const PictureOfGas p(slab_at(middle, side_m, 0.05));
    const auto [x, y] = p.pixel_of(middle);
    std::vector<std::uint8_t> edge(64 * 64, 0);
    p.rays->flag_missed(edge);
    int flagged = 0;
    for (std::size_t i = 0; i < edge.size(); ++i)
      if (edge[i] != 0) {
        ++flagged;
        EXPECT_LT(std::abs(static_cast<double>(i % 64) + 0.5 - x), 2);
        EXPECT_LT(std::abs(static_cast<double>(i / 64) + 0.5 - y), 2);
      }
    if (drawn) {
      EXPECT_GT(p.emission(x, y), 0.9);
      EXPECT_EQ(flagged, 0);
    } else {
      EXPECT_EQ(p.emission(x, y), 0);
      EXPECT_EQ(edge[static_cast<std::size_t>(y) * 64 + static_cast<std::size_t>(x)], 1);
    }
  }
}

}  // namespace
}  // namespace irsig
