// Mutated outputs of other codes, the same ones in every run: the reader must refuse them with
// file:line:column or return band means that are sound, whatever stands in the file. Run it with
// IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "core/atmosphere/imported_path.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

constexpr const char* kCsv =
    "# remark: free\n# observer_height_m: 20\n# target_height_m: 10\n# range_m: 5000\n"
    "# sun_zenith_deg: 60\nlambda_um,transmittance,radiance_w_m2_sr_um,sun_w_m2_um\n"
    "9.00,0.50,4,1e-2\n9.10,0.51,4,1e-2\n9.20,0.52,4,1e-2\n"
    "# observer_height_m: 5\n# target_height_m: 1\n# range_m: 50\n"
    "wavenumber_cm1,transmittance\n900,1\n910,0\n";

constexpr const char* kWords[] = {"nan", "1e999", "-9999.\n", ",",      "E",    "-99",
                                  ":",   "1e300", "FREQ",     "WAVLEN", "\r\n", "\n\n",
                                  "#",   "*****", "TRANS",    "1-400"};

// One file: sound, or refused for a reason that says where.
bool accepted(const std::string& text) {
  const auto paths = parse_imported_paths(text, "f");
  if (!paths.ok()) {
    EXPECT_EQ(paths.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(std::string(paths.status().message()).substr(0, 2), "f:") << paths.status();
    return false;
  }
  EXPECT_FALSE(paths->path.empty());
  for (const ImportedPath& p : paths->path) {
    EXPECT_EQ(p.transmittance.size(), kAirBandCount);
    for (const double t : p.transmittance) EXPECT_TRUE(std::isnan(t) || (t >= 0 && t <= 1)) << t;
    for (const AirSpectrum* spectrum : {&p.radiance_w_m2_sr_um, &p.sun_w_m2_um}) {
      EXPECT_TRUE(spectrum->empty() || spectrum->size() == kAirBandCount);
      for (const double x : *spectrum) EXPECT_FALSE(x < 0);
    }
    EXPECT_FALSE(p.range_m < 0);
    // Neither may trip over what the file says.
    (void)find_path(*paths, p.observer_height_m, p.target_height_m, p.range_m);
    (void)check_conditions(*paths, {60, 25, 130, 290, 172});
  }
  return true;
}

void mutate_many(const std::string& seed_text, std::uint64_t seed, double share = 1) {
  fuzz::Mutator mutator(seed, kWords, 900);
  int sound = 0;
  fuzz::Turns turn(4000, share);
  while (turn.next()) sound += accepted(mutator.mutate(seed_text)) ? 1 : 0;
  // Otherwise the mutations would only ever test the first check.
  EXPECT_GT(sound, turn.done() / 50);
  EXPECT_LT(sound, turn.done());
}

TEST(ImportedPathFuzz, Tape7) {
  std::ifstream stream(IRSIG_SOURCE_DIR "/tests/unit/imported_paths/sea-5km.tape7");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  ASSERT_TRUE(accepted(text));
  mutate_many(text, 1, 0.5);
  mutate_many(text + text, 2, 0.5);
}

TEST(ImportedPathFuzz, Csv) {
  ASSERT_TRUE(accepted(kCsv));
  mutate_many(kCsv, 3);
}

}  // namespace
}  // namespace irsig
