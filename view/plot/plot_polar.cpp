#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/status_macros.h"
#include "view/base/table.h"
#include "view/draw/axis.h"
#include "view/plot/plot.h"
#include "view/plot/plot_frame.h"
#include "view/report/polar_cut.h"

namespace irsig {
namespace {

double rad(double deg) { return deg * std::numbers::pi / 180; }

struct PolarCurve {
  std::size_t place;  // among all curves of the plot
  PolarCut cut;
};

class PolarPanel {
 public:
  PolarPanel(Svg& svg, Point center, double radius, const Axis& axis)
      : svg_(svg), center_(center), radius_(radius), axis_(axis) {}

  // Bow up, starboard to the right, as on a chart with the target heading north.
  [[nodiscard]] Point at(double azimuth_deg, double value) const {
    const double r = radius_ * std::clamp(axis_.fraction(value), 0.0, 1.0);
    return {center_.x + r * std::sin(rad(azimuth_deg)), center_.y - r * std::cos(rad(azimuth_deg))};
  }

  void grid() {
    for (double tick : axis_.tick) {
      if (tick <= axis_.low) continue;
      const bool rim = tick >= axis_.high - 1e-9 * (axis_.high - axis_.low);
      svg_.circle(center_, radius_ * axis_.fraction(tick), "none",
                  {rim ? "#555555" : "#d4d4d4", rim ? 1.2 : 0.8, ""});
    }
    // Where values lie on both sides of 0, its circle is the one to look for.
    if (axis_.low < 0 && axis_.high > 0)
      svg_.circle(center_, radius_ * axis_.fraction(0), "none", {"#333333", 1.2, "5 3"});
    for (int azimuth = 0; azimuth < 360; azimuth += 30) {
      svg_.line(center_, at(azimuth, axis_.high), {"#d4d4d4", 0.8, ""});
      const Point p{center_.x + (radius_ + 20) * std::sin(rad(azimuth)),
                    center_.y - (radius_ + 20) * std::cos(rad(azimuth)) + 5};
      const char* side = azimuth == 0 ? " bow" : azimuth == 180 ? " stern" : "";
      svg_.text(p, fmt::format("{}\u00b0{}", azimuth, side),
                {.size = 13, .anchor = Anchor::kMiddle});
    }
  }

  // On top of the curves, along the azimuth where they are shortest and no azimuth is labelled.
  void radial_labels(const std::vector<PolarCurve>& curves) {
    double along_deg = 15, shortest = 2;
    for (double candidate : {15.0, 75.0, 345.0, 285.0, 165.0, 195.0, 105.0, 255.0}) {
      double reach = 0;
      for (const PolarCurve& c : curves) {
        for (const auto& p : c.cut.point) {
          const double apart = std::abs(std::remainder(p.azimuth_deg - candidate, 360));
          if (apart < 12) reach = std::max(reach, axis_.fraction(p.value));
        }
      }
      if (reach < shortest) {
        shortest = reach;
        along_deg = candidate;
      }
    }
    for (std::size_t i = 0; i < axis_.tick.size(); ++i) {
      if (axis_.tick[i] <= axis_.low) continue;
      const Point p = at(along_deg, axis_.tick[i]);
      const double half = 4.2 * static_cast<double>(axis_.label[i].size());
      svg_.rect({p.x - half, p.y - 8}, 2 * half, 15, "#ffffff", {"", 0, ""});
      svg_.text({p.x, p.y + 4}, axis_.label[i],
                {.size = 12, .anchor = Anchor::kMiddle, .color = "#444444"});
    }
  }

  void band_of(const PolarCurve& curve, const Stroke& stroke) {
    band_of(curve, &PolarPoint::error, stroke, 0.16);
  }
  // Draws the uncertainty by inputs in a lighter tone.
  void input_band_of(const PolarCurve& curve, const Stroke& stroke) {
    band_of(curve, &PolarPoint::input, stroke, 0.07);
  }

  void line_of(const PolarCurve& curve, const Stroke& stroke) {
    std::vector<Point> line;
    for (const auto& p : curve.cut.point) line.push_back(at(p.azimuth_deg, p.value));
    line.push_back(line.front());
    svg_.polyline(line, stroke);
    const double r = curve.cut.mark.size() > 90 ? 2 : 3.2;
    for (const auto& m : curve.cut.mark) {
      svg_.line(at(m.azimuth_deg, m.value - 2 * m.error), at(m.azimuth_deg, m.value + 2 * m.error),
                {stroke.color, 1.2, ""});
      svg_.circle(at(m.azimuth_deg, m.value), r, "#ffffff", {stroke.color, 1.4, ""});
    }
  }

 private:
  void band_of(const PolarCurve& curve, double PolarPoint::*sigma, const Stroke& stroke,
               double opacity) {
    std::vector<Point> edge;
    for (const auto& p : curve.cut.point) edge.push_back(at(p.azimuth_deg, p.value + 2 * p.*sigma));
    edge.push_back(edge.front());
    for (std::size_t i = curve.cut.point.size() + 1; i-- > 0;) {
      const auto& p = curve.cut.point[i % curve.cut.point.size()];
      edge.push_back(at(p.azimuth_deg, p.value - 2 * p.*sigma));
    }
    svg_.polygon(edge, stroke.color, opacity);
  }

  Svg& svg_;
  Point center_;
  double radius_;
  const Axis& axis_;
};

struct CutOf {
  StoredSignature first;  // whose condition, band and range it is
  PolarCut cut;
};

struct PolarCuts {
  std::vector<StoredSignature> signature;
  std::vector<CutOf> cut;  // all at one elevation
};

absl::StatusOr<PolarCuts> polar_cuts(StoreReader& reader, const Query& query,
                                     std::optional<double> elevation_deg,
                                     const ExtentOf& extent_of) {
  if (query.aspect || query.row) {
    return absl::InvalidArgumentError(
        "a polar plot shows all azimuths of one elevation: choose it with --elevation, not with "
        "an aspect or a row");
  }
  if (elevation_deg && !(std::abs(*elevation_deg) < 90)) {
    return absl::InvalidArgumentError(
        fmt::format("elevation {:g} deg: expected between -90 and 90", *elevation_deg));
  }
  ASSIGN_OR_RETURN(auto signatures, signatures_to_plot(reader, query, extent_of));
  PolarCuts out{std::move(signatures), {}};
  const QuantityColumns& quantity = columns_of(query.quantity);
  for (const SignatureField& field : fields_of(out.signature, query.quantity)) {
    auto cut = polar_cut(values_of(field.signature, quantity), quantity, elevation_deg);
    if (absl::IsOutOfRange(cut.status()) && !elevation_deg)
      return absl::OutOfRangeError(
          fmt::format("{}: name one with --elevation", std::string(cut.status().message())));
    if (!cut.ok()) return cut.status();
    elevation_deg = cut->elevation_deg;  // of the first one for all
    out.cut.push_back({field.signature.front(), *std::move(cut)});
  }
  return out;
}

struct PanelOfBand {
  const StoredSignature* first;
  std::vector<PolarCurve> curve;  // place: among those of its group
};

// Curves that share a legend. A plot of more curves than one legend holds has a group for every
// season, and more where a season has more hours than that.
struct PolarGroup {
  std::vector<LegendEntry> legend;
  std::vector<PanelOfBand> panel;
};

std::vector<PolarGroup> groups_of(std::vector<CutOf>& cuts,
                                  const std::vector<StoredSignature>& signatures) {
  const CurveNames names(signatures);
  const bool one = names.size() <= kMostCurves;
  std::vector<PolarGroup> out;
  std::vector<std::size_t> group(names.size()), place(names.size());
  std::vector<bool> known(names.size(), false);
  std::string season;
  for (const StoredSignature& s : signatures) {
    const std::size_t k = names.index(s);
    if (known[k]) continue;
    known[k] = true;
    if (out.empty() || (!one && (s.season != season || out.back().legend.size() == kMostCurves)))
      out.emplace_back();
    season = s.season;
    group[k] = out.size() - 1;
    place[k] = out.back().legend.size();
    out.back().legend.push_back({names.name(s), curve_stroke(place[k])});
  }
  for (CutOf& c : cuts) {
    const std::size_t k = names.index(c.first);
    std::vector<PanelOfBand>& panels = out[group[k]].panel;
    auto panel = std::find_if(panels.begin(), panels.end(),
                              [&](const PanelOfBand& p) { return p.first->band == c.first.band; });
    if (panel == panels.end()) panel = panels.insert(panels.end(), {&c.first, {}});
    panel->curve.push_back({place[k], std::move(c.cut)});
  }
  return out;
}

// Values between the centre and the rim: the centre is 0, or below everything where a value lies
// below 0.
struct PolarRange {
  double least = 0, most = 0;
  bool uncertain = false;  // some curve has an input uncertainty
};
PolarRange range_of(const PanelOfBand& panel) {
  PolarRange out;
  for (const PolarCurve& c : panel.curve)
    for (const auto* points : {&c.cut.point, &c.cut.mark})
      for (const PolarPoint& p : *points) {
        const double reach = 2 * std::max(p.error, p.input);
        out.most = std::max(out.most, p.value + reach);
        if (p.value < 0) out.least = std::min(out.least, p.value - reach);
        out.uncertain |= p.input > 0;
      }
  if (out.most <= out.least) out.most = out.least + 1;
  return out;
}

void draw_curves(PolarPanel& panel, const std::vector<PolarCurve>& curves) {
  panel.grid();
  for (const PolarCurve& c : curves) {
    if (c.cut.interpolated)
      panel.band_of(c, curve_stroke(c.place));
    else if (!c.cut.point.empty() && c.cut.point.front().input > 0)
      panel.input_band_of(c, curve_stroke(c.place));
  }
  for (const PolarCurve& c : curves) panel.line_of(c, curve_stroke(c.place));
  panel.radial_labels(curves);
}

}  // namespace

absl::Status write_polar(StoreReader& reader, const Query& query,
                         std::optional<double> elevation_deg, std::string_view format,
                         std::ostream& out, const ExtentOf& extent_of) {
  ASSIGN_OR_RETURN(const auto cuts, polar_cuts(reader, query, elevation_deg, extent_of));
  const QuantityColumns& quantity = columns_of(query.quantity);
  auto writer = make_table_writer(format,
                                  {{"sweep"},
                                   {"season"},
                                   {"time_utc"},
                                   {"band"},
                                   {"range_m"},
                                   {"kind"},
                                   {"aspect_azimuth_deg"},
                                   {"elevation_deg"},
                                   {quantity.value_name},
                                   {quantity.error_name}},
                                  out);
  if (!writer.ok()) return writer.status();
  for (const CutOf& c : cuts.cut) {
    const auto lines = [&](const std::vector<PolarPoint>& points, const char* kind) {
      for (const PolarPoint& p : points)
        (*writer)->row({c.first.sweep, c.first.season, c.first.time_utc, c.first.band,
                        c.first.range_m, std::string(kind), p.azimuth_deg, c.cut.elevation_deg,
                        p.value, p.error});
    };
    if (c.cut.interpolated) lines(c.cut.point, "interpolated");
    lines(c.cut.mark, c.cut.interpolated ? "near" : "stored");
  }
  return (*writer)->finish();
}

absl::StatusOr<std::string> plot_polar(StoreReader& reader, const Query& query,
                                       std::optional<double> asked_elevation_deg,
                                       const ExtentOf& extent_of) {
  ASSIGN_OR_RETURN(auto cuts, polar_cuts(reader, query, asked_elevation_deg, extent_of));
  const std::vector<StoredSignature>& signatures = cuts.signature;
  const double elevation_deg = cuts.cut.front().cut.elevation_deg;
  const QuantityColumns& quantity = columns_of(query.quantity);
  const bool interpolated = std::any_of(cuts.cut.begin(), cuts.cut.end(),
                                        [](const CutOf& c) { return c.cut.interpolated; });
  const std::vector<PolarGroup> groups = groups_of(cuts.cut, signatures);

  std::size_t bands = 1;
  for (const PolarGroup& g : groups) bands = std::max(bands, g.panel.size());
  const std::size_t columns = bands == 1 ? 1 : 2;
  const double panel_width = 900.0 / static_cast<double>(columns);
  const double radius = columns == 1 ? 300 : 165;
  const double panel_height = 2 * radius + 100;
  constexpr std::size_t kLegendColumns = 5;
  const auto legend_height = [](const PolarGroup& g) {
    return 22 * static_cast<double>((g.legend.size() + kLegendColumns - 1) / kLegendColumns);
  };
  const auto height_of = [&](const PolarGroup& g) {
    return 12 + legend_height(g) +
           panel_height * static_cast<double>((g.panel.size() + columns - 1) / columns);
  };
  double height = 62 + 34;
  for (const PolarGroup& g : groups) height += height_of(g);
  const StoredSignature& any = signatures.front();
  const std::string title =
      fmt::format("{}, elevation {:g}\u00b0{}", any.sweep, elevation_deg, range_title(signatures));
  Svg svg(900, height, title);
  svg.text({450, 32}, title, {.size = 19, .anchor = Anchor::kMiddle, .bold = true});

  bool both_sides_of_0 = false, uncertain = false;
  double top = 62;
  for (const PolarGroup& g : groups) {
    draw_legend(svg, {450, top}, g.legend, kLegendColumns);
    for (std::size_t i = 0; i < g.panel.size(); ++i) {
      const double left = panel_width * static_cast<double>(i % columns);
      const double y =
          top + 12 + legend_height(g) + panel_height * static_cast<double>(i / columns);
      const PolarRange range = range_of(g.panel[i]);
      uncertain |= range.uncertain;
      const DisplayUnit unit = display_unit(std::max(range.most, -range.least), quantity.unit);
      const Axis axis = round_axis(range.least, range.most, 5, unit.factor);
      both_sides_of_0 |= axis.low < 0 && axis.high > 0;
      PolarPanel panel(svg, {left + panel_width / 2, y + radius + 62}, radius, axis);
      svg.text(
          {left + panel_width / 2, y + 8},
          fmt::format("{}, {}, in {}", quantity.title, band_title(*g.panel[i].first), unit.name),
          {.size = 15, .anchor = Anchor::kMiddle});
      draw_curves(panel, g.panel[i].curve);
    }
    top += height_of(g);
  }
  std::string caption =
      interpolated ? fmt::format(
                         "Azimuth clockwise from the bow. Curves: interpolated between "
                         "viewpoints, band \u00b12\u03c3. Circles: viewpoints within {:g}\u00b0 "
                         "of the elevation, \u00b12\u03c3.",
                         kNearRingDeg)
                   : "Azimuth clockwise from the bow. Circles: viewpoints, bars \u00b12\u03c3.";
  if (both_sides_of_0) caption += " Dashed: 0.";
  if (uncertain && !interpolated) caption += " Shaded: \u00b12\u03c3 of uncertain inputs.";
  svg.text({450, svg.height_px() - 16}, caption,
           {.size = both_sides_of_0 || uncertain ? 11.0 : 12.0,
            .anchor = Anchor::kMiddle,
            .color = "#555555"});
  return svg.finish();
}

}  // namespace irsig
