// The page's server without its network: who may ask, what may be asked, which command it names;
// and what `view` makes for it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "serve/answers.h"
#include "serve/command_line.h"
#include "serve/hosts.h"
#include "serve/question.h"
#include "serve/target.h"
#include "tests/unit/fake_database.h"
#include "view/draw/png.h"
#include "view/query/interpolate_rows.h"
#include "view/report/compare.h"
#include "view/report/error_budget.h"
#include "view/report/polar_cut.h"

namespace irsig {
namespace {

using testing::HasSubstr;

TEST(Hosts, OnlyAddressesAndLocalhost) {
  for (const char* host : {"localhost", "localhost:8017", "LocalHost", "127.0.0.1", "127.9.8.7:1",
                           "[::1]", "[::1]:65535"})
    EXPECT_TRUE(is_our_host(host, true)) << host;
  for (const char* host :
       {"", "example.org", "localhost.example.org", "127.0.0.1.example.org",
        "localhost:", "localhost:80a", "::1", "[::1", "[127.0.0.1]", "[localhost]", "127.1",
        "0x7f000001", "127.0.0.1:123456", " localhost", "10.0.0.1", "[2001:db8::1]"})
    EXPECT_FALSE(is_our_host(host, true)) << host;
  for (const char* host : {"10.0.0.1:80", "[2001:db8::1]", "localhost"})
    EXPECT_TRUE(is_our_host(host, false)) << host;
  EXPECT_FALSE(is_our_host("example.org", false));
}

TEST(RequestTarget, IsDecodedOnceAndRefusesBrokenEscapes) {
  const auto target = parse_target("/a%2Fb+c?x=1+2%2B&y&&=z&x=%25%34");
  ASSERT_TRUE(target.ok());
  EXPECT_EQ(target->path, "/a/b+c");
  EXPECT_EQ(target->parameters, (Parameters{{"x", "1 2+"}, {"x", "%4"}, {"y", ""}, {"", "z"}}));
  for (const char* broken : {"/%", "/%4", "/%zz", "/%-1", "/?a=%", "/?%0g=1", "/?a=b%2"})
    EXPECT_EQ(parse_target(broken).status().code(), absl::StatusCode::kInvalidArgument) << broken;
}

TEST(RequestTarget, ComparesWholeTexts) {
  EXPECT_TRUE(equal_in_constant_time("", ""));
  EXPECT_TRUE(equal_in_constant_time("/abc/", "/abc/"));
  for (const char* other : {"", "/abc", "/abc//", "/abd/", "Xabc/", "/abcX"})
    EXPECT_FALSE(equal_in_constant_time("/abc/", other)) << other;
}

TEST(Hosts, ListenAddresses) {
  EXPECT_TRUE(parse_listen_address("localhost")->loopback);
  EXPECT_TRUE(parse_listen_address("::1")->loopback);
  EXPECT_FALSE(parse_listen_address("0.0.0.0")->loopback);
  EXPECT_FALSE(parse_listen_address("192.168.1.5")->loopback);
  for (const char* text : {"", "example.org", "1.2.3", "127.0.0.1:80", "[::1]"})
    EXPECT_FALSE(parse_listen_address(text).ok()) << text;
  EXPECT_EQ(page_url(*parse_listen_address("::1"), 80, "0f"), "http://[::1]:80/0f/");
  EXPECT_EQ(page_url(*parse_listen_address("localhost"), 8017, "0f"), "http://127.0.0.1:8017/0f/");
}

Parameters selection() {
  return {{"sweep", "ship"},
          {"season", "winter"},
          {"time", "2025-06-21T01:30:00Z"},
          {"band", "mwir"},
          {"at_range_m", "5000"}};
}

TEST(Question, TakesWhatItKnowsAndNothingElse) {
  Parameters given = selection();
  given.emplace("elevation_deg", "-12.5");
  given.emplace("quantity", "contrast_intensity");
  const auto q = parse_question(given, Needs::kSelection, 1);
  ASSERT_TRUE(q.ok()) << q.status();
  EXPECT_EQ(q->a.season, "winter");
  EXPECT_EQ(q->a.at_range_m, 5000);
  EXPECT_EQ(q->elevation_deg, -12.5);
  EXPECT_EQ(q->quantity, SignatureQuantity::kContrastIntensity);
  EXPECT_FALSE(parse_question(given, Needs::kBoth, 1).ok());
  for (const auto& [name, value, words] :
       {std::tuple{"db", "1", "numbered 0 to 0"}, std::tuple{"row", "1", "no such parameter"},
        std::tuple{"season", "summer", "given twice"}, std::tuple{"elevation_deg", "inf", "number"},
        std::tuple{"at_range_m", "-1", "given twice"}}) {
    Parameters wrong = selection();
    wrong.emplace(name, value);
    const auto refused = parse_question(wrong, Needs::kSelection, 1);
    ASSERT_FALSE(refused.ok()) << name;
    EXPECT_THAT(std::string(refused.status().message()), HasSubstr(words));
  }
}

TEST(Question, TakesALayerOfAnImage) {
  const Parameters row = {{"sweep", "ship"}, {"row", "7"}};
  const auto plain = parse_question(row, Needs::kImage, 1);
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_FALSE(plain->layer.has_value() || plain->stderr_of_image);
  Parameters given = row;
  given.emplace("layer", "at_sensor");
  given.emplace("stderr", "1");
  const auto q = parse_question(given, Needs::kImage, 1);
  ASSERT_TRUE(q.ok()) << q.status();
  EXPECT_EQ(q->layer, ImageLayer::kAtSensor);
  EXPECT_TRUE(q->stderr_of_image);
  EXPECT_FALSE(parse_question(given, Needs::kRow, 1).ok());
  for (const auto& [name, value] : {std::pair{"layer", "radiance"}, {"stderr", "true"}}) {
    Parameters wrong = row;
    wrong.emplace(name, value);
    EXPECT_THAT(std::string(parse_question(wrong, Needs::kImage, 1).status().message()),
                HasSubstr(name));
  }
}

TEST(CommandLine, IsOneOfAShell) {
  EXPECT_EQ(shell_word("a/b-c_1.sigdb"), "a/b-c_1.sigdb");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("it's $(rm) \"x\""), "'it'\\''s $(rm) \"x\"'");
  Question q = *parse_question(selection(), Needs::kSelection, 1);
  q.a.sweep = "-x";
  EXPECT_EQ(selection_command("-a.sigdb", q.a, SignatureQuantity::kIntensity),
            "irsig query ./-a.sigdb --sweep=-x --season winter --time 2025-06-21T01:30:00Z --band "
            "mwir --at-range-m 5000 --format csv");
  EXPECT_THAT(cut_command("a b", q, -5), HasSubstr("irsig plot 'a b' --kind polar --elevation=-5"));
  EXPECT_EQ(left_out_command("a", q),
            "irsig plan --refine a --sweep=-x --at-range-m 5000 --left-out left_out.csv");
  q.row = 7;
  EXPECT_EQ(image_command("a b", q), "irsig query 'a b' --sweep=-x --row 7 --thumbnail row-7.png");
  EXPECT_EQ(layer_command("a b", q, "sun"),
            "irsig plot 'a b' --kind picture --sweep=-x --row 7 --layer sun --out row-7-sun.svg");
  q.range_m = 12345.678;
  q.quantity = SignatureQuantity::kApparentIntensity;
  EXPECT_EQ(row_command("a", q, true),
            "irsig query a --sweep=-x --row 7 --range-m 12345.678 --quantity apparent_intensity "
            "--causes --spectrum --format csv");
}

TEST(Answers, SayWhatIsWrong) {
  const PageSources sources{{"/nonexistent.sigdb"}, {}, {}};
  const auto asked = [&](const char* path, Parameters parameters) {
    return answer(sources, path, parameters);
  };
  EXPECT_EQ(asked("/api/map", selection()).status, 503);
  EXPECT_THAT(asked("/api/map", selection()).body, HasSubstr("nonexistent.sigdb: no such file"));
  EXPECT_EQ(asked("/api/map", {}).status, 400);
  EXPECT_EQ(asked("/www/../serve.h", {}).status, 404);
  EXPECT_EQ(asked("/", {{"anything", "goes"}}).status, 200);
}

StoredValue value(double azimuth, double elevation, double v, double stderr_, double error) {
  return {1, azimuth, elevation, v, stderr_, error};
}

TEST(Compare, ErrorsAddUpAsTheyMust) {
  // Samples independent: 3 and 4 are 5; what is beyond them, sqrt(5^2 - 3^2) = 4 and
  // sqrt(5^2 - 4^2) = 3, may have one sign: 7.
  const std::vector a{value(10, 20, 100, 3, 5), value(30, 20, 1, 0, 0),   value(0, 90, 1, 1, 1),
                      value(77, 20, 5, 1, 1),   value(50, 20, NAN, 1, 1), value(60, 20, 2, 0, 0)};
  const std::vector b{value(370, 20, 90, 4, 5), value(30, 20, 1, 0, 0), value(123, 90, 3, 1, 1),
                      value(50, 20, 1, 1, 1),   value(60, 20, 3, 0, 0), value(5, 5, 0, 1, 1)};
  const Comparison c = compare(a, b);
  ASSERT_EQ(c.value.size(), 4);
  EXPECT_EQ(c.value[0].difference, -10);
  EXPECT_NEAR(c.value[0].difference_error, std::hypot(5, 7), 1e-12);
  EXPECT_NEAR(c.value[0].sigmas, -10 / std::hypot(5, 7), 1e-12);
  EXPECT_EQ(c.value[1].sigmas, 0);
  EXPECT_EQ(c.value[2].difference, 2);  // the zenith is one aspect
  EXPECT_NEAR(c.value[2].difference_error, std::sqrt(2), 1e-12);
  EXPECT_EQ(c.value[3].sigmas, INFINITY);
  EXPECT_EQ(c.only_in_a, 1);
  EXPECT_EQ(c.only_in_b, 2);  // one of them has nothing computed in a
}

TEST(ErrorBudget, PartsMakeUpTheWhole) {
  StoredSignature s{};
  s.intensity_w_sr = 100;
  s.intensity_stderr_w_sr = 3;
  s.undersampling_stderr_w_sr = 1;
  s.truncation_bound_w_sr = 2;
  s.quadrature_bound_w_sr = 1.5;  // with the basis in it
  s.spectral_basis_bound_w_sr = 0.5;
  s.omitted_bound_w_sr = 3;
  s.numerical_error_w_sr = std::sqrt(9 + 1 + std::pow(2 + 1.5 + 3, 2) / 3);
  const auto& intensity = columns_of(SignatureQuantity::kIntensity);
  const auto parts = error_budget({s, std::nullopt}, intensity);
  double shares = 0, standard = 0, bounds = 0;
  for (const ErrorPart& p : parts) {
    shares += p.share;
    (p.bound ? bounds : standard) += p.bound ? p.error_w_sr : p.error_w_sr * p.error_w_sr;
    EXPECT_NE(p.name, "moved");
    EXPECT_NE(p.name, "target_depth");
    EXPECT_NE(p.name, "background");
  }
  EXPECT_NEAR(shares, 1, 1e-12);
  EXPECT_NEAR(bounds, 6.5, 1e-12);
  EXPECT_NEAR(std::sqrt(standard + bounds * bounds / 3), s.numerical_error_w_sr, 1e-12);
  EXPECT_TRUE(
      error_budget({s, std::nullopt}, columns_of(SignatureQuantity::kBackgroundRadiance)).empty());
  s.intensity_w_sr = kNotComputed;
  EXPECT_TRUE(error_budget({s, std::nullopt}, intensity).empty());
}

TEST(ErrorBudget, AMovedRowKnowsItsBoundsTogether) {
  StoredSignature s{};
  s.apparent_intensity_w_sr = 50;
  s.apparent_intensity_stderr_w_sr = 3;
  s.apparent_numerical_error_w_sr = 5;
  const auto parts = error_budget({s, std::nullopt, RangeChange{5000, 1, nullptr}},
                                  columns_of(SignatureQuantity::kApparentIntensity));
  ASSERT_EQ(parts.size(), 2);
  EXPECT_NEAR(parts[0].share, 0.36, 1e-12);
  EXPECT_NEAR(parts[1].error_w_sr, 4 * std::sqrt(3), 1e-12);
  EXPECT_NEAR(parts[1].share, 0.64, 1e-12);
}

TEST(PolarCut, ABeltOfManyViewpointsGivesWhatAllOfThemGive) {
  // With so many samples a belt around the elevation is enough; the estimate is that from all
  // samples.
  FakeSweep sweep;
  sweep.viewpoint = fibonacci_viewpoints(1100, 5000, 0, 90);
  sweep.season.resize(1);
  const FakeDatabase fake = fake_database(sweep);
  std::vector<StoredSignature> mwir;
  for (const StoredSignature& s : fake.signatures)
    if (s.band == "mwir") mwir.push_back(s);
  const auto& intensity = columns_of(SignatureQuantity::kIntensity);
  for (const double elevation : {2.0, 30.0, 80.0}) {
    const auto cut = polar_cut(values_of(mwir, intensity), intensity, elevation);
    ASSERT_TRUE(cut.ok()) << cut.status();
    ASSERT_TRUE(cut->interpolated);
    ASSERT_EQ(cut->point.size(), 180);
    const SignatureField field = fields_of(mwir, SignatureQuantity::kIntensity).front();
    const auto kernel = SphereFit::choose_kernel(field.samples);
    for (std::size_t k = 0; k < 180; k += 15) {
      const auto where = body_from_aspect(2.0 * static_cast<double>(k), elevation);
      const auto fit = SphereFit::at(field.samples, where, *kernel);
      ASSERT_TRUE(fit.ok());
      std::vector<double> v, e;
      for (const std::size_t i : fit->used()) {
        v.push_back(field.samples.value[i]);
        e.push_back(field.samples.value_stderr[i]);
      }
      EXPECT_NEAR(cut->point[k].value / fit->estimate(v, e, FieldKind::kFacets).value, 1, 1e-12);
    }
  }
}

TEST(PolarCut, SaysWhatItCannotDraw) {
  const auto& contrast = columns_of(SignatureQuantity::kContrastIntensity);
  std::vector<StoredValue> ring;
  for (int azimuth = 0; azimuth < 360; azimuth += 30)
    ring.push_back(value(azimuth, 10, azimuth, 1, 2));
  ring.push_back(value(30, 10, 777, 1, 2));  // again: the first counts
  const auto cut = polar_cut(ring, contrast, std::nullopt);
  ASSERT_TRUE(cut.ok()) << cut.status();
  EXPECT_FALSE(cut->interpolated);
  ASSERT_EQ(cut->point.size(), 12);
  EXPECT_EQ(cut->point[1].value, 30);
  EXPECT_EQ(cut->point[1].error, 2);
  EXPECT_EQ(polar_cut(ring, contrast, 90).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(polar_cut(ring, contrast, 60).status().code(), absl::StatusCode::kOutOfRange);
  ring[3].value = kNotComputed;
  EXPECT_EQ(polar_cut(ring, contrast, 10).status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST(PngDefect, IsFound) {
  const std::string good = encode_palette_png(3, 2, {0, 1, 0, 1, 0, 1}, {{0, 0, 0}, {9, 9, 9}});
  EXPECT_EQ(png_defect(good), "");
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    EXPECT_NE(png_defect(bad), "") << at;
    EXPECT_NE(png_defect(good.substr(0, at)), "") << at;
  }
  EXPECT_NE(png_defect(good + "x"), "");
}

}  // namespace
}  // namespace irsig
