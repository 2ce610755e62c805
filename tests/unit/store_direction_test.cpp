// Nearest and within against a search over all viewpoints.

#include <cmath>
#include <numbers>
#include <random>

#include "schema/store/whole/examine.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

// Independent of the store: the spherical law of haversines.
double angle_deg(double azimuth_a, double elevation_a, double azimuth_b, double elevation_b) {
  const double a = std::pow(std::sin((elevation_a - elevation_b) * kRadPerDeg / 2), 2) +
                   std::cos(elevation_a * kRadPerDeg) * std::cos(elevation_b * kRadPerDeg) *
                       std::pow(std::sin((azimuth_a - azimuth_b) * kRadPerDeg / 2), 2);
  return 2 * std::asin(std::min(1.0, std::sqrt(a))) / kRadPerDeg;
}

class StoreDirection : public ::testing::Test {
 protected:
  void write(std::vector<std::pair<double, double>> aspects, int completed = 1 << 30) {
    shape_.aspects = std::move(aspects);
    const auto sweep = make_sweep(shape_);
    auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, sweep, "sweep-a").status());
    ASSERT_OK(complete_jobs(**writer, sweep, completed).status());
    ASSERT_OK((*writer)->finish());
    auto reader = StoreReader::open(path_);
    ASSERT_OK(reader.status());
    reader_ = *std::move(reader);
  }

  std::vector<std::uint64_t> rows(const SignatureFilter& filter) {
    const auto found = reader_->find(filter);
    EXPECT_TRUE(found.ok()) << found.status();
    std::vector<std::uint64_t> out;
    if (found.ok()) {
      for (const StoredSignature& s : *found) out.push_back(s.row);
    }
    return out;
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  SweepShape shape_{.seasons = {"winter"}, .bands = {"mwir"}, .parts = 1, .wavelengths = 5};
  std::unique_ptr<StoreReader> reader_;
};

TEST_F(StoreDirection, AgreesWithASearchOverAll) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> azimuth(0, 360);
  std::uniform_real_distribution<double> sine(-1, 1);
  std::vector<std::pair<double, double>> aspects;
  for (int i = 0; i < 500; ++i)
    aspects.emplace_back(azimuth(random), std::asin(sine(random)) / kRadPerDeg);
  ASSERT_NO_FATAL_FAILURE(write(aspects));
  for (int trial = 0; trial < 100; ++trial) {
    const double az = azimuth(random);
    const double el = std::asin(sine(random)) / kRadPerDeg;
    std::vector<std::pair<double, std::uint64_t>> truth;
    for (std::size_t i = 0; i < aspects.size(); ++i) {
      truth.emplace_back(angle_deg(az, el, aspects[i].first, aspects[i].second), i + 1);
    }
    std::sort(truth.begin(), truth.end());
    SignatureFilter filter;
    filter.direction = {az, el};
    filter.nearest = 1 + static_cast<std::uint32_t>(trial);
    std::vector<std::uint64_t> expected;
    for (std::uint32_t i = 0; i < filter.nearest; ++i) expected.push_back(truth[i].second);
    EXPECT_EQ(rows(filter), expected);

    filter.nearest = 0;
    filter.within_deg = 0.3 + trial;
    expected.clear();
    for (const auto& [angle, row] : truth) {
      if (angle <= *filter.within_deg) expected.push_back(row);
    }
    EXPECT_EQ(rows(filter), expected) << *filter.within_deg;
    filter.range_m = 5000;
    EXPECT_EQ(rows(filter), expected) << *filter.within_deg;
    filter.range_m = 5005;
    EXPECT_TRUE(rows(filter).empty());
  }
  SignatureFilter at;
  at.range_m = 5000;
  EXPECT_EQ(rows(at).size(), aspects.size());
  at.range_m = 10000;
  EXPECT_TRUE(rows(at).empty());
}

TEST_F(StoreDirection, AtThePolesTheAzimuthIsFree) {
  ASSERT_NO_FATAL_FAILURE(write({{0, 90}, {0, 80}, {120, 80}, {240, 80}, {77, -90}}));
  for (const double az : {0.0, 33.0, 180.0, 359.0}) {
    SignatureFilter filter;
    filter.direction = {az, 90};
    filter.within_deg = 0;
    EXPECT_EQ(rows(filter), std::vector<std::uint64_t>{1});
    filter.within_deg = 10;
    EXPECT_EQ(rows(filter).size(), 4U);
    filter.direction = {az, -90};
    filter.within_deg.reset();
    filter.nearest = 1;
    EXPECT_EQ(rows(filter), std::vector<std::uint64_t>{5});
  }
}

TEST_F(StoreDirection, AzimuthIsCircularAndTheCapIncludesItsEdge) {
  ASSERT_NO_FATAL_FAILURE(write({{355, 0}, {5, 0}, {15, 0}, {345, 0}, {180, 0}}));
  SignatureFilter filter;
  filter.direction = {0, 0};
  filter.within_deg = 15;
  EXPECT_EQ(rows(filter).size(), 4U);
  filter.within_deg = 14.999;
  EXPECT_EQ(rows(filter).size(), 2U);
  filter.direction = {-360, 0};
  EXPECT_EQ(rows(filter).size(), 2U);
  filter.within_deg = 180;
  EXPECT_EQ(rows(filter).back(), 5U);
}

// A viewpoint without a result yet cannot be an answer.
TEST_F(StoreDirection, NearestMeansNearestWithAResult) {
  ASSERT_NO_FATAL_FAILURE(write({{180, 0}, {90, 0}, {10, 0}, {5, 0}}, 2));
  SignatureFilter filter;
  filter.direction = {0, 0};
  filter.nearest = 1;
  EXPECT_EQ(rows(filter), std::vector<std::uint64_t>{2});
  filter.nearest = 9;
  EXPECT_EQ(rows(filter), (std::vector<std::uint64_t>{2, 1}));
  EXPECT_EQ(sqlite_text(path_, "SELECT group_concat(viewpoint_id) FROM viewpoint_direction"), "1,2")
      << "it is not looked at, either";
  ASSERT_EQ(sqlite_text(path_, "DELETE FROM viewpoint_direction WHERE viewpoint_id = 2; SELECT 1"),
            "1");
  const auto found = examine(path_, 1);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_THAT(*found, testing::Contains(testing::Field(
                          &StoreFinding::what, testing::HasSubstr("1 viewpoints with signatures "
                                                                  "have no direction"))));
}

}  // namespace
}  // namespace irsig
