#include "view/band_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "view/axis.h"
#include "view/svg.h"
#include "view/table.h"

namespace irsig {
namespace {

// A window that is as good as the first with less than this is told from it.
constexpr double kTold = 0.05;

Cell number(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

}  // namespace

std::string merit_name(const MeritOf& merit) {
  switch (merit.merit) {
    case Merit::kMean:
      return "mean SNR";
    case Merit::kPercentile:
      return fmt::format("SNR that all but {:g} % exceed", merit.percentile);
    case Merit::kWorst:
      return "worst SNR";
    case Merit::kAbove:
      return fmt::format("share with SNR >= {:g}", merit.threshold);
  }
  return "";
}

absl::Status write_choice(const BandChoice& choice, std::string_view format, std::ostream& out) {
  auto writer = make_table_writer(format,
                                  {{"rank"},
                                   {"lambda_min_um"},
                                   {"lambda_max_um"},
                                   {"merit"},
                                   {"samples_stderr"},
                                   {"numerical_error"},
                                   {"total_error"},
                                   {"best_numerical", false},
                                   {"best"},
                                   {"as_good"}},
                                  out);
  if (!writer.ok()) return writer.status();
  std::uint64_t rank = 0;
  for (const WindowMerit& w : choice.window)
    (*writer)->row({++rank, w.lambda_min_um, w.lambda_max_um, number(w.merit),
                    number(w.samples_stderr), number(w.numerical_error), number(w.total_error),
                    w.best_numerical, w.best, w.as_good});
  return (*writer)->finish();
}

absl::Status write_map(const BandSearch& search, const MeritOf& merit, const BandSearch::Map& map,
                       std::string_view format, std::ostream& out) {
  const bool mean = merit.merit == Merit::kMean;
  std::vector<Column> columns = {{"lambda_min_um"}, {"lambda_max_um"}, {"merit"}};
  if (mean) columns.push_back({"samples_stderr"});
  auto writer = make_table_writer(format, columns, out);
  if (!writer.ok()) return writer.status();
  for (std::size_t w = 0; w < map.merit.size(); ++w) {
    std::vector<Cell> line = {search.edges_um()[map.first[w]], search.edges_um()[map.last[w]],
                              number(map.merit[w])};
    if (mean) line.push_back(number(search.mean_stderr(map.first[w], map.last[w])));
    (*writer)->row(line);
  }
  return (*writer)->finish();
}

std::string plot_map_of_windows(const BandSearch& search, const MeritOf& merit,
                                const BandSearch::Map& map, const std::string& title) {
  constexpr double kLeft = 80, kTop = 80, kSide = 520, kBarX = kLeft + kSide + 30, kBarWidth = 22;
  const std::vector<double>& edge = search.edges_um();
  const Axis axis = tight_axis(edge.front(), edge.back(), 8);
  double low = 0, high = 0;
  std::size_t best = 0;
  for (std::size_t w = 0; w < map.merit.size(); ++w) {
    if (map.merit[w] > map.merit[best]) best = w;
    high = std::max(high, map.merit[w]);
  }
  if (!(high > low)) high = 1;
  const auto x = [&](double um) { return kLeft + kSide * axis.fraction(um); };
  const auto y = [&](double um) { return kTop + kSide * (1 - axis.fraction(um)); };
  Svg svg(kBarX + kBarWidth + 100, kTop + kSide + 70, title);
  svg.text({kLeft + kSide / 2, 32}, title, {.size = 17, .anchor = Anchor::kMiddle, .bold = true});
  svg.text({kLeft + kSide / 2, 55}, merit_name(merit) + " of every window",
           {.size = 13, .anchor = Anchor::kMiddle, .color = "#666666"});
  svg.rect({kLeft, kTop}, kSide, kSide, "#f2f3f5", {"#333333", 1, ""});
  // A window is the cell between its limits and the next ones: left of and below it.
  for (std::size_t w = 0; w < map.merit.size(); ++w) {
    const double x0 = x(edge[map.first[w]]), x1 = x(edge[map.first[w] + 1]),
                 y0 = y(edge[map.last[w]]), y1 = y(edge[map.last[w] - 1]);
    svg.rect({x0, y0}, x1 - x0, y1 - y0, map_color((map.merit[w] - low) / (high - low)),
             {"", 0, ""});
  }
  if (!map.merit.empty()) {
    const Point at{0.5 * (x(edge[map.first[best]]) + x(edge[map.first[best] + 1])),
                   0.5 * (y(edge[map.last[best]]) + y(edge[map.last[best] - 1]))};
    svg.circle(at, 6, "none", {"#ffffff", 3, ""});
    svg.circle(at, 6, "none", {"#000000", 1.5, ""});
  }
  for (std::size_t i = 0; i < axis.tick.size(); ++i) {
    svg.line({x(axis.tick[i]), kTop + kSide}, {x(axis.tick[i]), kTop + kSide + 5},
             {"#333333", 1, ""});
    svg.text({x(axis.tick[i]), kTop + kSide + 21}, axis.label[i],
             {.size = 13, .anchor = Anchor::kMiddle});
    svg.line({kLeft - 5, y(axis.tick[i])}, {kLeft, y(axis.tick[i])}, {"#333333", 1, ""});
    svg.text({kLeft - 9, y(axis.tick[i]) + 4.5}, axis.label[i],
             {.size = 13, .anchor = Anchor::kEnd});
  }
  svg.text({kLeft + kSide / 2, kTop + kSide + 48}, "from [um]",
           {.size = 14, .anchor = Anchor::kMiddle});
  svg.text({24, kTop + kSide / 2}, "to [um]",
           {.size = 14, .anchor = Anchor::kMiddle, .rotate_deg = -90});
  constexpr int kLevels = 64;
  for (int n = 0; n < kLevels; ++n)
    svg.rect({kBarX, kTop + kSide * (1 - (n + 1.0) / kLevels)}, kBarWidth, kSide / kLevels + 0.5,
             map_color((n + 0.5) / kLevels), {"", 0, ""});
  const Axis bar = tight_axis(low, high, 8);
  for (std::size_t i = 0; i < bar.tick.size(); ++i)
    svg.text({kBarX + kBarWidth + 8, kTop + kSide * (1 - bar.fraction(bar.tick[i])) + 4.5},
             bar.label[i], {.size = 13});
  return svg.finish();
}

std::string response_csv(const ResponseTable& response, double lambda_min_um,
                         double lambda_max_um) {
  std::string out = "wavelength_um,response\n";
  const auto add = [&](double um, double value) {
    out += fmt::format("{:.10g},{:.10g}\n", um, value);
  };
  for (std::size_t i = 0; i + 1 < response.size(); ++i) {
    const SpectralPoint &a = response[i], &b = response[i + 1];
    const double from = std::max(a.lambda_um, lambda_min_um),
                 to = std::min(b.lambda_um, lambda_max_um);
    if (!(from < to)) continue;
    const auto value = [&](double um) {
      return a.value + (b.value - a.value) * (um - a.lambda_um) / (b.lambda_um - a.lambda_um);
    };
    if (from == lambda_min_um || i == 0) add(from, value(from));
    add(to, value(to));
  }
  return out;
}

std::vector<std::string> notes_on(const BandChoice& choice, const BandPopulation& population,
                                  const schema::Accuracy& accuracy) {
  std::vector<std::string> out;
  if (population.without_modes > 0)
    out.push_back(fmt::format(
        "of {} of {} rows it is not stored how errors of wavelengths go together (an older irsig, "
        "another range): they are taken as one, the largest that a window's can be",
        population.without_modes, population.row.size()));
  if (choice.window.size() < 2) return out;
  std::size_t alike = 0;
  for (const WindowMerit& w : choice.window)
    if (w.as_good >= kTold) ++alike;
  if (alike < 2) {
    out.push_back("the first window is told from all others");
    return out;
  }
  out.push_back(
      fmt::format("{} of the {} windows compared are not distinguishable: with more than {:g} % "
                  "each is as good "
                  "as the first",
                  alike, choice.window.size(), 100 * kTold));
  if (std::isinf(choice.samples_to_tell)) {
    out.push_back(
        "no number of samples tells the first from the second: what is left are bounds, models and "
        "inputs");
  } else if (choice.samples_to_tell > 1) {
    const std::string line =
        accuracy.has_relative_error()
            ? fmt::format("relative_error = {:.2g}",
                          accuracy.relative_error() / std::sqrt(choice.samples_to_tell))
        : accuracy.has_samples_per_replicate()
            ? fmt::format("samples_per_replicate = {:.0f}",
                          std::ceil(static_cast<double>(accuracy.samples_per_replicate()) *
                                    choice.samples_to_tell))
            : fmt::format("target_paths = {:.2g}",
                          accuracy.target_paths() * choice.samples_to_tell);
    out.push_back(
        fmt::format("{:.2g} x as many samples would tell the first from the second: "
                    "[accuracy] {}",
                    choice.samples_to_tell, line));
  }
  return out;
}

}  // namespace irsig
