// Bands against the structure of the background. Rationale: a detector that sees land is limited by
// the land, not by its noise. Expected: closed forms of signal to clutter and noise of backgrounds
// of two materials, of which one wavelength tells them apart and another does not. Source: a
// contrast of 1 W/(sr um) from 3 to 5 um at 1 km, seen with a noise of 1e-6 W/m2, has a
// signal-to-noise ratio of the window's width [um]; so clutter of 1 W/(sr um) has a ratio to the
// noise of this width.
#include <gmock/gmock.h>

#include <cmath>

#include "core/accuracy/spectral_modes.h"
#include "core/clutter/clutter.h"
#include "core/clutter/clutter_modes.h"
#include "tests/unit/fake_database.h"
#include "view/bands/band_population.h"
#include "view/bands/bands.h"
#include "view/query/query.h"

namespace irsig {
namespace {

constexpr std::size_t kLambdas = 21;
constexpr double kArea = 4;

std::vector<double> flat(double level) { return std::vector<double>(kLambdas, level); }

// A window's part that covers bins of one level each: value below 4.05 um, value above it.
std::vector<double> halves(double below, double above) {
  std::vector<double> out(kLambdas, above);
  for (std::size_t k = 0; k <= 10; ++k) out[k] = below;
  return out;
}

BandPopulation row_in(std::optional<TargetClutter> clutter,
                      std::vector<double> contrast = flat(1)) {
  BandPopulation out;
  for (std::size_t k = 0; k < kLambdas; ++k)
    out.lambda_um.push_back(3 + 0.1 * static_cast<double>(k));
  out.row.push_back({1,
                     0,
                     0,
                     "s",
                     "t",
                     0,
                     0,
                     1000,
                     {std::move(contrast), {}, flat(0), 0, 0, 0},
                     {},
                     flat(1),
                     std::move(clutter)});
  return out;
}

// Squares of two materials, half of the window each, larger than the target; the second emits this
// much more. So clutter is half of that, times the target's area.
TargetClutter two_materials(const std::vector<double>& more) {
  ClutterField field{64, 64, 1, 2, {}};
  for (std::size_t p = 0; p < field.pixels(); ++p) {
    const bool first = p % 64 / 32 == 0;
    field.weight.push_back(first ? 1 : 0);
    field.weight.push_back(first ? 0 : 1);
  }
  SpectralSet radiance = {flat(7), flat(7)};
  for (std::size_t k = 0; k < more.size(); ++k) radiance[1][k] += more[k];
  const auto modes =
      clutter_modes(weight_factor(field, 0), std::vector<SpectralSet>{std::move(radiance)});
  TargetClutter out{modes.band[0], flat(0), 0};
  for (auto& mode : out.modes)
    for (double& v : mode) v *= kArea;
  return out;
}

BandSearch search_in(BandPopulation of, Pairing pairing = Pairing::kNone,
                     const std::vector<NamedFilter>& filters = {}) {
  auto out = BandSearch::make(std::move(of), {{}, ConstantNoise{1e-6}}, pairing, filters);
  EXPECT_TRUE(out.ok()) << out.status();
  return *std::move(out);
}
Passband window_of(const BandSearch& search, double low, double high) {
  Passband out;
  for (std::size_t e = 0; e < search.edges_um().size(); ++e) {
    if (std::abs(search.edges_um()[e] - low) < 1e-9) out.first = e;
    if (std::abs(search.edges_um()[e] - high) < 1e-9) out.last = e;
  }
  EXPECT_LT(out.first, out.last);
  return out;
}
double merit(const BandSearch& search, double low, double high) {
  return search.candidate({}, window_of(search, low, high)).merit;
}

TEST(BandClutter, BestWindowIsWhereMaterialsLookAlike) {
  // Half of 10 x 4: clutter of 20 W/(sr um) below 4.05 um.
  const BandSearch search = search_in(row_in(two_materials(halves(10, 0))));
  const auto found = search.search({}, 0.05, 3);
  EXPECT_NEAR(search.lambda_min_um(found.best.front().one), 4.05, 1e-9);
  EXPECT_NEAR(search.lambda_max_um(found.best.front().one), 5, 1e-9);
  EXPECT_NEAR(found.best.front().merit, 0.95, 1e-9);
  EXPECT_NEAR(merit(search, 3, 5), 2 / std::hypot(1, 20 * 1.05), 1e-9);
  EXPECT_NEAR(merit(search, 3.55, 4.55), 1 / std::hypot(1, 20 * 0.5), 1e-9);
  EXPECT_NEAR(search.clutter_fraction({window_of(search, 3.55, 4.55)}), 100.0 / 101, 1e-9);
  EXPECT_NEAR(search.clutter_fraction({window_of(search, 4.05, 5)}), 0, 1e-12);
  // Without clutter the whole band is the best.
  const BandSearch plain = search_in(row_in({}));
  EXPECT_NEAR(plain.search({}, 0.05, 1).best.front().merit, 2, 1e-9);
  EXPECT_EQ(plain.clutter_fraction({{0, 1}}), 0);
}

// Materials that differ in opposite ways in both halves cancel in a window over both.
TEST(BandClutter, WindowOverBothHalvesAveragesTheClutter) {
  const BandSearch search = search_in(row_in(two_materials(halves(10, -10))));
  EXPECT_NEAR(merit(search, 3, 4.05), 1.05 / std::hypot(1, 20 * 1.05), 1e-9);
  EXPECT_NEAR(merit(search, 3.1 + 0.05, 4.95), 1.8 / std::hypot(1, 0), 1e-9);
}

TEST(BandClutter, PairsAreJudgedWithTheirCovariance) {
  const TargetClutter clutter = two_materials(halves(10, 5));
  const double m1 = 20 * 1.05, m2 = 10 * 0.95, s1 = 1.05, s2 = 0.95;
  const auto pair_merit = [&](Pairing pairing) {
    const BandSearch search = search_in(row_in(clutter), pairing);
    return search.candidate({}, window_of(search, 3, 4.05), window_of(search, 4.05, 5));
  };
  // With one mode m and unit noise it is |s|^2 - (s m)^2 / (1 + |m|^2).
  const double along = s1 * m1 + s2 * m2;
  const double matched = std::sqrt(s1 * s1 + s2 * s2 - along * along / (1 + m1 * m1 + m2 * m2));
  EXPECT_NEAR(pair_merit(Pairing::kMatched).merit, matched, 1e-9);
  // It is more than either reaches, which land hides.
  EXPECT_GT(matched, 4 * s1 / std::hypot(1, m1));
  EXPECT_GT(matched, 4 * s2 / std::hypot(1, m2));
  const Candidate difference = pair_merit(Pairing::kDifference);
  const double g = difference.gain;
  EXPECT_NEAR(g, s1 / s2, 1e-9);  // of a flat background
  EXPECT_NEAR(
      difference.merit,
      std::abs(s1 - g * s2) / std::sqrt(1 + m1 * m1 + g * g * (1 + m2 * m2) - 2 * g * m1 * m2),
      1e-9);
  EXPECT_GE(matched, difference.merit);
}

// The clutter that is left in the best sum of two windows is what one alone would not lose.
TEST(BandClutter, BestPairIsFound) {
  const BandSearch search = search_in(row_in(two_materials(halves(10, 5))), Pairing::kMatched);
  const auto found = search.search({}, 0.1, 2);
  EXPECT_FALSE(found.best.empty());
  const Candidate whole =
      search.candidate({}, window_of(search, 3, 4.05), window_of(search, 4.05, 5));
  EXPECT_NEAR(found.best.front().merit, whole.merit, 1e-9);
  EXPECT_LT(search.clutter_fraction(found.best.front()), 0.05);
}

// Without clutter and without covariance both add up.
TEST(BandClutter, MatchedPairsWithoutClutterAddInQuadrature) {
  const BandSearch search = search_in(row_in({}), Pairing::kMatched);
  EXPECT_NEAR(search.candidate({}, window_of(search, 3, 4.05), window_of(search, 4.05, 5)).merit,
              std::hypot(1.05, 0.95), 1e-9);
}

// The ratio of two targets' signals in axes that clutter does not stretch.
TEST(BandClutter, RatiosAreTakenInWhitenedAxes) {
  BandPopulation of = row_in(two_materials(halves(1, 0.5)), halves(1, 0.5));
  of.row.front().against = of.row.front().target;
  of.row.front().against->value = halves(0.5, 1);
  const BandSearch search = search_in(of, Pairing::kRatio);
  const double s =
      search.candidate({}, window_of(search, 3, 4.05), window_of(search, 4.05, 5)).merit;
  // Another root of the covariance leaves angles and lengths the same.
  const double m1 = 2 * 1.05, m2 = 1 * 0.95, v1 = 1 + m1 * m1, v2 = 1 + m2 * m2, w = m1 * m2;
  const auto product = [&](double a1, double a2, double b1, double b2) {
    return (a1 * b1 * v2 - (a1 * b2 + a2 * b1) * w + a2 * b2 * v1) / (v1 * v2 - w * w);
  };
  const double a1 = 1.05, a2 = 0.5 * 0.95, b1 = 0.5 * 1.05, b2 = 0.95;
  const double aa = product(a1, a2, a1, a2), bb = product(b1, b2, b1, b2),
               angle = std::acos(product(a1, a2, b1, b2) / std::sqrt(aa * bb));
  EXPECT_NEAR(s, angle / std::sqrt(1 / aa + 1 / bb), 1e-9);
}

TEST(BandClutter, FiltersTakeTheirPartOfTheClutter) {
  const std::vector<NamedFilter> filters = {{"half", {{3, 0.5}, {5, 0.5}}}};
  const BandSearch search = search_in(row_in(two_materials(flat(10))), Pairing::kNone, filters);
  EXPECT_NEAR(search.candidate({}, search.filter(0)).merit, 1 / std::hypot(1, 20), 1e-9);
}

TEST(BandClutter, RestOfTheVarianceCounts) {
  TargetClutter clutter{{}, flat(3), 0};
  const BandSearch search = search_in(row_in(clutter));
  EXPECT_NEAR(merit(search, 3, 5), 2 / std::hypot(1, 6), 1e-9);
}

// The standard error of the clutter is one of the merit: none where there is no clutter.
TEST(BandClutter, MarginHasTheErrorOfTheClutter) {
  TargetClutter clutter = two_materials(halves(100, 0));
  clutter.relative_stderr = 0.05;
  const BandSearch search = search_in(row_in(clutter));
  const Candidate both[] = {search.candidate({}, window_of(search, 3, 4.05)),
                            search.candidate({}, window_of(search, 4.05, 5))};
  const WindowChoice choice = search.compare({}, both);
  ASSERT_EQ(choice.candidate.size(), 2U);
  EXPECT_EQ(choice.candidate[0].numerical_error, 0);
  EXPECT_EQ(choice.candidate[1].samples_stderr, 0);
  EXPECT_NEAR(choice.candidate[1].numerical_error / (0.05 * choice.candidate[1].of.merit), 1, 0.16);
}

// Both fall with the distance alike: in clutter a target is seen farther than its noise would let.
TEST(BandClutter, RangesGoOnInClutter) {
  BandPopulation of = row_in(two_materials(flat(10)));
  of.row.push_back(of.row.front());
  for (BandCase& r : of.row) r.weight = 0.5;
  of.row[1].range_m = 2000;
  const BandSearch search = search_in(of);
  const auto s = search.snr(search.candidate({}, window_of(search, 3, 5)));
  EXPECT_NEAR(s[0], 2 / std::hypot(1, 40), 1e-9);
  EXPECT_NEAR(s[1], 0.5 / std::hypot(1, 10), 1e-9);
}

// Reads the clutter of rows from a database.
class StoredClutterTest : public ::testing::Test {
 protected:
  StoredClutterTest() {
    StoredSweep& sweep = database_.sweeps["land"];
    sweep.resolved.mutable_sweep()->set_name("land");
    schema::Band& band = *sweep.resolved.mutable_sweep()->add_band();
    band.set_name("mwir");
    band.set_lambda_min_um(3);
    band.set_lambda_max_um(5);
    band.set_step_um(0.1);
    StoredSignature s{};
    s.signature_id = 1;
    s.row = 1;
    s.sweep = "land";
    s.season = "summer";
    s.time_utc = "12:00";
    s.band = "mwir";
    s.lambda_min_um = 3;
    s.lambda_max_um = 5;
    s.range_m = 1000;
    s.projected_area_m2 = kArea;
    s.clutter_patch_sigma_w_m2_sr = 10;
    s.clutter_patch_sigma_stderr_w_m2_sr = 2;
    s.stop_reason = "accuracy_reached";
    database_.signatures.push_back(s);
    schema::Spectrum& spectrum = database_.spectra[1];
    for (std::size_t k = 0; k < kLambdas; ++k)
      spectrum.add_lambda_um(3 + 0.1 * static_cast<double>(k));
    for (int f = 0; f < spectrum.GetDescriptor()->field_count(); ++f) {
      const auto* field = spectrum.GetDescriptor()->field(f);
      if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_FLOAT) continue;
      for (std::size_t k = 0; k < kLambdas; ++k)
        spectrum.GetReflection()->AddFloat(&spectrum, field, 1);
    }
  }
  absl::StatusOr<BandPopulation> population(bool clutter) {
    StoreReader& reader = database_.reader();
    const auto rows = run_query(reader, Query{});
    if (!rows.ok()) return rows.status();
    return band_population(reader, *rows, nullptr, {}, AspectWeight::kRows, {}, clutter);
  }
  FakeDatabase database_;
};

TEST_F(StoredClutterTest, ComesWithTheTargetsArea) {
  const std::vector<double> sigma = halves(5, 0);
  for (const double v : sigma)
    database_.clutters[1].add_patch_sigma_w_m2_sr_um(static_cast<float>(v));
  database_.clutters[1].set_modes(encoded_modes({sigma}, sigma));
  const auto found = population(true);
  ASSERT_TRUE(found.ok()) << found.status();
  const TargetClutter& clutter = *found->row.front().clutter;
  EXPECT_DOUBLE_EQ(clutter.relative_stderr, 0.2);
  ASSERT_EQ(clutter.modes.size(), 1U);
  EXPECT_NEAR(clutter.modes[0][0], 5 * kArea, 1e-3);
  EXPECT_EQ(clutter.modes[0][20], 0);
  EXPECT_FALSE(population(false)->row.front().clutter.has_value());
}

TEST_F(StoredClutterTest, RowsWithoutAreLeftOutAndCounted) {
  const std::vector<double> sigma = halves(5, 0);
  for (const double v : sigma)
    database_.clutters[1].add_patch_sigma_w_m2_sr_um(static_cast<float>(v));
  database_.clutters[1].set_modes(encoded_modes({sigma}, sigma));
  StoredSignature low = database_.signatures.front();
  low.row = low.signature_id = 2;
  low.aspect_elevation_deg = 0.2;
  database_.signatures.insert(database_.signatures.begin(), low);
  database_.spectra[2] = database_.spectra[1];
  const auto found = population(true);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->row.size(), 1U);
  EXPECT_EQ(found->without_clutter, 1U);
  EXPECT_EQ(found->row.front().weight, 1);
  EXPECT_NE(found->row.front().aspect_elevation_deg, 0.2);
  EXPECT_EQ(population(false)->row.size(), 2U);
  EXPECT_EQ(population(false)->without_clutter, 0U);
}

TEST_F(StoredClutterTest, RowsWithoutAreAnErrorWithARemedy) {
  EXPECT_TRUE(population(false).ok()) << population(false).status();
  const absl::Status status = population(true).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("row 1 has no clutter"));
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("ask without --clutter"));
}

}  // namespace
}  // namespace irsig
