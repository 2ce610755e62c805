// Rationale: a row at another range must be what a sensor there would see, or differ by less than
// the error that it states.
// Expected: grey air: Bouguer's law on each cause and the background, exactly (to the float32 of
// stored spectra). Own range: the stored row, bit for bit in double. A perspective bound that holds
// for a sphere (closed form) and is attained by a disk nearest to the sensor. Reflected sky whose
// directions differ: within the stated bound.
// Source: closed forms written out here.
#include "view/moved/range_change.h"

#include <gmock/gmock.h>

#include <numbers>

#include "core/environment/air.h"
#include "fake_database.h"
#include "view/moved/moved_row.h"
#include "view/moved/sight_line.h"
#include "view/moved/silhouette.h"
#include "view/query/query.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr double kRange = 2000, kArea = 50, kAir = 285;

Air grey_air() {
  return {.model = AirModel::kHomogeneous,
          .absorption_m2_kg = 2e-4,
          .pressure_pa = 1e5,
          .gas_constant_j_kg_k = 287,
          .path_emission = true};
}

Band band() { return {"mwir", 3, 5, 0.25, {{2.9, 0.2}, {4, 1}, {5.1, 0.5}}}; }

// Source by cause, a smooth function of the bin; the background's radiance at the target.
double cause(std::size_t c, std::size_t k) {
  return (static_cast<double>(c) + 1) * (20 + 3 * static_cast<double>(k));
}
constexpr double kBehind = 1.5;

struct Row {
  StoredSignature signature{};
  schema::Spectrum spectrum;
};

// Returns the closed form at a range.
Row row_at(double range_m) {
  const BandGrid grid = make_band_grid(band()).value();
  const AirPath path = air_path(grey_air(), kAir, range_m, grid.node_um);
  Row out;
  StoredSignature& s = out.signature;
  s.signature_id = s.row = 1;
  s.sweep = "box";
  s.season = "winter";
  s.time_utc = "2025-12-21T01:30:00Z";
  s.band = "mwir";
  s.range_m = range_m;
  s.aspect_azimuth_deg = 30;
  s.aspect_elevation_deg = 10;
  s.projected_area_m2 = kArea;
  s.path_transmittance = path.transmittance[0];
  double StoredSignature::*const in_band[] = {
      &StoredSignature::emitted_w_sr, &StoredSignature::sun_reflected_w_sr,
      &StoredSignature::sky_reflected_w_sr, &StoredSignature::surface_reflected_w_sr,
      &StoredSignature::interreflected_w_sr};
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    double width = 0, radiance = 0, mean_radiance = 0, total = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i) {
      width += grid.band_weight[i];
      radiance += grid.band_weight[i] * path.path_radiance_w_m2_sr_um[i];
      mean_radiance += grid.bin_weight[i] * path.path_radiance_w_m2_sr_um[i];
    }
    const double t = path.transmittance[0];
    for (std::size_t c = 0; c < 5; ++c) {
      total += cause(c, k);
      s.*in_band[c] += width * cause(c, k);
    }
    s.intensity_w_sr += width * total;
    s.apparent_intensity_w_sr += width * total * t + kArea * radiance;
    s.contrast_intensity_w_sr += width * t * (total - kArea * kBehind);
    s.background_radiance_w_m2_sr += width * t * kBehind + radiance;
    s.path_radiance_w_m2_sr += radiance;
    const auto f = [](double v) { return static_cast<float>(v); };
    schema::Spectrum& p = out.spectrum;
    p.add_lambda_um(grid.lambda_um[k]);
    p.add_spectral_intensity_w_sr_um(f(total));
    p.add_emitted_w_sr_um(f(cause(0, k)));
    p.add_sun_reflected_w_sr_um(f(cause(1, k)));
    p.add_sky_reflected_w_sr_um(f(cause(2, k)));
    p.add_surface_reflected_w_sr_um(f(cause(3, k)));
    p.add_interreflected_w_sr_um(f(cause(4, k)));
    p.add_apparent_spectral_intensity_w_sr_um(f(total * t + kArea * mean_radiance));
    p.add_contrast_spectral_intensity_w_sr_um(f(t * (total - kArea * kBehind)));
    p.add_background_radiance_w_m2_sr_um(f(t * kBehind + mean_radiance));
    p.add_path_transmittance(f(t));
    p.add_path_radiance_w_m2_sr_um(f(mean_radiance));
    for (auto add : {&schema::Spectrum::add_spectral_intensity_stderr_w_sr_um,
                     &schema::Spectrum::add_emitted_stderr_w_sr_um,
                     &schema::Spectrum::add_sun_reflected_stderr_w_sr_um,
                     &schema::Spectrum::add_sky_reflected_stderr_w_sr_um,
                     &schema::Spectrum::add_surface_reflected_stderr_w_sr_um,
                     &schema::Spectrum::add_interreflected_stderr_w_sr_um,
                     &schema::Spectrum::add_apparent_spectral_intensity_stderr_w_sr_um,
                     &schema::Spectrum::add_contrast_spectral_intensity_stderr_w_sr_um,
                     &schema::Spectrum::add_background_radiance_stderr_w_m2_sr_um})
      (p.*add)(0.01F);
  }
  s.emitted_stderr_w_sr = s.sky_reflected_stderr_w_sr = 0.5;
  s.apparent_intensity_stderr_w_sr = s.contrast_intensity_stderr_w_sr = 0.4;
  s.intensity_stderr_w_sr = 0.6;
  s.numerical_error_w_sr = 0.8;
  s.apparent_numerical_error_w_sr = s.contrast_numerical_error_w_sr = 0.5;
  return out;
}

class RangeChanged : public ::testing::Test {
 protected:
  RangeChanged() {
    Row row = row_at(kRange);
    db_.signatures = {row.signature};
    db_.spectra[1] = row.spectrum;
    schema::ResolvedSweep& resolved = db_.sweeps["box"].resolved;
    schema::Condition& condition = *resolved.add_condition();
    condition.set_season("winter");
    condition.set_time_utc("2025-12-21T01:30:00Z");
    condition.set_air_temperature_k(kAir);
    condition.mutable_surroundings()->set_kind("none");
    condition.mutable_surroundings()->set_sky_radiance_w_m2_sr_um(kBehind);
    condition.mutable_surroundings()->set_lower_radiance_w_m2_sr_um(kBehind);
    schema::Band& b = *resolved.mutable_sweep()->add_band();
    b.set_name("mwir");
    b.set_lambda_min_um(3);
    b.set_lambda_max_um(5);
    b.set_step_um(0.25);
    for (const SpectralPoint& p : band().response) {
      b.add_response()->set_lambda_um(p.lambda_um);
      b.mutable_response(b.response_size() - 1)->set_value(p.value);
    }
    schema::Air& air = *resolved.mutable_sweep()->mutable_air();
    air.set_model("homogeneous");
    air.set_absorption_m2_kg(grey_air().absorption_m2_kg);
    air.set_pressure_pa(grey_air().pressure_pa);
    air.set_gas_constant_j_kg_k(grey_air().gas_constant_j_kg_k);
    air.set_path_emission(true);
  }
  absl::StatusOr<std::vector<QueryRow>> at(double range_m, TargetExtent extent = {10, 5}) {
    return run_query(db_, {.range_m = {range_m}},
                     [&](const StoredSweep&) -> absl::StatusOr<TargetExtent> { return extent; });
  }
  FakeDatabase db_;
};

TEST_F(RangeChanged, GreyAirObeysBouguersLaw) {
  for (const double range_m : {600.0, 5000.0, 20000.0}) {
    const auto rows = at(range_m);
    ASSERT_TRUE(rows.ok()) << rows.status();
    const StoredSignature& s = rows->front().signature;
    const Row expected = row_at(range_m);
    const StoredSignature& e = expected.signature;
    // Stored spectra have 24 bits.
    const double slack =
        2e-6 * std::max(1.0, s.path_transmittance / db_.signatures[0].path_transmittance);
    EXPECT_NEAR(s.apparent_intensity_w_sr, e.apparent_intensity_w_sr,
                slack * e.apparent_intensity_w_sr);
    EXPECT_NEAR(s.contrast_intensity_w_sr, e.contrast_intensity_w_sr,
                slack * e.apparent_intensity_w_sr);
    EXPECT_NEAR(s.background_radiance_w_m2_sr, e.background_radiance_w_m2_sr,
                slack * e.background_radiance_w_m2_sr);
    EXPECT_NEAR(s.path_transmittance, e.path_transmittance, 1e-12);
    EXPECT_NEAR(s.path_radiance_w_m2_sr, e.path_radiance_w_m2_sr, 1e-12);
    EXPECT_EQ(s.intensity_w_sr, e.intensity_w_sr);
    EXPECT_EQ(s.range_m, range_m);
    ASSERT_TRUE(rows->front().range_change);
    EXPECT_EQ(rows->front().range_change->stored_range_m, kRange);
    const auto spectrum = spectrum_of(db_, rows->front());
    ASSERT_TRUE(spectrum.ok());
    for (int k = 0; k < 9; ++k) {
      EXPECT_NEAR(spectrum->spectrum.contrast_spectral_intensity_w_sr_um(k) /
                      expected.spectrum.contrast_spectral_intensity_w_sr_um(k),
                  1, 2e-5);
      EXPECT_NEAR(spectrum->spectrum.apparent_spectral_intensity_w_sr_um(k) /
                      expected.spectrum.apparent_spectral_intensity_w_sr_um(k),
                  1, 1e-5);
    }
  }
}

TEST_F(RangeChanged, TheOwnRangeGivesTheStoredRow) {
  db_.signatures[0].contrast_model_error_w_sr = 3;
  db_.signatures[0].contrast_input_uncertainty_w_sr = 2;
  const auto rows = at(kRange);
  ASSERT_TRUE(rows.ok()) << rows.status();
  const StoredSignature &s = rows->front().signature, &stored = db_.signatures[0];
  EXPECT_DOUBLE_EQ(s.apparent_intensity_w_sr, stored.apparent_intensity_w_sr);
  EXPECT_DOUBLE_EQ(s.contrast_intensity_w_sr, stored.contrast_intensity_w_sr);
  EXPECT_DOUBLE_EQ(s.background_radiance_w_m2_sr, stored.background_radiance_w_m2_sr);
  EXPECT_DOUBLE_EQ(s.apparent_intensity_stderr_w_sr, stored.apparent_intensity_stderr_w_sr);
  EXPECT_NEAR(s.apparent_numerical_error_w_sr, stored.apparent_numerical_error_w_sr, 1e-9);
  EXPECT_NEAR(rows->front().range_change->range_bound_w_sr, 0, 1e-9);
  // These are not 0 because they are known at another range.
  EXPECT_NEAR(s.contrast_model_error_w_sr, 3, 1e-9);
  EXPECT_NEAR(s.contrast_input_uncertainty_w_sr, 2, 1e-9);
  for (const double range_m : {600.0, 20000.0}) {
    const StoredSignature moved = at(range_m)->front().signature;
    const double left = moved.path_transmittance / stored.path_transmittance;
    EXPECT_GE(moved.contrast_model_error_w_sr, 0.999 * left * 3) << range_m;
    EXPECT_GE(moved.contrast_input_uncertainty_w_sr, 0.999 * left * 2) << range_m;
  }
}

// The causes' errors at most, not less than what the air leaves of the stored one.
TEST_F(RangeChanged, ErrorsGoThroughTheAirAndGrowByThePerspective) {
  const auto rows = at(5000, {100, 100});
  ASSERT_TRUE(rows.ok()) << rows.status();
  const StoredSignature &s = rows->front().signature, &stored = db_.signatures[0];
  const double left = s.path_transmittance / stored.path_transmittance;
  EXPECT_NEAR(s.apparent_intensity_stderr_w_sr, left * stored.apparent_intensity_stderr_w_sr, 1e-6);
  const double bound = perspective_bound(kRange, 5000, 100);
  // The air in front of the target is seen on as much of the sky as the target.
  const double seen_w_sr = stored.intensity_w_sr * s.path_transmittance +
                           stored.projected_area_m2 * s.path_radiance_w_m2_sr;
  EXPECT_GT(stored.projected_area_m2 * s.path_radiance_w_m2_sr, 0.1 * seen_w_sr);
  EXPECT_NEAR(rows->front().range_change->range_bound_w_sr, bound * seen_w_sr, 1e-3);
  EXPECT_GT(s.apparent_numerical_error_w_sr, bound * seen_w_sr / std::sqrt(3.0));
  EXPECT_GT(s.numerical_error_w_sr, bound * stored.intensity_w_sr / std::sqrt(3.0));
  // The background is hidden as far.
  const double background_w_sr =
      stored.projected_area_m2 * (s.background_radiance_w_m2_sr - s.path_radiance_w_m2_sr);
  EXPECT_GT(
      s.contrast_numerical_error_w_sr,
      bound * (stored.intensity_w_sr * s.path_transmittance + background_w_sr) / std::sqrt(3.0));
}

TEST_F(RangeChanged, WhatCannotBeMovedIsRefused) {
  const auto refused = [&](const absl::StatusOr<std::vector<QueryRow>>& rows, absl::StatusCode code,
                           const char* what) {
    EXPECT_EQ(rows.status().code(), code) << rows.status();
    EXPECT_THAT(std::string(rows.status().message()), HasSubstr(what));
  };
  using enum absl::StatusCode;
  refused(at(0), kInvalidArgument, "expected more than 0");
  refused(at(1e300), kInvalidArgument,
          "too far: expected from 20 lengths of the target to 1e+09 m");
  refused(at(199), kInvalidArgument, "range 199 m is below 20 lengths");
  EXPECT_TRUE(at(200).ok());
  refused(at(5000, {150, 80}), kInvalidArgument, "the stored range 2000 m is below 20 lengths");
  db_.signatures[0].superseded = true;
  refused(at(5000), kFailedPrecondition, "an earlier version of its sweep");
  db_.signatures[0].superseded = false;
  db_.signatures[0].contrast_intensity_w_sr = kNotComputed;
  refused(at(5000), kFailedPrecondition, "an older irsig");
  refused(run_query(
              db_,
              {.aspect = SignatureFilter::Direction{0, 0}, .interpolate = true, .range_m = {5000}}),
          kInvalidArgument, "interpolated");
}

// More rows than are read at once, on more threads than one: each as it is alone.
TEST_F(RangeChanged, ManyRowsAreMovedAsEachAlone) {
  const QueryRow near = at(600)->front(), far = at(20000)->front();
  const StoredSignature first = db_.signatures[0];
  const schema::Spectrum spectrum = db_.spectra[1];
  constexpr int kRows = 450;
  for (int i = 1; i < kRows; ++i) {
    StoredSignature& s = db_.signatures.emplace_back(first);
    s.signature_id = i + 1;
    s.row = static_cast<std::uint64_t>(i) + 1;
    s.aspect_azimuth_deg = 0.5 * i + 0.1;  // no two of one viewpoint
    s.intensity_w_sr = first.intensity_w_sr + i;  // which one it is
    db_.spectra[i + 1] = spectrum;
  }
  const auto rows = run_query(db_, {.range_m = {20000, 600}},
                              [](const StoredSweep&) -> absl::StatusOr<TargetExtent> {
                                return TargetExtent{10, 5};
                              });
  ASSERT_TRUE(rows.ok()) << rows.status();
  ASSERT_EQ(rows->size(), 2 * static_cast<std::size_t>(kRows));
  for (std::size_t i = 0; i < rows->size(); ++i) {
    const QueryRow& row = (*rows)[i];
    const QueryRow& alone = i % 2 == 0 ? far : near;
    EXPECT_EQ(row.signature.row, i / 2 + 1);
    EXPECT_EQ(row.signature.range_m, alone.signature.range_m);
    EXPECT_EQ(row.signature.intensity_w_sr, first.intensity_w_sr + static_cast<double>(i / 2));
    EXPECT_EQ(row.signature.contrast_intensity_w_sr, alone.signature.contrast_intensity_w_sr);
    EXPECT_EQ(row.range_change->stored_range_m, kRange);
    EXPECT_EQ(row.range_change->spectrum->SerializeAsString(),
              alone.range_change->spectrum->SerializeAsString());
  }
  // One that cannot be moved: nothing is.
  db_.signatures[300].plume_w_sr = 1;
  const auto hot = at(600);
  EXPECT_EQ(hot.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(hot.status().message()), HasSubstr("row 301: hot gas"));
}

// Where the mesh is not known, as much of the target as its reach allows may stand before the sky.
TEST_F(RangeChanged, WithoutAMeshTheHorizonMayBeBehindTheTarget) {
  constexpr double kSky = 4 * kBehind;
  schema::Surroundings& around =
      *db_.sweeps["box"].resolved.mutable_condition(0)->mutable_surroundings();
  around.set_sky_radiance_w_m2_sr_um(kSky);
  const double before = at(5000)->front().signature.contrast_numerical_error_w_sr;
  db_.signatures[0].aspect_elevation_deg = 0.04;  // 3.5 m high at 5 km
  const StoredSignature s = at(5000)->front().signature;
  double width = 0;
  const BandGrid grid = make_band_grid(band()).value();
  for (const double w : grid.band_weight) width += w;
  const double most = kArea * s.path_transmittance * width * (kSky - kBehind);
  EXPECT_LT(before, 0.2 * most / std::sqrt(3.0));
  EXPECT_GT(s.contrast_numerical_error_w_sr, most / std::sqrt(3.0));
}

// The plate of the target at two ranges: 20 m high, the sensor 3.5 m and 17.5 m above the water.
TEST_F(RangeChanged, AFartherSensorSeesMoreOfTheSeaBehindTheTarget) {
  constexpr double kSky = 4 * kBehind, kElevationDeg = 0.1, kTo = 10000, kHigh = 20;
  db_.sweeps["box"]
      .resolved.mutable_condition(0)
      ->mutable_surroundings()
      ->set_sky_radiance_w_m2_sr_um(kSky);
  const auto sky_fraction = [&](double range_m) {
    return 1 - range_m * std::sin(kElevationDeg * std::numbers::pi / 180) / kHigh;
  };
  const auto mean = [&](double range_m) {
    return kBehind + (kSky - kBehind) * sky_fraction(range_m);
  };
  StoredSignature& stored = db_.signatures[0];
  stored.aspect_azimuth_deg = 0;
  stored.aspect_elevation_deg = kElevationDeg;
  const BandGrid grid = make_band_grid(band()).value();
  double width = 0;
  for (const double w : grid.band_weight) width += w;
  const double before = stored.path_transmittance;
  stored.background_radiance_w_m2_sr = width * before * mean(kRange) + stored.path_radiance_w_m2_sr;
  stored.contrast_intensity_w_sr = before * (stored.intensity_w_sr - kArea * width * mean(kRange));
  TargetExtent extent{20, 21};
  const double y = kArea / kHigh / 2;
  extent.shape = std::make_shared<const TargetShape>(
      TargetShape{{{0, -y, 0}, {0, -y, -kHigh}, {0, y, -kHigh}, {0, y, 0}},
                  {{0, 2, 3}, {0, 1, 2}},
                  {0, 0},
                  {false}});
  db_.sweeps["box"].resolved.mutable_sweep()->add_part()->set_name("plate");
  const auto rows = at(kTo, extent);
  ASSERT_TRUE(rows.ok()) << rows.status();
  const StoredSignature& s = rows->front().signature;
  EXPECT_NEAR(s.background_radiance_w_m2_sr,
              width * s.path_transmittance * mean(kTo) + s.path_radiance_w_m2_sr,
              1e-3 * s.background_radiance_w_m2_sr);
  EXPECT_NEAR(s.contrast_intensity_w_sr,
              s.path_transmittance * (stored.intensity_w_sr - kArea * width * mean(kTo)),
              1e-3 * s.apparent_intensity_w_sr);
  // Kept as it was, the contrast would be off by far more than its error.
  EXPECT_LT(5 * s.contrast_numerical_error_w_sr,
            s.path_transmittance * kArea * width * (mean(kRange) - mean(kTo)));
}

TEST_F(RangeChanged, ABackgroundThatTheAirHidesIsNotBroughtNearer) {
  db_.sweeps["box"].resolved.mutable_sweep()->mutable_air()->set_absorption_m2_kg(5e-3);
  EXPECT_EQ(at(600).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(at(6000).ok());
}

TEST(Perspective, HoldsForASphereAndIsAttainedByADisk) {
  constexpr double kRadius = 10;
  const auto sphere = [](double range_m) {
    const double sine = kRadius / range_m;
    return range_m * range_m * 2 * std::numbers::pi * (1 - std::sqrt(1 - sine * sine));
  };
  const auto disk = [](double range_m) {  // at the point nearest to the sensor, small
    return range_m * range_m / ((range_m - kRadius) * (range_m - kRadius));
  };
  for (const auto& [from, to] : {std::pair{400.0, 5000.0}, {5000.0, 400.0}, {1000.0, 1100.0}}) {
    const double bound = perspective_bound(from, to, kRadius);
    EXPECT_LE(std::abs(sphere(to) / sphere(from) - 1), bound);
    EXPECT_LE(std::abs(disk(to) / disk(from) - 1), bound * (1 + 1e-12));
    EXPECT_GT(std::abs(disk(to) / disk(from) - 1), 0.9 * bound);
    EXPECT_LT(bound, 3 * kRadius / std::min(from, to));
  }
  EXPECT_EQ(perspective_bound(1000, 1000, kRadius), 0);
}

TEST(Extent, LongestSideAndFarthestPoint) {
  const std::vector<Vec<Body>> box{{-10, -2, 1}, {30, 2, -12}};
  const TargetExtent extent = target_extent(box);
  EXPECT_EQ(extent.length_m, 40);
  EXPECT_DOUBLE_EQ(extent.reach_m, std::sqrt(900.0 + 4 + 144));
}

// Two rings of sky: of the lower one less arrives, the more so from afar. The target mirrors one of
// them alone, which the row does not tell.
TEST(ReflectedSky, ItsDirectionsAreBounded) {
  const Band narrow{"b", 4, 4.5, 0.5, {}};
  const BandGrid grid = make_band_grid(narrow).value();
  const std::size_t n = grid.node_um.size();
  const DirectionNodes nodes({0.1f, 0.9f}, {0.0f}, 1);
  const auto line = [&](double low, double high, double grey) {
    ViewEnvironment e;
    const auto flat = [&](double v) { return std::vector<double>(n, v); };
    e.transmittance = flat(grey);
    e.path_radiance = e.sun = e.sun_apparent = flat(0);
    e.around = IncidentRadiance::of_spectra({flat(2), flat(1), flat(1)},
                                            {flat(2 * low), flat(high), flat(grey)}, nodes.sky());
    e.background_apparent = {flat(grey)};
    return sight_line(e, nodes, grid, {{1}, {0}});
  };
  const SightLine from = line(0.8, 0.9, 0.7), to = line(0.3, 0.6, 0.4);
  // Solid angles: half the sphere's height each.
  EXPECT_NEAR(from.bin.arriving[SightLine::kReflected[0]][0], (0.5 * 2 * 0.8 + 0.5 * 0.9) / 1.5,
              1e-6);
  for (const bool mirrors_low : {false, true}) {
    StoredSignature row{};
    row.projected_area_m2 = 1;
    schema::Spectrum spectrum;
    const double sky = 10, before = sky * (mirrors_low ? 0.8 : 0.9),
                 after = sky * (mirrors_low ? 0.3 : 0.6);
    for (int k = 0; k < 2; ++k) {
      spectrum.add_lambda_um(grid.lambda_um[static_cast<std::size_t>(k)]);
      const auto* type = spectrum.GetDescriptor();
      for (int f = 1; f < type->field_count(); ++f)
        if (type->field(f)->is_repeated())
          spectrum.GetReflection()->AddFloat(&spectrum, type->field(f), 0);
      spectrum.set_sky_reflected_w_sr_um(k, static_cast<float>(sky));
      spectrum.set_apparent_spectral_intensity_w_sr_um(k, static_cast<float>(before));
    }
    row.apparent_intensity_w_sr = 0.5 * before;
    row.intensity_w_sr = 0.5 * sky;
    const auto moved = moved_row(row, spectrum, from, to, spread_of(from, to), ShapeChange{});
    ASSERT_TRUE(moved.ok()) << moved.status();
    EXPECT_NEAR(moved->signature.apparent_intensity_w_sr, 0.5 * after, moved->range_bound_w_sr);
    EXPECT_GT(moved->range_bound_w_sr, 0.01 * after);
    EXPECT_LT(moved->range_bound_w_sr, after);
  }
}

}  // namespace
}  // namespace irsig
