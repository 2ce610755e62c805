// The image less what lies outside is a sum of cosines over a period of twice `side`, the image and
// the space around it: its mirrored copies are so far away that the point spread does not reach
// them. Cosines, because the transfer function is real and even. Only frequencies that the imager
// lets through are computed, so that a small image takes no time however fine its pixels are.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/clones.h"
#include "core/imager/imager.h"

namespace irsig {
namespace {

using std::numbers::pi;

// Space around the image and the detector, in widths of the point spread. Airy's rings beyond d
// lambda / D of a half plane of light hold 2 / (pi^3 d) of it, from the limit of
// [bornwolf1999, 8.5]: the mirrored copies, more than 64 lambda / D away, add at most 0.1 % of the
// image's contrast.
constexpr double kApertureWidths = 32, kJitterWidths = 5;
// Frequencies beyond are left out: in cycles per pixel of the detector, and where jitter lets 1e-9
// through: 2 (pi sigma f)^2 = 20.7.
constexpr double kFinestCycles = 8, kJitterCycles = 1.025;

// Pixels of the imager by which an image goes on beyond its border: the point spread reaches no
// farther than that.
constexpr double kBeyond = 8;

// The image with its border's pixels repeated beyond it.
RadianceImage widened(const RadianceImage& image, std::uint32_t by_px) {
  RadianceImage out{image.width_px + 2 * by_px, image.height_px + 2 * by_px, {}};
  out.radiance_w_m2_sr.reserve(std::size_t{out.width_px} * out.height_px);
  const auto within = [&](std::uint32_t at, std::uint32_t size) {
    return std::min(std::max(at, by_px) - by_px, size - 1);
  };
  for (std::uint32_t y = 0; y < out.height_px; ++y)
    for (std::uint32_t x = 0; x < out.width_px; ++x)
      out.radiance_w_m2_sr.push_back(
          image.radiance_w_m2_sr[std::size_t{within(y, image.height_px)} * image.width_px +
                                 within(x, image.width_px)]);
  return out;
}

struct Matrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> value;  // row by row
  Matrix(std::size_t r, std::size_t c) : rows(r), columns(c), value(r * c) {}
  double* row(std::size_t r) { return value.data() + r * columns; }
  const double* row(std::size_t r) const { return value.data() + r * columns; }
};

IRSIG_CLONES void add_row(double factor, const double* from, double* to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += factor * from[i];
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix out(a.rows, b.columns);
  for (std::size_t r = 0; r < a.rows; ++r)
    for (std::size_t k = 0; k < a.columns; ++k)
      if (a.row(r)[k] != 0) add_row(a.row(r)[k], b.row(k), out.row(r), b.columns);
  return out;
}

// One axis of the image: lengths in stored pixels from the beginning of the period.
struct Axis {
  std::size_t side, frequencies;
  double image_begin, detector_begin;
};

Axis axis_of(std::uint32_t stored_px, std::uint32_t detector_px, double begin, double ratio,
             double space, double finest) {
  const double left = std::ceil(std::max(0.0, -begin) + space);
  const double right = std::ceil(std::max(0.0, begin + ratio * detector_px - stored_px) + space);
  Axis out{};
  out.side = static_cast<std::size_t>(left + right) + stored_px;
  out.image_begin = left;
  out.detector_begin = left + begin;
  out.frequencies =
      std::min(out.side,
               static_cast<std::size_t>(std::ceil(2 * static_cast<double>(out.side) * finest)) + 1);
  return out;
}

double cosine(const Axis& axis, std::size_t u, double at) {
  return std::cos(pi * static_cast<double>(u) * at / static_cast<double>(axis.side));
}

struct Frequency {
  double cycles_rad;
  double weight;  // of its cosine, times the transfer functions of pixels along this axis
};
// The mean over a stored pixel, at least 0.64, is divided out.
std::vector<Frequency> frequencies_of(const Axis& axis, const Imager& imager, double pixel_rad) {
  std::vector<Frequency> out;
  const auto side = static_cast<double>(axis.side);
  for (std::size_t u = 0; u < axis.frequencies; ++u) {
    const double cycles = 0.5 * static_cast<double>(u) / side;  // per stored pixel
    const double mean = u == 0 ? 1 : std::sin(pi * cycles) / (pi * cycles);
    out.push_back({cycles / pixel_rad,
                   (u == 0 ? 1 : 2) / side * pixel_mtf(imager, cycles / pixel_rad) / mean});
  }
  return out;
}

}  // namespace

RadianceImage detector_image(const Imager& imager, double wavelength_um,
                             const RadianceImage& stored, double pixel_rad, double outside_w_m2_sr,
                             const DetectorGrid& grid) {
  const double spread_rad = 1e-6 * wavelength_um / imager.aperture_m;
  const double space =
      (kApertureWidths * spread_rad + kJitterWidths * imager.jitter_rad) / pixel_rad + grid.ratio;
  double finest = std::min({0.5, pixel_rad / spread_rad, kFinestCycles / grid.ratio});
  if (imager.jitter_rad > 0)
    finest = std::min(finest, kJitterCycles * pixel_rad / imager.jitter_rad);
  const Axis across = axis_of(stored.width_px, grid.width_px, grid.left, grid.ratio, space, finest);
  const Axis down = axis_of(stored.height_px, grid.height_px, grid.top, grid.ratio, space, finest);

  Matrix image(stored.height_px, stored.width_px);
  for (std::size_t i = 0; i < image.value.size(); ++i)
    image.value[i] = static_cast<double>(stored.radiance_w_m2_sr[i]) - outside_w_m2_sr;
  Matrix from_x(stored.width_px, across.frequencies), from_y(down.frequencies, stored.height_px);
  for (std::size_t x = 0; x < from_x.rows; ++x)
    for (std::size_t u = 0; u < across.frequencies; ++u)
      from_x.row(x)[u] = cosine(across, u, across.image_begin + static_cast<double>(x) + 0.5);
  for (std::size_t v = 0; v < down.frequencies; ++v)
    for (std::size_t y = 0; y < from_y.columns; ++y)
      from_y.row(v)[y] = cosine(down, v, down.image_begin + static_cast<double>(y) + 0.5);
  Matrix spectrum = product(from_y, product(image, from_x));

  const std::vector<Frequency> fx = frequencies_of(across, imager, pixel_rad);
  const std::vector<Frequency> fy = frequencies_of(down, imager, pixel_rad);
  for (std::size_t v = 0; v < fy.size(); ++v)
    for (std::size_t u = 0; u < fx.size(); ++u) {
      const double f = std::hypot(fx[u].cycles_rad, fy[v].cycles_rad);
      spectrum.row(v)[u] *= fx[u].weight * fy[v].weight * optics_mtf(imager, wavelength_um, f);
    }

  Matrix to_x(across.frequencies, grid.width_px), to_y(grid.height_px, down.frequencies);
  for (std::size_t u = 0; u < to_x.rows; ++u)
    for (std::size_t x = 0; x < to_x.columns; ++x)
      to_x.row(u)[x] =
          cosine(across, u, across.detector_begin + grid.ratio * (static_cast<double>(x) + 0.5));
  for (std::size_t y = 0; y < to_y.rows; ++y)
    for (std::size_t v = 0; v < down.frequencies; ++v)
      to_y.row(y)[v] =
          cosine(down, v, down.detector_begin + grid.ratio * (static_cast<double>(y) + 0.5));
  const Matrix sampled = product(product(to_y, spectrum), to_x);

  RadianceImage out{grid.width_px, grid.height_px, {}};
  out.radiance_w_m2_sr.reserve(sampled.value.size());
  for (const double value : sampled.value)
    out.radiance_w_m2_sr.push_back(static_cast<float>(outside_w_m2_sr + value));
  return out;
}

RadianceImage detector_image_going_on(const Imager& imager, double wavelength_um,
                                      const RadianceImage& stored, double pixel_rad,
                                      double outside_w_m2_sr, const DetectorGrid& grid) {
  const auto beyond_px = static_cast<std::uint32_t>(std::ceil(kBeyond * grid.ratio));
  DetectorGrid within = grid;
  within.left += beyond_px;
  within.top += beyond_px;
  return detector_image(imager, wavelength_um, widened(stored, beyond_px), pixel_rad,
                        outside_w_m2_sr, within);
}

}  // namespace irsig
