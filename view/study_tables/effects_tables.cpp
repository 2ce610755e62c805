#include "view/study_tables/effects_tables.h"

#include <algorithm>
#include <cmath>

#include "core/accuracy/cost_model.h"
#include "fmt/format.h"
#include "fmt/ranges.h"

namespace irsig {
namespace {

struct Worst {
  const ComparedValue* value = nullptr;
  std::size_t quantity = 0;
};

// The value that comes nearest to what is allowed.
Worst worst_of(std::span<const CheckedView> views) {
  Worst out;
  for (const CheckedView& view : views)
    for (const CheckedRow& row : view.row)
      for (std::size_t q = 0; q < kCompared; ++q)
        if (out.value == nullptr || row.value[q].of_allowed() > out.value->of_allowed())
          out = {&row.value[q], q};
  return out;
}

std::string worst_columns(std::span<const CheckedView> views) {
  const Worst worst = worst_of(views);
  if (worst.value == nullptr) return fmt::format("{:>52}", "no rows");
  const ComparedValue& v = *worst.value;
  return fmt::format("{:<8} {:>10.3g} {:>9.3g} {:>9.3g} {:>7.3f}", kComparedName[worst.quantity],
                     v.difference_w_sr, v.omitted_bound_w_sr, v.paired_stderr_w_sr, v.of_allowed());
}

constexpr const char* kWorstHead = "worst    difference     bound  paired s  of all.";

double ratio_of_first(const EffectsSummary& s) {
  return s.all_first_s > 0 ? s.chosen_first_s / s.all_first_s : 1;
}

std::string off_names(const EffectsSummary& s) {
  std::vector<std::string> names;
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    const EffectInfo& info = info_of(static_cast<Effect>(e));
    const std::size_t rows = s.off[e];
    if (rows == 0) continue;
    names.push_back(rows == s.rows ? std::string(info.name)
                                   : fmt::format("{} ({}/{})", info.name, rows, s.rows));
  }
  return names.empty() ? "-" : fmt::format("{}", fmt::join(names, " "));
}

// Medians over the cells that `wanted` names.
template <typename Wanted>
std::string median_line(const std::string& what, std::span<const MatrixCell> cells,
                        std::span<const CheckedCell> checked, Wanted&& wanted) {
  std::vector<double> ratio, first;
  std::size_t dropped = 0;
  double largest = 0;
  for (std::size_t i = 0; i < checked.size(); ++i) {
    if (!wanted(cells[i], checked[i])) continue;
    const EffectsSummary& s = checked[i].summary;
    ratio.push_back(s.time_ratio());
    first.push_back(ratio_of_first(s));
    dropped += s.drops_reflections ? 1 : 0;
    largest = std::max(largest, s.largest_of_allowed);
  }
  if (ratio.empty()) return "";
  return fmt::format("| {} | {} | {} | {:.2f} | {:.2f} - {:.2f} | {:.2f} | {:.3f} |\n", what,
                     ratio.size(), dropped, quantile(ratio, 0.5), quantile(ratio, 0.25),
                     quantile(ratio, 0.75), quantile(first, 0.5), largest);
}

}  // namespace

std::string effects_view_header() {
  return fmt::format("{:>9} {:>9} {:>8} {:>5} {} {:>10} {:>10} {:>6}  {}", "azimuth", "elevation",
                     "range km", "rows", kWorstHead, "auto s", "all s", "ratio", "left out");
}

std::string effects_view_line(const CheckedView& view) {
  const EffectsSummary s = summary_of({&view, 1});
  return fmt::format("{:>9.2f} {:>9.2f} {:>8.3g} {:>5} {} {:>10.3g} {:>10.3g} {:>6.2f}  {}",
                     view.viewpoint.aspect_azimuth_deg, view.viewpoint.aspect_elevation_deg,
                     view.viewpoint.range_m / 1000, s.rows, worst_columns({&view, 1}), s.chosen_s,
                     s.all_s, s.time_ratio(), off_names(s));
}

std::string effects_cell_header() {
  return fmt::format("{:<42} {} {:>9} {:>9} {:>5} {:>5} {:>6}  {}", "cell", kWorstHead, "auto s",
                     "all s", "ratio", "first", "of ref", "left out");
}

std::string effects_cell_line(const MatrixCell& cell, const CheckedCell& checked) {
  const EffectsSummary& s = checked.summary;
  return fmt::format("{:<42} {} {:>9.3g} {:>9.3g} {:>5.2f} {:>5.2f} {:>6.2f}  {}", cell.name,
                     worst_columns(checked.view), s.chosen_s, s.all_s, s.time_ratio(),
                     ratio_of_first(s), s.largest_of_numerical_error, off_names(s));
}

std::string effects_failures(const std::string& where, const CheckedView& view) {
  std::string out;
  for (const CheckedRow& row : view.row)
    for (std::size_t q = 0; q < kCompared; ++q) {
      const ComparedValue& v = row.value[q];
      const std::string place =
          fmt::format("{} aspect {:.4g}, {:.4g} deg, condition {}, band {}: {}", where,
                      view.viewpoint.aspect_azimuth_deg, view.viewpoint.aspect_elevation_deg,
                      row.condition, row.band, kComparedName[q]);
      if (!(v.of_allowed() <= 1))
        out += fmt::format(
            "out of bound: {} {:.6g} W/sr, with all effects {:.6g}: difference {:.4g}, omitted "
            "bound {:.4g}, paired standard error {:.4g}\n",
            place, v.chosen_w_sr, v.all_w_sr, v.difference_w_sr, v.omitted_bound_w_sr,
            v.paired_stderr_w_sr);
      if (view.referenced && !(v.of_numerical_error() <= 5))
        out += fmt::format(
            "far from the reference: {} {:.6g} W/sr, reference {:.6g} +- {:.2g}: {:.2f} of its "
            "numerical error {:.4g}\n",
            place, v.chosen_w_sr, v.reference_w_sr, v.reference_stderr_w_sr, v.of_numerical_error(),
            v.numerical_error_w_sr);
    }
  return out;
}

std::string effects_off(const EffectsSummary& s) {
  std::string out = fmt::format("left out, of {} rows:", s.rows);
  bool any = false;
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    const EffectInfo& info = info_of(static_cast<Effect>(e));
    const std::size_t rows = s.off[e];
    if (rows == 0) continue;
    out += fmt::format(" {} {}", info.name, rows);
    any = true;
  }
  return any ? out : out + " nothing";
}

std::string effects_matrix_summary(std::span<const MatrixCell> cells,
                                   std::span<const CheckedCell> checked) {
  std::size_t bad_cells = 0, values = 0, referenced = 0, beyond_2 = 0, beyond_5 = 0;
  double largest = 0;
  for (const CheckedCell& c : checked) {
    bad_cells += c.summary.out_of_bound > 0 ? 1 : 0;
    values += c.summary.values;
    referenced += c.summary.referenced;
    beyond_2 += c.summary.beyond_2;
    beyond_5 += c.summary.beyond_5;
    largest = std::max(largest, c.summary.largest_of_numerical_error);
  }
  std::string out = fmt::format("{} cells, {} values: {} cells out of bound\n", checked.size(),
                                values, bad_cells);
  if (referenced > 0)
    out += fmt::format(
        "against the reference: {} values, {} ({:.1f} %) beyond 2 numerical errors, {} beyond 5, "
        "largest {:.2f}\n",
        referenced, beyond_2,
        100.0 * static_cast<double>(beyond_2) / static_cast<double>(referenced), beyond_5, largest);
  out +=
      "\n| cells | count | reflections dropped | time auto/all, median | quartiles | first view | "
      "largest of allowed |\n| --- | --- | --- | --- | --- | --- | --- |\n";
  const auto line = [&](const std::string& what, auto wanted) {
    out += median_line(what, cells, checked, wanted);
  };
  line("all", [](const MatrixCell&, const CheckedCell&) { return true; });
  line("reflections dropped in every row",
       [](const MatrixCell&, const CheckedCell& c) { return c.summary.drops_reflections; });
  line("hard cases",
       [](const MatrixCell& c, const CheckedCell&) { return c.level.empty() && !c.has_gas(); });
  line("hot gas", [](const MatrixCell& c, const CheckedCell&) { return c.has_gas(); });
  for (std::size_t f = 0; f < kMatrixFactors.size(); ++f) {
    std::vector<std::string> levels;
    for (const MatrixCell& c : cells)
      if (!c.level.empty() && std::find(levels.begin(), levels.end(), c.level[f]) == levels.end())
        levels.push_back(c.level[f]);
    for (const std::string& level : levels)
      line(fmt::format("{}: {}", kMatrixFactors[f], level),
           [&](const MatrixCell& c, const CheckedCell&) {
             return !c.level.empty() && c.level[f] == level;
           });
  }
  return out;
}

std::string effect_bounds_header() {
  return "| left out alone | rows | values changed | out of bound | change/bound, median | largest "
         "|\n| --- | --- | --- | --- | --- | --- |\n";
}

std::string effect_bounds_line(Effect effect, std::span<const CheckedCell> checked) {
  std::size_t rows = 0, out_of_bound = 0;
  std::vector<double> share;  // of values that changed for certain
  for (const CheckedCell& cell : checked)
    for (const CheckedView& view : cell.view)
      for (const CheckedRow& row : view.row) {
        if (!row.is_off(effect)) continue;
        ++rows;
        for (const ComparedValue& v : row.value) {
          out_of_bound += v.of_allowed() <= 1 ? 0 : 1;
          const double change = std::abs(v.difference_w_sr);
          if (change > 4 * v.paired_stderr_w_sr + v.rounding_w_sr)
            share.push_back(change / v.omitted_bound_w_sr);
        }
      }
  const std::string name(info_of(effect).name);
  if (share.empty()) return fmt::format("| {} | {} | 0 | {} | - | - |\n", name, rows, out_of_bound);
  return fmt::format("| {} | {} | {} | {} | {:.3g} | {:.3g} |\n", name, rows, share.size(),
                     out_of_bound, quantile(share, 0.5),
                     *std::max_element(share.begin(), share.end()));
}

std::string effects_csv(std::span<const MatrixCell> cells, std::span<const CheckedCell> checked) {
  std::string out = "cell";
  for (const char* factor : kMatrixFactors) out += fmt::format(",{}", factor);
  out +=
      ",aspect_azimuth_deg,aspect_elevation_deg,range_m,band,quantity,chosen_w_sr,all_w_sr,"
      "difference_w_sr,omitted_bound_w_sr,paired_stderr_w_sr,rounding_w_sr,of_allowed,stderr_w_sr,"
      "numerical_error_w_sr,reference_w_sr,reference_stderr_w_sr,of_numerical_error,chosen_s,"
      "all_s,chosen_first_s,all_first_s,chosen_samples,all_samples,reflections,left_out\n";
  for (std::size_t i = 0; i < checked.size(); ++i)
    for (const CheckedView& view : checked[i].view)
      for (const CheckedRow& row : view.row)
        for (std::size_t q = 0; q < kCompared; ++q) {
          const ComparedValue& v = row.value[q];
          out += fmt::format("\"{}\"", cells[i].name);
          for (std::size_t f = 0; f < kMatrixFactors.size(); ++f)
            out += cells[i].level.empty() ? "," : fmt::format(",{}", cells[i].level[f]);
          out += fmt::format(",{},{},{},{},{}", view.viewpoint.aspect_azimuth_deg,
                             view.viewpoint.aspect_elevation_deg, view.viewpoint.range_m,
                             cells[i].scene.band[row.band].name, kComparedName[q]);
          for (const double number : {v.chosen_w_sr, v.all_w_sr, v.difference_w_sr,
                                      v.omitted_bound_w_sr, v.paired_stderr_w_sr, v.rounding_w_sr,
                                      v.of_allowed(), v.stderr_w_sr, v.numerical_error_w_sr})
            out += fmt::format(",{:.9g}", number);
          out += view.referenced ? fmt::format(",{:.9g},{:.9g},{:.9g}", v.reference_w_sr,
                                               v.reference_stderr_w_sr, v.of_numerical_error())
                                 : std::string(",,,");
          const EffectsSummary s = summary_of({&view, 1});
          out += fmt::format(",{:.6g},{:.6g}", view.chosen_s, view.all_s);
          out += view.all_first_s > 0
                     ? fmt::format(",{:.6g},{:.6g}", view.chosen_first_s, view.all_first_s)
                     : std::string(",,");
          out += fmt::format(",{},{},{},{}\n", view.chosen_samples, view.all_samples,
                             row.reflections, off_names(s));
        }
  return out;
}

}  // namespace irsig
