// Rationale: a broken sky is a mixture of the clear and the overcast one.
// Expected: light linear in the cover to 1e-9; the choice between both skies apart from the models'
// errors. Source: the mixture's definition.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/physics/cloud_fixture.h"

namespace irsig {
namespace {

using namespace cloud_fixture;

TEST(BrokenCloud, IsLinearInTheCover) {
  for (const CloudSpec& cloud : {kStratus, kThin}) {
    for (const double range_m : {3000.0, 30e3}) {  // below and above the stratus
      const auto none = light_of(seen_under(weather(0, cloud), 45, range_m, 20).view),
                 all = light_of(seen_under(weather(1, cloud), 45, range_m, 20).view);
      for (const double cover : {1e-9, 0.3, 0.75}) {
        const auto some = light_of(seen_under(weather(cover, cloud), 45, range_m, 20).view);
        ASSERT_EQ(some.size(), all.size());
        for (std::size_t k = 0; k < some.size(); ++k)
          for (std::size_t i = 0; i < some[k].size(); ++i) {
            const double mixed = (1 - cover) * none[k][i] + cover * all[k][i];
            ASSERT_NEAR(some[k][i], mixed, 1e-9 * std::abs(mixed)) << k << " " << i;
          }
      }
    }
  }
}

// Rationale: under a broken sky a target has one sky or the other, and all light of it together.
// Expected: the environment has the sky that is farther from the mean, whole, with the factor that
// makes the difference one sigma of the choice; the models' errors are the means of both skies'.
TEST(BrokenCloud, HasOneOfBothSkiesBesideTheMean) {
  // A sensor above the deck.
  const auto seen = [](double cover) {
    return seen_under(weather(cover, kStratus), 45, 30e3, 20).view;
  };
  const ViewEnvironment none = seen(0), all = seen(1);
  EXPECT_EQ(none.one_sky, nullptr);
  EXPECT_EQ(all.one_sky, nullptr);
  for (const double cover : {1e-9, 0.3, 0.5, 0.9}) {
    const ViewEnvironment some = seen(cover);
    ASSERT_NE(some.one_sky, nullptr);
    const ViewEnvironment& one = cover < 0.5 ? all : none;
    EXPECT_EQ(light_of(*some.one_sky), light_of(one)) << cover;
    const double choice = std::sqrt(cover * (1 - cover));
    for (std::size_t i = 0; i < kUm.size(); ++i) {
      const double apart = std::abs(all.path_radiance[i] - none.path_radiance[i]);
      EXPECT_NEAR(some.one_sky_sigma * std::abs(one.path_radiance[i] - some.path_radiance[i]),
                  choice * apart, 1e-6 * choice * apart)
          << cover << " " << kUm[i];
      const auto mixed = [&](const std::vector<double>& clear,
                             const std::vector<double>& overcast) {
        return (1 - cover) * clear[i] + cover * overcast[i];
      };
      const auto expect = [&](const std::vector<double>& of, double mean) {
        EXPECT_NEAR(of[i], mean, 1e-9 * mean) << cover << " " << kUm[i];
      };
      expect(some.model_error_transmittance,
             mixed(none.model_error_transmittance, all.model_error_transmittance));
      expect(some.model_error_path_radiance,
             mixed(none.model_error_path_radiance, all.model_error_path_radiance));
      for (std::size_t k = 0; k < 2; ++k)
        expect(some.background_model_error[k],
               mixed(none.background_model_error[k], all.background_model_error[k]));
    }
  }
}

}  // namespace
}  // namespace irsig
