// Mutated files that come along with sweeps and questions: soundings, responses, detectors,
// weights, goniometer files. Each is refused, every line of the message with its place, or what is
// read is sound.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <regex>
#include <sstream>

#include "core/atmosphere/air_profile.h"
#include "jobs/detector_file.h"
#include "jobs/goniometer_file.h"
#include "jobs/response_file.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/test_folder.h"
#include "view/row_weights.h"

namespace irsig {
namespace {

constexpr const char* kWords[] = {"nan",  "1e999", "-", ",",  "= ", "|",    "\"", "{",  "[",
                                  "]\n[", "-inf",  "#", "\r", "\t", "\n\n", "0,", "1e", "true"};

// A detector's response has a file of its own.
const std::regex kPlaced("^[^\n]*:[1-9][0-9]*:[1-9][0-9]*: .");
const std::regex kMore(": (and [0-9]+ more errors?|too many errors, reading stopped)$");

// read: whether a text is taken for one.
void fuzz(const std::string& whole, int usual, double share,
          const std::function<absl::Status(const std::string&)>& read) {
  ASSERT_TRUE(read(whole).ok()) << read(whole);
  fuzz::Mutator mutator(1, kWords);
  int accepted = 0;
  fuzz::Turns turn(usual, share);
  while (turn.next()) {
    const std::string text = mutator.mutate(whole);
    SCOPED_TRACE(text);
    const absl::Status status = read(text);
    if (status.ok()) {
      ++accepted;
      continue;
    }
    ASSERT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    std::stringstream lines{std::string(status.message())};
    std::string line;
    for (int count = 0; std::getline(lines, line); ++count)
      ASSERT_TRUE(std::regex_search(line, kPlaced) || (count > 0 && std::regex_search(line, kMore)))
          << line;
  }
  // Mutants that are all refused at their first word would test nothing.
  EXPECT_GT(accepted, turn.done() / 50);
  EXPECT_LT(accepted, turn.done());
}

void expect_response(const std::vector<SpectralPoint>& response) {
  EXPECT_GE(response.size(), 2U);
  for (std::size_t i = 0; i < response.size(); ++i) {
    EXPECT_TRUE(std::isfinite(response[i].value) && response[i].value >= 0);
    EXPECT_TRUE(i == 0 || response[i].lambda_um > response[i - 1].lambda_um);
  }
}

class OfFile {
 public:
  const std::string& path() const { return path_; }
  const std::string& put(const std::string& text) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << text;
    return path_;
  }
  explicit OfFile(const std::string& name) : path_(folder_.file(name)) {}

 private:
  TestFolder folder_;
  std::string path_;
};

TEST(UserTablesFuzz, Soundings) {
  const AirProfile base = afgl_profile(AfglProfile::kMidlatitudeSummer);
  fuzz(
      "# a sounding\nheight_m, pressure_hpa, temperature_c, dew_point_c\n0, 1000, 20, 12\n"
      "1500, 840, 12, 4\n9000, 310, -42, -60\n",
      4000, 1, [&](const std::string& text) {
        const auto profile = parse_profile_csv(text, "s.csv", base);
        return profile.ok() ? check_profile(*profile) : profile.status();
      });
}

TEST(UserTablesFuzz, Responses) {
  const OfFile file("r.csv");
  fuzz("wavelength_um,response\n3,0\n3.5,0.9\n4.8,1\n5,0\n", 2000, 1, [&](const std::string& text) {
    const auto response = read_response(file.put(text));
    if (response.ok()) expect_response(*response);
    return response.status();
  });
}

TEST(UserTablesFuzz, Detectors) {
  for (const char* noise :
       {"kind = \"background\"\naperture_m = 0.05\nf_number = 2\ntransmittance = 0.8\n"
        "pixel_m = 15e-6\nintegration_s = 0.005\nwell_electrons = 7e6\nread_electrons = 300\n",
        "kind = \"nei\"\nnei_w_m2 = 1e-9\n"}) {
    const OfFile file("d.toml");
    const std::string csv = std::filesystem::path(file.path()).parent_path() / "q.csv";
    std::ofstream(csv) << "wavelength_um,quantum_efficiency\n3,0.85\n4.8,0.85\n5,0.8\n";
    const std::string whole = std::string("name = \"InSb\"\n") +
                              (noise[8] == 'b' ? "response_file = \"q.csv\"\n" : "") + "[noise]\n" +
                              noise;
    fuzz(whole, 2000, 0.5, [&](const std::string& text) {
      const auto detector = read_detector(file.put(text));
      if (detector.ok() && !detector->detector.response.empty())
        expect_response(detector->detector.response);
      return detector.status();
    });
  }
}

TEST(UserTablesFuzz, Weights) {
  for (const char* whole :
       {"aspect_azimuth_deg,aspect_elevation_deg,weight\n0,0,1\n90,0,0.5\n180,45,2\n270,-10,0\n",
        "season,time_utc,range_m,weight\nsummer,2025-06-21T12:00:00Z,5000,1\n"
        "winter,2025-12-21T12:00:00Z,5000,0.25\n"}) {
    const OfFile file("w.csv");
    fuzz(whole, 2000, 0.5, [&](const std::string& text) {
      const auto weights = read_row_weights(file.put(text));
      if (weights.ok()) {
        EXPECT_FALSE(weights->line.empty());
        for (const RowWeights::Line& line : weights->line)
          EXPECT_TRUE(std::isfinite(line.weight) && line.weight >= 0);
      }
      return weights.status();
    });
  }
}

TEST(UserTablesFuzz, GoniometerFiles) {
  fuzz(
      "name = \"test\"\n[particles]\nwidth_m = 0.02\ncoverage = [0.5]\n"
      "size = [{diameter_m = 0.001}]\n[[material]]\nname = \"soil\"\nkind = \"lambert\"\n"
      "emissivity = 0.6\n[[part]]\nname = \"soil\"\nmatch = [\"grain_*\"]\nmaterial = \"soil\"\n"
      "[[part]]\nname = \"plate\"\nmaterial = \"soil\"\n[[band]]\nname = \"green\"\n"
      "center_um = 0.55\nfwhm_um = 0.04\n[source]\nzenith_deg = [0, 30]\n[sensor]\n"
      "field_width_m = 0.01\n[view]\nzenith_max_deg = 80\nzenith_step_deg = 40\n"
      "azimuth_step_deg = 90\n[accuracy]\nsamples_per_replicate = 64\n",
      2000, 1, [](const std::string& text) {
        const auto file = parse_goniometer(text, "g.toml");
        return file.ok() ? resolve_goniometer(*file, "").status() : file.status();
      });
}

}  // namespace
}  // namespace irsig
