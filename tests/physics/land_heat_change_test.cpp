// Changes of the temperatures of land by inputs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/land/kinds/make_land_kinds.h"
#include "core/thermal/land/land_heat.h"
#include "land_days.h"

namespace irsig {
namespace {

// Soil on hills.
struct SoilOnHills {
  LandKinds kinds;
  LandHeatRequest request = land_day(600);

  SoilOnHills() { kinds = make_land_kinds(hills(150), {true}, {false}, 0); }
  // [moved][output][kind]
  [[nodiscard]] std::vector<std::vector<std::vector<float>>> changes(
      const std::vector<LandHeatRequest>& moved) const {
    auto out = solve_land_heat_changes(kinds, request, moved);
    EXPECT_TRUE(out.ok()) << out.status();
    std::vector<std::vector<std::vector<float>>> change;
    for (LandTemperatureChange& each : out->moved) change.push_back(std::move(each.change_k));
    return change;
  }
};

void warm_air(LandHeatRequest& r) {
  for (HeatWeather& w : r.weather) {
    const double sky = std::pow((w.air_k + 1) / w.air_k, 4);
    w.air_k += 1;
    w.before.sky_w_m2 *= sky;
    w.after.sky_w_m2 *= sky;
  }
}

// Rationale: a change is the difference of two temperatures, however it is computed. Expected: the
// difference of two full computations with all knots, within what their shadows' edges leave.
TEST(LandHeatChanges, AreDifferencesOfTemperatures) {
  const SoilOnHills soil;
  const std::vector<std::function<void(LandHeatRequest&)>> move = {
      warm_air,
      [](LandHeatRequest& r) { r.convection_factor = 1.3; },
      [](LandHeatRequest& r) { r.material[0]->solar_absorptance += 0.05; },
      [](LandHeatRequest& r) { r.material[0]->emissivity -= 0.05; },
      [](LandHeatRequest& r) {
        for (Layer& layer : r.material[0]->wall.layers) layer.conductivity_w_m_k *= 1.2;
      },
  };
  std::vector<LandHeatRequest> moved(move.size(), soil.request);
  for (std::size_t i = 0; i < move.size(); ++i) move[i](moved[i]);
  const auto changes = soil.changes(moved);
  const LandHeatResult nominal = solved(soil.kinds, soil.request);
  for (std::size_t i = 0; i < move.size(); ++i) {
    const LandHeatResult full = solved(soil.kinds, moved[i]);
    double most = 0;
    for (std::size_t o = 0; o < soil.request.output_knot.size(); ++o)
      for (std::size_t k = 0; k < soil.kinds.kind.size(); ++k) {
        const double expected = static_cast<double>(full.kelvin[o][k] - nominal.kelvin[o][k]),
                     found = static_cast<double>(changes[i][o][k]);
        most = std::max(most, std::abs(expected));
        EXPECT_NEAR(found, expected, 0.03 + 0.05 * std::abs(expected)) << i << " " << o << " " << k;
      }
    EXPECT_GT(most, 0.3) << i;
  }
}

// Rationale: a change by the model passes through zero twice a day, where the model is no better.
// Expected: the sign of the change, and at least its root mean square over a day that repeats.
TEST(LandHeatChanges, OfTheModelHaveTheRootMeanSquareOfTheDay) {
  const SoilOnHills soil;
  std::vector<LandHeatRequest> moved(2, soil.request);
  for (LandHeatRequest& r : moved) r.convection_factor = 1.3;
  moved[1].of_model = true;
  const auto changes = soil.changes(moved);
  const std::size_t hours = soil.request.output_knot.size();
  int enlarged = 0;
  for (std::size_t k = 0; k < soil.kinds.kind.size(); ++k) {
    double square = 0;
    for (std::size_t o = 0; o + 1 < hours; ++o)
      square += std::pow(static_cast<double>(changes[0][o][k]), 2) / static_cast<double>(hours - 1);
    for (std::size_t o = 0; o < hours; ++o) {
      const auto plain = static_cast<double>(changes[0][o][k]),
                 of_model = static_cast<double>(changes[1][o][k]);
      EXPECT_EQ(std::signbit(plain), std::signbit(of_model));
      EXPECT_NEAR(std::abs(of_model), std::max(std::abs(plain), std::sqrt(square)),
                  0.03 * std::abs(of_model));
      if (std::abs(of_model) > 2 * std::abs(plain)) ++enlarged;
    }
  }
  EXPECT_GT(enlarged, 0);
}

// Rationale: a stated temperature changes with its own key alone. Expected: exactly 0 by the
// weather, beside a computed material that changes.
TEST(LandHeatChanges, LeaveStatedLandAlone) {
  const LandKinds kinds = level_land({true, false});
  LandHeatRequest request = land_day(1800);
  request.material.emplace_back();
  request.stated_k = {0, 300};
  LandHeatRequest warmer = request;
  warm_air(warmer);
  const auto changes = solve_land_heat_changes(kinds, request, std::vector{warmer});
  ASSERT_TRUE(changes.ok()) << changes.status();
  for (const std::vector<float>& row : changes->moved[0].change_k)
    for (std::size_t k = 0; k < kinds.kind.size(); ++k) {
      if (kinds.kind[k].material == 1) {
        EXPECT_EQ(row[k], 0.0f);
      } else {
        EXPECT_NEAR(static_cast<double>(row[k]), 0.95, 0.15);
      }
    }
}

// Rationale: differences need the same knots and the same computed land. Expected: an error.
TEST(LandHeatChanges, RefuseOtherKnotsAndOtherLand) {
  const LandKinds kinds = level_land({true});
  const LandHeatRequest request = land_day(1800);
  LandHeatRequest stated = request;
  stated.material = {std::nullopt};
  stated.stated_k = {300};
  for (const LandHeatRequest& other : {land_day(3600), stated})
    EXPECT_EQ(solve_land_heat_changes(kinds, request, std::vector{other}).status().code(),
              absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace irsig
