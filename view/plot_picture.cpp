#include "view/plot_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/spectral/band.h"
#include "core/spectral/planck.h"
#include "view/axis.h"
#include "view/plot_frame.h"
#include "view/thumbnail.h"

namespace irsig {
namespace {

// A band of a stored sweep with its quadrature.
struct SweepBand {
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

absl::StatusOr<SweepBand> band_of(StoreReader& reader, const StoredSignature& s) {
  const auto sweep = reader.sweep(s.sweep);
  if (!sweep.ok()) return sweep.status();
  for (const schema::Band& b : sweep->resolved.sweep().band()) {
    if (b.name() != s.band) continue;
    SweepBand out{{b.name(), b.lambda_min_um(), b.lambda_max_um(), b.step_um(), {}}, {}};
    for (const schema::SpectralPoint& p : b.response())
      out.band.response.push_back({p.lambda_um(), p.value()});
    auto grid = make_band_grid(out.band);
    if (!grid.ok()) return grid.status();
    out.grid = *std::move(grid);
    return out;
  }
  return absl::FailedPreconditionError(
      fmt::format("row {} is of band {}, which its sweep no longer has", s.row, s.band));
}

// Round temperatures, at the radiance of a blackbody that has them.
BarAxis temperature_axis(const SweepBand& band, const ColorRange& range) {
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

}  // namespace

absl::StatusOr<FalseColorPicture> radiance_picture(StoreReader& reader, const Query& query,
                                                   const std::optional<ColorRange>& range,
                                                   const ReadExr& read) {
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg && !asked.interpolate) asked.nearest = 1;
  const auto rows = run_query(reader, asked);
  if (!rows.ok()) return rows.status();
  const auto thumbnail = stored_thumbnail(reader, *rows);
  if (!thumbnail.ok()) return thumbnail.status();
  auto pixels = read(thumbnail->exr());
  if (!pixels.ok()) return pixels.status();
  const StoredSignature& s = rows->front().signature;
  const auto band = band_of(reader, s);
  if (!band.ok()) return band.status();

  FalseColorPicture out;
  out.title = fmt::format("{}, {} {}, {}, azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0, {}",
                          s.sweep, s.season, s.time_utc, band_title(s), s.aspect_azimuth_deg,
                          s.aspect_elevation_deg, range_title(s.range_m));
  out.subtitle = "Radiance at the target, without the air. Grey: no path has met the target there";
  out.width_px = pixels->width_px;
  out.height_px = pixels->height_px;
  out.value = std::move(pixels->radiance_w_m2_sr);
  for (float& v : out.value)
    if (v == 0) v = std::numeric_limits<float>::quiet_NaN();
  const auto own = range_of(out.value);
  if (!own.ok()) return own.status();
  out.range = range.value_or(*own);
  out.axis = bar_axis("In-band radiance in W/(m\u00b2 sr)", out.range);
  out.other = temperature_axis(*band, out.range);
  return out;
}

}  // namespace irsig
