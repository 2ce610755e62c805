// An imager does to an image what its file states: sharpness, noise, fixed pattern, counts.
#include "core/imager/imager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <numeric>

#include "core/spectral/planck.h"
#include "jobs/files/imager_file.h"
#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

using std::numbers::pi;
using ::testing::HasSubstr;

// 3-5 um at f/2: the Airy disk is about as wide as a pixel.
Imager mwir() {
  Imager out;
  out.aperture_m = 0.05;
  out.f_number = 2;
  out.pitch_m = 15e-6;
  out.netd_k = 0.025;
  out.gain = CountsOfTemperatures{260, 340};
  return out;
}
const Band kMwir{"mwir", 3, 5, 0.05, {}};
constexpr double kUm = 4;

RadianceImage seen_by(const Imager& imager, const RadianceImage& stored, double pixel_rad,
                      double outside) {
  const auto grid = detector_grid(imager, stored.width_px, stored.height_px, pixel_rad);
  EXPECT_TRUE(grid.ok()) << grid.status();
  return detector_image(imager, kUm, stored, pixel_rad, outside, *grid);
}

double sinc(double x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); }

// Area of the part of a unit square around (x, y) where x cos + y sin < 0.
double covered(double x, double y, double angle) {
  constexpr int n = 64;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double at_y = y - 0.5 + (i + 0.5) / n;
    const double edge = -at_y * std::tan(angle);
    sum += std::clamp(edge - (x - 0.5), 0.0, 1.0) / n;
  }
  return sum;
}

// Rationale: the stated transfer functions multiply, and the stored pixel's own mean is taken out.
// Expected: the transform of a slanted edge's derivative, at f across the edge.
// Source: closed forms, written out here. Within 0.3 % of the product (the requirement is 1 %).
double worst_mtf_error(const Imager& imager, double ratio) {
  const double ifov = imager.ifov_rad(), pixel_rad = ifov / ratio, angle = 0.0935;
  constexpr int kSide = 64;  // pixels of the detector
  const auto n = static_cast<std::uint32_t>(std::lround(kSide * ratio));
  RadianceImage edge{n, n, {}};
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x)
      edge.radiance_w_m2_sr.push_back(
          static_cast<float>(1 + covered(x + 0.5 - 0.5 * n, y + 0.5 - 0.5 * n, angle)));
  const RadianceImage out = seen_by(imager, edge, pixel_rad, 1.5);
  struct Sample {
    double at, value;
  };
  // Away from the border; the same range of distances in every line.
  std::vector<Sample> spread;
  const double middle = 0.5 * out.width_px, reach = 20;
  for (std::uint32_t y = out.height_px / 2 - 10; y < out.height_px / 2 + 11; ++y)
    for (std::uint32_t x = 0; x < out.width_px; ++x) {
      const double at = (x + 0.5 - middle) * std::cos(angle) + (y + 0.5 - middle) * std::sin(angle);
      if (std::abs(at) < reach)
        spread.push_back(
            {at, static_cast<double>(out.radiance_w_m2_sr[std::size_t{y} * out.width_px + x])});
    }
  std::sort(spread.begin(), spread.end(),
            [](const Sample& a, const Sample& b) { return a.at < b.at; });
  double worst = 0;
  const auto transform = [&](double cycles) {
    std::complex<double> sum = 0;
    for (std::size_t i = 1; i < spread.size(); ++i)
      sum += (spread[i].value - spread[i - 1].value) *
             std::polar(1.0, -pi * cycles * (spread[i].at + spread[i - 1].at));
    return std::abs(sum);
  };
  for (double cycles = 0.05; cycles <= 0.5; cycles += 0.05) {
    const double f = cycles / ifov, nu = 1e-6 * kUm * f / imager.aperture_m;
    const double a = std::sqrt(imager.fill_factor) * cycles;
    const double expected = 2 / pi * (std::acos(nu) - nu * std::sqrt(1 - nu * nu)) *
                            std::exp(-2 * std::pow(pi * imager.jitter_rad * f, 2)) *
                            sinc(a * std::cos(angle)) * sinc(a * std::sin(angle));
    // The step is 1; its distant tails, which the lines do not reach, have no high frequencies.
    worst = std::max(worst, std::abs(transform(cycles) / expected - 1));
  }
  return worst;
}
TEST(Imager, SharpnessIsTheProductOfWhatIsStated) {
  Imager imager = mwir();
  for (const double ratio : {2.0, 2.7, 5.0}) {
    const double worst = worst_mtf_error(imager, ratio);
    std::printf("stored pixels per pixel %.1f: MTF error %.3f %%\n", ratio, 100 * worst);
    EXPECT_LT(worst, 0.003);
  }
  imager.jitter_rad = 0.3 * imager.ifov_rad();
  imager.fill_factor = 0.6;
  const double worst = worst_mtf_error(imager, 3.0);
  std::printf("with jitter, 60 %% active: MTF error %.3f %%\n", 100 * worst);
  EXPECT_LT(worst, 0.003);
}

// Rationale: diffraction by itself. Expected: the first dark ring at 1.2197 lambda / D, where the
// Bessel function J1 is 0. Pixels are a 40th of that, so that they do not widen it.
TEST(Imager, TheFirstDarkRingIsAirys) {
  Imager imager = mwir();
  imager.pitch_m = 0.03 * kUm * 1e-6 * imager.f_number;
  imager.margin_px = 100;
  RadianceImage point{1, 1, {1e6f}};
  const double ifov = imager.ifov_rad();
  const RadianceImage out = seen_by(imager, point, ifov / 3, 0);
  const std::uint32_t middle = out.width_px / 2;
  const auto at = [&](std::uint32_t x) {
    return static_cast<double>(out.radiance_w_m2_sr[std::size_t{middle} * out.width_px + x]);
  };
  std::uint32_t x = middle;
  while (at(x + 1) < at(x)) ++x;
  const double bend = at(x - 1) - 2 * at(x) + at(x + 1);
  const double ring_px = x - middle + 0.5 * (at(x - 1) - at(x + 1)) / bend;
  const double ring = ring_px * ifov / (kUm * 1e-6 / imager.aperture_m);
  std::printf("first dark ring at %.4f lambda / D\n", ring);
  EXPECT_NEAR(ring, 1.21967, 0.0012);
  EXPECT_LT(at(x), 1e-3 * at(middle));
}

TEST(Imager, AUniformSceneStaysUniform) {
  Imager imager = mwir();
  imager.jitter_rad = 1e-4;
  const RadianceImage flat{60, 41, std::vector<float>(60 * 41, 12.5f)};
  const RadianceImage out = seen_by(imager, flat, imager.ifov_rad() / 2.3, 12.5);
  EXPECT_EQ(out.width_px, 27 + 2 * imager.margin_px);
  EXPECT_EQ(out.height_px, 18 + 2 * imager.margin_px);
  for (const float value : out.radiance_w_m2_sr) ASSERT_NEAR(value, 12.5, 12.5e-6);
}

// Expected: light is moved, not made or lost: whole pixels that leave no gap between them collect
// what the point sent, but for what falls beyond the margin.
TEST(Imager, TheLightOfAPointIsKept) {
  Imager imager = mwir();
  imager.margin_px = 40;
  RadianceImage point{31, 31, std::vector<float>(31 * 31, 2)};
  point.radiance_w_m2_sr[15 * 31 + 11] += 1e5f;
  const double ratio = 3.3, pixel_rad = imager.ifov_rad() / ratio;
  const auto light = [&](const Imager& camera) {
    const RadianceImage out = seen_by(camera, point, pixel_rad, 2);
    double sum = 0;
    for (const float value : out.radiance_w_m2_sr) sum += static_cast<double>(value) - 2;
    return sum * ratio * ratio / 1e5;
  };
  // Airy's rings beyond s lambda / D hold 2 / (pi^2 s); in a square of that half width less.
  const double s = 40 * imager.ifov_rad() / (kUm * 1e-6 / imager.aperture_m);
  EXPECT_NEAR(light(imager), 1, 2 / (pi * pi * s));
  EXPECT_LT(light(imager), 1);
  imager.aperture_m *= 1000;  // hardly any rings, the jitter's tail
  imager.f_number /= 1000;
  imager.jitter_rad = imager.ifov_rad();
  EXPECT_NEAR(light(imager), 1, 2e-5);
}

// Both images have one centre, whatever the ratio of their pixels.
TEST(Imager, APointAtTheCentreStaysThere) {
  const Imager imager = mwir();
  RadianceImage point{31, 15, std::vector<float>(31 * 15, 2)};
  point.radiance_w_m2_sr[7 * 31 + 15] = 1e4f;
  for (const double ratio : {2.0, 2.7, 7.3}) {
    const RadianceImage out = seen_by(imager, point, imager.ifov_rad() / ratio, 2);
    const std::size_t n = out.radiance_w_m2_sr.size(), width = out.width_px;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t line = i / width * width;
      ASSERT_NEAR(out.radiance_w_m2_sr[i], out.radiance_w_m2_sr[line + width - 1 - (i - line)],
                  1e-3);
      ASSERT_NEAR(out.radiance_w_m2_sr[i], out.radiance_w_m2_sr[n - 1 - i], 1e-3);
    }
  }
}

double mean(const std::vector<std::uint16_t>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
double deviation(const std::vector<std::uint16_t>& values) {
  const double middle = mean(values);
  double sum = 0;
  for (const double v : values) sum += (v - middle) * (v - middle);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}
RadianceImage uniform(double kelvin, std::uint32_t side) {
  return {side, side,
          std::vector<float>(std::size_t{side} * side,
                             static_cast<float>(planck_band_radiance_w_m2_sr(3, 5, kelvin)))};
}

// Rationale: NETD is measured from two blackbodies that fill the field: their difference, times the
// deviation of the counts, over the difference of the counts' means. 65536 pixels know the
// deviation to 0.28 %.
TEST(Imager, NoiseIsTheStatedNetd) {
  Imager imager = mwir();
  imager.bits = 16;
  const auto band = imager_in_band(imager, kMwir);
  ASSERT_TRUE(band.ok()) << band.status();
  const CountsImage cold = counts_image(imager, *band, uniform(299.9, 256), 1);
  const CountsImage warm = counts_image(imager, *band, uniform(300.1, 256), 2);
  const double netd = deviation(cold.counts) * 0.2 / (mean(warm.counts) - mean(cold.counts));
  std::printf("NETD %.5f K, stated %.5f K\n", netd, imager.netd_k);
  EXPECT_NEAR(netd / imager.netd_k, 1, 0.01);
  // Noise is independent in every frame, and from pixel to pixel.
  double product = 0, beside = 0;
  for (std::size_t i = 1; i < cold.counts.size(); ++i) {
    const double c = cold.counts[i] - mean(cold.counts);
    product += c * (warm.counts[i] - mean(warm.counts));
    beside += c * (cold.counts[i - 1] - mean(cold.counts));
    if (i > 4000) break;
  }
  const double square = 4000 * std::pow(deviation(cold.counts), 2);
  EXPECT_LT(std::abs(product / square), 5 / std::sqrt(4000.0));
  EXPECT_LT(std::abs(beside / square), 5 / std::sqrt(4000.0));
  EXPECT_EQ(counts_image(imager, *band, uniform(299.9, 256), 1).counts, cold.counts);
  imager.seed = 2;
  EXPECT_NE(counts_image(imager, *band, uniform(299.9, 256), 1).counts, cold.counts);
}

TEST(Imager, AFixedPatternIsTheSameInEveryFrame) {
  Imager imager = mwir();
  imager.bits = 16;
  imager.netd_k = 0;
  imager.fixed_pattern_k = 0.04;
  const auto band = imager_in_band(imager, kMwir);
  ASSERT_TRUE(band.ok()) << band.status();
  const CountsImage one = counts_image(imager, *band, uniform(300, 256), 1);
  EXPECT_EQ(counts_image(imager, *band, uniform(300, 256), 77).counts, one.counts);
  const double kelvin = deviation(one.counts) / band->counts_per_w_m2_sr /
                        planck_band_radiance_derivative_w_m2_sr_k(3, 5, 300);
  EXPECT_NEAR(kelvin / 0.04, 1, 0.01);
}

TEST(Imager, CountsRunFromBlackToWhiteAndEndThere) {
  for (const std::uint32_t bits : {8u, 14u, 16u}) {
    Imager imager = mwir();
    imager.bits = bits;
    imager.netd_k = 0;
    const auto band = imager_in_band(imager, kMwir);
    ASSERT_TRUE(band.ok()) << band.status();
    const double full = std::pow(2, bits) - 1;
    const auto counts = [&](double kelvin) {
      return counts_image(imager, *band, uniform(kelvin, 2), 1);
    };
    EXPECT_NEAR(counts(260).counts[0], 0, 0.5);
    EXPECT_NEAR(counts(340).counts[0], full, 0.5);
    const double at_300 =
        (planck_band_radiance_w_m2_sr(3, 5, 300) - planck_band_radiance_w_m2_sr(3, 5, 260)) /
        (planck_band_radiance_w_m2_sr(3, 5, 340) - planck_band_radiance_w_m2_sr(3, 5, 260));
    EXPECT_NEAR(counts(300).counts[0], full * at_300, 0.51);
    EXPECT_EQ(counts(300).saturated_px, 0U);
    for (const auto& [kelvin, end] : {std::pair(400.0, full), std::pair(200.0, 0.0)}) {
      EXPECT_EQ(counts(kelvin).counts,
                std::vector<std::uint16_t>(4, static_cast<std::uint16_t>(end)));
      EXPECT_EQ(counts(kelvin).saturated_px, 4U);
    }
    imager.gain = CountsOfRadiance{10, 7};
    EXPECT_EQ(counts_image(imager, *imager_in_band(imager, kMwir), {1, 1, {2.26f}}, 1).counts[0],
              30);
  }
  const Band narrow{"narrow", 3, 3.4, 0.1, {{3.0, 0}, {3.2, 1}, {3.4, 0}}};
  EXPECT_NEAR(imager_in_band(mwir(), narrow)->wavelength_um, 3.2, 0.03);
  EXPECT_GT(imager_in_band(mwir(), kMwir)->wavelength_um, 4.4);  // 300 K radiates at long waves
}

TEST(Imager, StoredPixelsThatAreTooCoarseAreRefused) {
  const Imager imager = mwir();
  EXPECT_TRUE(detector_grid(imager, 128, 40, imager.ifov_rad() / 2).ok());
  const auto grid = detector_grid(imager, 128, 40, imager.ifov_rad() / 1.5);
  ASSERT_FALSE(grid.ok());
  EXPECT_THAT(std::string(grid.status().message()), HasSubstr("thumbnail_px = 171 or more"));
}

constexpr const char* kGood = R"(name = "mwir"
[optics]
aperture_m = 0.05
f_number = 2
jitter_rad = 2e-5
[detector]
pitch_m = 15e-6
netd_k = 0.025
seed = 7
[counts]
bits = 14
black_k = 260
white_k = 340
)";

TEST(ImagerFile, IsReadWithItsDefaults) {
  const TestFolder folder;
  const std::string path = folder.file("i.toml");
  std::ofstream(path) << kGood;
  const auto read = read_imager(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->name, "mwir");
  EXPECT_EQ(read->imager.jitter_rad, 2e-5);
  EXPECT_EQ(read->imager.fill_factor, 1);
  EXPECT_EQ(read->imager.scene_temperature_k, 300);
  EXPECT_EQ(read->imager.seed, 7U);
  EXPECT_EQ(read->imager.bits, 14U);
  EXPECT_NEAR(read->imager.ifov_rad(), 1.5e-4, 1e-12);
  EXPECT_EQ(std::get<CountsOfTemperatures>(read->imager.gain).white_k, 340);
}

TEST(ImagerFile, MistakesHaveTheirPlace) {
  const TestFolder folder;
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = kGood;
    text.replace(text.find(from), from.size(), to);
    const std::string path = folder.file("i.toml");
    std::ofstream(path) << text;
    return std::string(read_imager(path).status().message());
  };
  EXPECT_THAT(refused("bits = 14", "bits = 12"),
              HasSubstr("i.toml:11:1: counts.bits = 12, expected 8, 14 or 16"));
  EXPECT_THAT(refused("bits = 14\n", ""), HasSubstr("i.toml:10:2: counts.bits is missing"));
  EXPECT_THAT(refused("white_k = 340", "white_k = 250"),
              HasSubstr("expected more than black_k = 260"));
  EXPECT_THAT(refused("white_k = 340", "offset_counts = 3"), HasSubstr("states two gains"));
  EXPECT_THAT(refused("black_k = 260\nwhite_k = 340\n", ""), HasSubstr("states no gain"));
  EXPECT_THAT(refused("white_k = 340\n", ""), HasSubstr("counts.white_k is missing"));
  EXPECT_THAT(refused("black_k = 260\nwhite_k = 340\n", "offset_counts = 1"),
              HasSubstr("counts.counts_per_w_m2_sr is missing"));
  EXPECT_THAT(refused("jitter_rad = 2e-5", "jitter = 2e-5"), HasSubstr("i.toml:5:1: "));
  EXPECT_THAT(refused("f_number = 2", "f_number = 0"),
              HasSubstr("i.toml:4:1: optics.f_number = 0"));
  EXPECT_THAT(refused("netd_k = 0.025\n", ""), HasSubstr("detector.netd_k is missing"));
  EXPECT_THAT(refused("[optics]\naperture_m = 0.05\nf_number = 2\njitter_rad = 2e-5\n", ""),
              HasSubstr("optics is missing"));
  EXPECT_THAT(std::string(read_imager(folder.file("none.toml")).status().message()),
              HasSubstr("none.toml:1:1"));
}

}  // namespace
}  // namespace irsig
