#include "view/pictures/plot_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/status_macros.h"
#include "core/spectral/band.h"
#include "core/spectral/planck.h"
#include "view/draw/axis.h"
#include "view/pictures/thumbnail.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

// A band of a stored sweep with its quadrature.
struct BandQuadrature {
  Band band;
  BandGrid grid;

  [[nodiscard]] double temperature_k(double radiance_w_m2_sr) const {
    return apparent_temperature_k(band, grid, radiance_w_m2_sr);
  }
  [[nodiscard]] double radiance_w_m2_sr(double temperature_k) const {
    if (band.response.empty())
      return planck_band_radiance_w_m2_sr(band.lambda_min_um, band.lambda_max_um, temperature_k);
    double sum = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i)
      sum += grid.band_weight[i] * planck_radiance_w_m2_sr_um(grid.node_um[i], temperature_k);
    return sum;
  }
};

absl::StatusOr<BandQuadrature> band_of(StoreReader& reader, const StoredSignature& s) {
  ASSIGN_OR_RETURN(const auto sweep, reader.sweep(s.sweep, SweepFiles::kNone));
  for (const schema::Band& b : sweep.resolved.sweep().band()) {
    if (b.name() != s.band) continue;
    BandQuadrature out{{b.name(), b.lambda_min_um(), b.lambda_max_um(), b.step_um(), {}}, {}};
    for (const schema::SpectralPoint& p : b.response())
      out.band.response.push_back({p.lambda_um(), p.value()});
    ASSIGN_OR_RETURN(auto grid, make_band_grid(out.band));
    out.grid = std::move(grid);
    return out;
  }
  return absl::FailedPreconditionError(
      fmt::format("row {} is of band {}, which its sweep no longer has", s.row, s.band));
}

// Round temperatures, at the radiance of a blackbody that has them.
BarAxis temperature_axis(const BandQuadrature& band, const ColorRange& range) {
  const double low_k = band.temperature_k(std::max(range.low, 0.0));
  const double high_k = band.temperature_k(std::max(range.high, 0.0));
  BarAxis out{"Apparent temperature in K", {}, {}};
  const Axis round = tight_axis(low_k, high_k, 16);
  for (std::size_t i = 0; i < round.tick.size(); ++i) {
    if (!(round.tick[i] > 0)) continue;
    out.at.push_back(band.radiance_w_m2_sr(round.tick[i]));
    out.label.push_back(round.label[i]);
  }
  return out;
}

// Row by row from the top left. [W/(m2 sr)]
struct Pixels {
  std::uint32_t width_px, height_px;
  std::vector<float> radiance_w_m2_sr;
};

// Means over squares of `side` x `side` pixels; beyond the edges is nothing.
Pixels coarser(const PictureAnswer& fine, std::uint32_t side) {
  Pixels out{(fine.width_px + side - 1) / side, (fine.height_px + side - 1) / side, {}};
  std::vector<double> sum(static_cast<std::size_t>(out.width_px) * out.height_px, 0.0);
  for (std::uint32_t y = 0; y < fine.height_px; ++y)
    for (std::uint32_t x = 0; x < fine.width_px; ++x)
      sum[static_cast<std::size_t>(y / side) * out.width_px + x / side] += static_cast<double>(
          fine.pixel[static_cast<std::size_t>(y) * fine.width_px + x]);
  for (const double s : sum)
    out.radiance_w_m2_sr.push_back(static_cast<float>(s / (static_cast<double>(side) * side)));
  return out;
}

// Of the pixels that the target covers: those with no path beside them may be covered in part, and
// are dark for it. If there are none but those, of all.
absl::StatusOr<ColorRange> own_range(const FalseColorPicture& picture) {
  const auto at = [&](std::uint32_t x, std::uint32_t y) {
    return picture.value[static_cast<std::size_t>(y) * picture.width_px + x];
  };
  const auto covered = [&](std::uint32_t x, std::uint32_t y) {
    for (std::uint32_t v = y - 1; v <= y + 1; ++v)
      for (std::uint32_t u = x - 1; u <= x + 1; ++u)
        if (std::isnan(at(u, v))) return false;
    return true;
  };
  std::vector<float> inside;
  for (std::uint32_t y = 1; y + 1 < picture.height_px; ++y)
    for (std::uint32_t x = 1; x + 1 < picture.width_px; ++x)
      if (covered(x, y)) inside.push_back(at(x, y));
  return range_of(inside.empty() ? picture.value : inside);
}

}  // namespace

absl::StatusOr<FalseColorPicture> radiance_picture(StoreReader& reader, const Query& query,
                                                   const std::optional<ColorRange>& range,
                                                   const std::optional<std::uint32_t>& long_side_px,
                                                   const ReadPictures& read) {
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg && !asked.interpolate) asked.nearest = 1;
  ASSIGN_OR_RETURN(const auto rows, run_query(reader, asked));
  ASSIGN_OR_RETURN(const auto thumbnail, stored_thumbnail(reader, rows));
  const StoredSignature& s = rows.front().signature;
  ASSIGN_OR_RETURN(const auto most_px, most_px_of(reader, s));
  const auto answers =
      read({{.exr = thumbnail.exr(), .most_px = most_px, .paint = false, .pixels = true}});
  if (!answers.ok()) return answers.status();
  if (answers->size() != 1) return absl::InternalError("one image was asked for");
  const PictureAnswer& stored = (*answers)[0];
  if (!stored.damage.empty())
    return absl::DataLossError(
        fmt::format("the stored image of row {} is damaged: {}", s.row, stored.damage));
  const std::uint32_t longest = std::max(stored.width_px, stored.height_px);
  if (long_side_px && *long_side_px > longest)
    return absl::InvalidArgumentError(
        fmt::format("--pixels {}: the stored image has {}", *long_side_px, longest));
  const std::uint32_t side = long_side_px ? (longest + *long_side_px - 1) / *long_side_px : 1;
  Pixels pixels = coarser(stored, side);
  ASSIGN_OR_RETURN(const auto band, band_of(reader, s));

  FalseColorPicture out;
  out.title = fmt::format("{}, {} {}, {}, azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0, {}",
                          s.sweep, s.season, s.time_utc, band_title(s), s.aspect_azimuth_deg,
                          s.aspect_elevation_deg, range_title(s.range_m));
  out.subtitle =
      "Radiance at the target, without the air. Grey: nothing of the target; pixels at edges are "
      "covered in part";
  out.width_px = pixels.width_px;
  out.height_px = pixels.height_px;
  out.value = std::move(pixels.radiance_w_m2_sr);
  for (float& v : out.value)
    if (v == 0) v = std::numeric_limits<float>::quiet_NaN();
  ASSIGN_OR_RETURN(const auto own, own_range(out));
  out.range = range.value_or(own);
  out.axis = bar_axis("In-band radiance in W/(m\u00b2 sr)", out.range);
  out.other = temperature_axis(band, out.range);
  return out;
}

}  // namespace irsig
