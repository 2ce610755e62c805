#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"

namespace irsig {
namespace {

ImageSpec image_of(std::uint32_t width_px, std::uint32_t height_px) {
  ImageSpec out;
  out.width_px = width_px;
  out.height_px = height_px;
  out.layer = {ImageLayer::kPath, ImageLayer::kBackground, ImageLayer::kAtSensor};
  return out;
}

// Sum over pixels of what the sensor sees less what it sees without the target, and its error.
Estimate contrast_of(const ViewResult& view, const ViewRequest& r) {
  const std::vector<LayerImage>& layer = view.row[0].layer;
  const double centre_x = 0.5 * (view.image_width_px - 1),
               centre_y = 0.5 * (view.image_height_px - 1);
  Estimate out;
  for (std::size_t i = 0; i < layer[0].value.size(); ++i) {
    const double x = (static_cast<double>(i % view.image_width_px) - centre_x) * view.pixel_rad,
                 y = (static_cast<double>(i / view.image_width_px) - centre_y) * view.pixel_rad;
    const double m2 =
        std::pow(view.pixel_rad * r.viewpoint.range_m, 2) * std::pow(1 + x * x + y * y, -1.5);
    const auto of = [&](std::size_t k) { return static_cast<double>(layer[k].value[i]); };
    out.value += m2 * (of(2) - of(0) - of(1));
    out.stderr_ = std::hypot(out.stderr_, m2 * static_cast<double>(layer[2].stderr_[i]));
  }
  return out;
}

// A plate from 1e-4 of a pixel to a hundred pixels, anywhere in its pixel. The light that it hides
// is 1e-4 of what a pixel shows, of which float32 keeps 6e-8.
absl::StatusOr<Finding> speck(Effort) {
  Worst worst(6);
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(plate(1, 1), grey_paint(0.7))));
  const double black = black_radiance_w_m2_sr(*simulator, 0, 300),
               sky = black_radiance_w_m2_sr(*simulator, 0, 250);
  for (std::uint64_t i = 0; i < 40; ++i) {
    const double pixel_m = std::pow(10.0, 2 - 3.0 * static_cast<double>(i) / 39);
    ViewRequest r = dark_view(*simulator, 0, 0, 1e6, {300});
    r.condition[0].surroundings.sky_temperature_k = 250;
    r.max_reflections = 0;
    r.image = image_of(16, 12);
    r.image->camera.emplace().field_of_view_rad = 2 * std::atan(8 * pixel_m / 1e6);
    const double room_m = std::min(6 * pixel_m, 11 * pixel_m - 1);  // so that all of it is seen
    r.image->camera->look_at_m =
        Vec<Body>{0, room_m * (uniform(1, i) - 0.5), room_m * (uniform(2, i) - 0.5)};
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    // No light below the horizon: the plate hides the sky with its upper half.
    const double expected = 0.7 * black - 0.5 * sky;
    const Estimate sum = contrast_of(view, r);
    worst.see(std::abs(sum.value - expected) / std::hypot(sum.stderr_, 1e-4 * expected), [&] {
      return absl::StrCat("a plate of ", 1 / (pixel_m * pixel_m), " pixels: ", sum.value,
                          " W/sr, expected ", expected);
    });
    // The stated standard error must stay small enough to be of use.
    worst.see(sum.stderr_ / (0.01 * expected),
              [&] { return absl::StrCat("stderr of ", 1 / (pixel_m * pixel_m), " pixels"); });
  }
  return worst.finding();
}

// A plate that fills the picture, through telescopes and wide lenses.
absl::StatusOr<Finding> filled(Effort) {
  Worst worst(6);
  ASSIGN_OR_RETURN(const auto simulator,
                   Simulator::create(one_body(plate(4e4, 4e4), grey_paint(1))));
  const double black = black_radiance_w_m2_sr(*simulator, 0, 300);
  for (const double field_deg : {1e-6, 1e-3, 1.0, 30.0, 100.0}) {
    ViewRequest r = dark_view(*simulator, 0, 0, 1e4, {300});
    r.image = image_of(24, 18);
    r.image->camera.emplace().field_of_view_rad = field_deg * std::numbers::pi / 180;
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const std::vector<float>& pixel = view.row[0].image_w_m2_sr;
    for (std::size_t i = 0; i < pixel.size(); ++i) {
      const double off = std::abs(static_cast<double>(pixel[i]) - black);
      // Within a wide pixel the solid angle of its parts changes.
      const double within = std::hypot(static_cast<double>(view.row[0].image_stderr_w_m2_sr[i]),
                                       1e-6 * black, 0.1 * view.pixel_rad * view.pixel_rad * black);
      worst.see(off / within, [&] {
        return absl::StrCat("pixel ", i, " of ", field_deg, " deg: ", pixel[i], ", expected ",
                            black);
      });
    }
  }
  return worst.finding();
}

// The sun mirrored by a plate of a narrow lobe: few pixels have nearly all of the light.
absl::StatusOr<Finding> glint(Effort) {
  Worst worst(6);
  ASSIGN_OR_RETURN(const auto hull, builtin_material("hull"));
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(plate(2, 2, 20), hull)));
  for (const double off_deg : {0.0, 3.0, 20.0, 89.0}) {
    ViewRequest r = dark_view(*simulator, 0, 0, 1e4, {300});
    const double off = off_deg * std::numbers::pi / 180;
    put_sun(r.condition[0], {std::cos(off), 0, -std::sin(off)});
    r.max_reflections = 1;
    r.accuracy.samples_per_replicate = 1u << 12;
    r.image = image_of(40, 40);
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const Estimate sum = contrast_of(view, r);
    const SignatureResult& row = view.row[0];
    const double error = std::hypot(sum.stderr_, row.contrast_intensity_w_sr.stderr_,
                                    1e-4 * row.contrast_intensity_w_sr.value);
    worst.see(std::abs(sum.value - row.contrast_intensity_w_sr.value) / error, [&] {
      return absl::StrCat("sun ", off_deg, " deg off: ", sum.value, " W/sr, the row has ",
                          row.contrast_intensity_w_sr.value);
    });
  }
  return worst.finding();
}

// One pixel, one line, one column; each holds all of the target.
absl::StatusOr<Finding> narrow_frames(Effort) {
  Worst worst(6);
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(plate(1, 1), grey_paint(1))));
  const double black = black_radiance_w_m2_sr(*simulator, 0, 300);
  for (const auto& [width_px, height_px] : {std::pair{1u, 1u}, {1u, 300u}, {4096u, 1u}, {3u, 2u}}) {
    ViewRequest r = dark_view(*simulator, 0, 0, 1e6, {300});
    r.image = image_of(width_px, height_px);
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const Estimate sum = contrast_of(view, r);
    worst.see(std::abs(sum.value - black) / std::hypot(sum.stderr_, 1e-4 * black), [&] {
      return absl::StrCat(width_px, " x ", height_px, " pixels: ", sum.value, " W/sr, expected ",
                          black);
    });
  }
  return worst.finding();
}

constexpr const char* kOfErrors = "the difference over the stated standard errors";

}  // namespace

std::vector<HardCase> image_cases() {
  return {
      {"images", "speck",
       absl::StrCat("contrast of a plate of 1e-4 to 100 pixels, summed: ", kOfErrors),
       "40 sums of normal errors; squares within pixels are stratified, so that errors stay below "
       "6 % of the contrast",
       speck},
      {"images", "filled",
       absl::StrCat("each pixel of a plate that fills 1e-6 to 100 deg: ", kOfErrors),
       "2160 pixels; a pixel's own solid angle is taken at its middle, 0.1 of its square off",
       filled},
      {"images", "glint",
       absl::StrCat("sum of a plate that mirrors the sun 0 to 89 deg off, against its row: ",
                    kOfErrors),
       "4 sums of normal errors", glint},
      {"images", "narrow_frames",
       absl::StrCat("sum of a plate in 1 x 1, 1 x 300, 4096 x 1 and 3 x 2 pixels: ", kOfErrors),
       "4 sums of normal errors", narrow_frames},
  };
}

}  // namespace irsig
