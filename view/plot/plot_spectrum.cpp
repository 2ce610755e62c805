#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "view/draw/axis.h"
#include "view/plot/plot.h"
#include "view/plot/plot_frame.h"

namespace irsig {
namespace {

struct SpectralCurve {
  std::size_t place;
  std::vector<double> lambda_um, value, error;
};

constexpr double kSpectrumLeft = 92, kSpectrumRight = 26, kSpectrumBottom = 70,
                 kSpectrumWidth = 900;

absl::StatusOr<SpectralCurve> curve_of(StoreReader& reader, const QueryRow& row,
                                       const QuantityColumns& quantity, std::size_t place) {
  ASSIGN_OR_RETURN(auto got, spectrum_of(reader, row));
  const schema::Spectrum& s = got.spectrum;
  SpectralCurve out{place, {s.lambda_um().begin(), s.lambda_um().end()}, {}, {}};
  const auto& values = (s.*quantity.spectral_value)();
  if (quantity.spectral_stderr == nullptr) {  // it has none
    out.value.assign(values.begin(), values.end());
    out.error.assign(out.value.size(), 0.0);
    return out;
  }
  const auto& stderrs = (s.*quantity.spectral_stderr)();
  // The interpolation error is known for the source spectrum alone.
  const bool source = quantity.quantity == SignatureQuantity::kIntensity;
  for (int k = 0; k < s.lambda_um_size(); ++k) {
    out.value.push_back(values.Get(k));
    const double between =
        !source || got.spectral_interpolation_error_w_sr_um.empty()
            ? 0
            : got.spectral_interpolation_error_w_sr_um[static_cast<std::size_t>(k)];
    out.error.push_back(std::hypot(stderrs.Get(k), between));
  }
  return out;
}

class Frame {
 public:
  Frame(Svg& svg, double top, const Axis& x, const Axis& y)
      : svg_(svg), top_(top), height_(svg.height_px() - top - kSpectrumBottom), x_(x), y_(y) {}

  [[nodiscard]] Point at(double x, double y) const {
    return {kSpectrumLeft + (kSpectrumWidth - kSpectrumLeft - kSpectrumRight) * x_.fraction(x),
            top_ + height_ * (1 - y_.fraction(y))};
  }

  void grid() {
    for (std::size_t i = 0; i < x_.tick.size(); ++i) {
      const Point p = at(x_.tick[i], y_.low);
      svg_.line(p, at(x_.tick[i], y_.high), {"#e3e3e3", 0.8, ""});
      svg_.text({p.x, p.y + 20}, x_.label[i], {.size = 13, .anchor = Anchor::kMiddle});
    }
    for (std::size_t i = 0; i < y_.tick.size(); ++i) {
      const Point p = at(x_.low, y_.tick[i]);
      svg_.line(p, at(x_.high, y_.tick[i]), {"#e3e3e3", 0.8, ""});
      svg_.text({p.x - 8, p.y + 4.5}, y_.label[i], {.size = 13, .anchor = Anchor::kEnd});
    }
  }

  void box(const std::string& title, const std::string& unit) {
    const Point corner = at(x_.low, y_.high);
    svg_.rect(corner, kSpectrumWidth - kSpectrumLeft - kSpectrumRight, height_, "none",
              {"#333333", 1.2, ""});
    svg_.text({(kSpectrumLeft + kSpectrumWidth - kSpectrumRight) / 2, top_ + height_ + 46},
              "Wavelength in \u00b5m", {.size = 15, .anchor = Anchor::kMiddle});
    svg_.text({26, top_ + height_ / 2}, unit.empty() ? title : title + " in " + unit,
              {.size = 15, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  }

  void band(const StoredSignature& s) {
    const Point a = at(s.lambda_min_um, y_.high), b = at(s.lambda_max_um, y_.low);
    svg_.rect(a, b.x - a.x, b.y - a.y, "#f4f6f8", {"", 0, ""});
    svg_.text({(a.x + b.x) / 2, a.y + 18}, s.band,
              {.size = 13, .anchor = Anchor::kMiddle, .color = "#777777"});
  }

  void curve(const SpectralCurve& c) {
    const Stroke stroke = curve_stroke(c.place);
    std::vector<Point> edge, line;
    for (std::size_t k = 0; k < c.value.size(); ++k) {
      edge.push_back(at(c.lambda_um[k], c.value[k] + 2 * c.error[k]));
      line.push_back(at(c.lambda_um[k], c.value[k]));
    }
    for (std::size_t k = c.value.size(); k-- > 0;) {
      edge.push_back(at(c.lambda_um[k], c.value[k] - 2 * c.error[k]));
    }
    svg_.begin_clip_rect(at(x_.low, y_.high), kSpectrumWidth - kSpectrumLeft - kSpectrumRight,
                         height_);
    svg_.polygon(edge, stroke.color, 0.2);
    svg_.polyline(line, stroke);
    svg_.end_group();
  }

 private:
  Svg& svg_;
  double top_, height_;
  const Axis& x_;
  const Axis& y_;
};

absl::Status one_viewpoint(const std::vector<QueryRow>& rows) {
  const auto stored_m = [](const QueryRow& r) {
    return r.range_change ? r.range_change->stored_range_m : r.signature.range_m;
  };
  for (const QueryRow& r : rows) {
    const StoredSignature &a = rows.front().signature, &b = r.signature;
    if (a.sweep != b.sweep || a.aspect_azimuth_deg != b.aspect_azimuth_deg ||
        a.aspect_elevation_deg != b.aspect_elevation_deg || stored_m(rows.front()) != stored_m(r)) {
      return absl::InvalidArgumentError(
          "a spectrum plot shows one viewpoint of one sweep: choose it with --row K, or with "
          "--aspect AZ,EL --nearest 1 or --interpolate, and the sweep with --sweep");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> draw(StoreReader& reader, const Query& query,
                                 const QuantityColumns& quantity, const ExtentOf& extent_of) {
  Query asked = query;
  if (asked.aspect && !asked.nearest && !asked.within_deg && !asked.interpolate) asked.nearest = 1;
  ASSIGN_OR_RETURN(auto rows, run_query(reader, asked, extent_of));
  if (rows.empty()) return absl::NotFoundError("nothing to plot: no signature matches the filters");
  RETURN_IF_ERROR(one_viewpoint(rows));

  std::vector<StoredSignature> signatures;
  for (const QueryRow& r : rows) signatures.push_back(r.signature);
  RETURN_IF_ERROR(check_computed(signatures, quantity.quantity));
  const CurveNames names(signatures);
  if (names.size() > kMostCurves)
    return absl::InvalidArgumentError(fmt::format(
        "{} conditions match, and a spectrum plot shows at most {}: choose some with --season and "
        "--time, or draw all hours with --kind hours",
        names.size(), kMostCurves));
  std::vector<SpectralCurve> curves;
  double low_um = signatures.front().lambda_min_um, high_um = signatures.front().lambda_max_um;
  double least = 0, most = 0;
  for (const QueryRow& r : rows) {
    ASSIGN_OR_RETURN(auto curve, curve_of(reader, r, quantity, names.index(r.signature)));
    low_um = std::min(low_um, r.signature.lambda_min_um);
    high_um = std::max(high_um, r.signature.lambda_max_um);
    for (std::size_t k = 0; k < curve.value.size(); ++k) {
      most = std::max(most, curve.value[k] + 2 * curve.error[k]);
      least = std::min(least, curve.value[k] < 0 ? curve.value[k] - 2 * curve.error[k] : 0.0);
    }
    curves.push_back(std::move(curve));
  }

  const StoredSignature& any = signatures.front();
  const std::string title =
      fmt::format("{}, azimuth {:.1f}\u00b0, elevation {:.1f}\u00b0{}{}", any.sweep,
                  any.aspect_azimuth_deg, any.aspect_elevation_deg, range_title(signatures),
                  rows.front().interpolation ? ", interpolated" : "");
  Svg svg(kSpectrumWidth, 600, title);
  svg.text({kSpectrumWidth / 2, 32}, title, {.size = 19, .anchor = Anchor::kMiddle, .bold = true});
  std::vector<LegendEntry> legend(names.size());
  for (const auto& s : signatures)
    legend[names.index(s)] = {names.name(s), curve_stroke(names.index(s))};
  draw_legend(svg, {kSpectrumWidth / 2, 62}, legend, 5);
  const double margin = 0.03 * (high_um - low_um);
  const Axis x = tight_axis(low_um - margin, high_um + margin, 10);
  const std::string plain_unit = quantity.spectral_unit;
  const DisplayUnit unit =
      plain_unit.empty() ? DisplayUnit{"", 1}
                         : display_unit(most > least ? std::max(most, -least) : 1, plain_unit);
  const Axis y = plain_unit.empty()
                     ? round_axis(0, 1, 6, 1)
                     : round_axis(least, most > least ? most : least + 1, 6, unit.factor);
  Frame frame(svg, 62 + 22 * static_cast<double>((names.size() + 4) / 5), x, y);
  std::vector<std::string> drawn;
  for (const auto& s : signatures) {
    if (std::find(drawn.begin(), drawn.end(), s.band) != drawn.end()) continue;
    drawn.push_back(s.band);
    frame.band(s);
  }
  frame.grid();
  for (const SpectralCurve& c : curves) frame.curve(c);
  frame.box(quantity.spectral_title, unit.name);
  return svg.finish();
}

}  // namespace

absl::StatusOr<std::string> plot_spectrum(StoreReader& reader, const Query& query,
                                          const ExtentOf& extent_of) {
  return draw(reader, query, columns_of(query.quantity), extent_of);
}

absl::StatusOr<std::string> plot_transmittance(StoreReader& reader, const Query& query,
                                               const ExtentOf& extent_of) {
  if (query.interpolate)
    return absl::InvalidArgumentError("transmittance is not interpolated between viewpoints");
  // Stored together with the contrast; a pure number between 0 and 1.
  QuantityColumns quantity = columns_of(SignatureQuantity::kContrastIntensity);
  quantity.spectral_title = "Transmittance between target and sensor";
  quantity.spectral_unit = "";
  quantity.spectral_value = &schema::Spectrum::path_transmittance;
  quantity.spectral_stderr = nullptr;
  return draw(reader, query, quantity, extent_of);
}

}  // namespace irsig
