#include "core/gas/hot_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/check.h"
#include "core/base/csv_rows.h"
#include "core/gas/gas_bands.h"

namespace irsig {
namespace {

constexpr char kHotLines[] =
#include "gas/hot_lines.txt.inc"
    ;

std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t end = std::min(line.find(' ', begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

double take_number(std::string_view& line) { return finite_number(take_word(line)).value(); }

std::vector<double> take_numbers(std::string_view& line, std::size_t count) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(take_number(line));
  return out;
}

class HotLines {
 public:
  explicit HotLines(std::string_view text) {
    std::vector<std::optional<HotLineBand>>* gas = nullptr;
    HotLineBand* band = nullptr;
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (line.empty() || line.front() == '#') continue;
      std::string_view rest = line;
      const std::string_view first = take_word(rest);
      if (first == "temperatures" || first == "pressures") {
        while (!rest.empty()) {
          (first == "pressures" ? knots.ln_pressure_atm : knots.ln_temperature)
              .push_back(std::log(take_number(rest)));
        }
      } else if (first == "gas") {
        const std::string_view name = take_word(rest);
        gas = name == "H2O" ? &h2o : name == "CO2" ? &co2 : &co;
        gas->resize(kGasBandCount);
      } else if (first == "band") {
        const auto index =
            static_cast<std::size_t>((take_number(rest) - kGasFirstCm1) / kGasBandWidthCm1);
        band = &(*gas)[index].emplace();
        *band = read_shape(rest);
      } else {
        std::string_view row = line;
        for (std::size_t i = 0; i < band->weight.size(); ++i) {
          band->thousandth_ln.push_back(static_cast<std::int32_t>(take_number(row)));
        }
        IRSIG_CHECK(row.empty());
      }
    }
    for (auto* of : {&h2o, &co2, &co}) {
      IRSIG_CHECK(of->size() == kGasBandCount);
      for (auto& b : *of) {
        if (!b) continue;
        IRSIG_CHECK(b->thousandth_ln.size() ==
                    b->weight.size() * knots.ln_temperature.size() * knots.ln_pressure_atm.size());
        add_means(*b);
      }
    }
  }

  [[nodiscard]] const HotLineBand* find(HotGas gas, std::size_t band) const {
    const auto& of = gas == HotGas::kH2o ? h2o : gas == HotGas::kCo2 ? co2 : co;
    return of[band] ? &*of[band] : nullptr;
  }

  HotLineKnots knots;

 private:
  static HotLineBand read_shape(std::string_view& rest) {
    HotLineBand out;
    out.joint = take_word(rest) == "joint";
    out.term_weight = take_numbers(rest, static_cast<std::size_t>(take_number(rest)));
    const std::vector<double> share =
        take_numbers(rest, static_cast<std::size_t>(take_number(rest)));
    double sum = 0, shares = 0;
    for (const double w : out.term_weight) sum += w;
    for (const double s : share) shares += s;
    for (double& w : out.term_weight) w /= sum;
    for (std::size_t i = 0; i < out.term_weight.size(); ++i) {
      for (const double s : share) {
        out.weight.push_back(out.term_weight[i] * s / shares);
        out.term_of.push_back(i);
      }
    }
    return out;
  }

  static void add_means(HotLineBand& band) {
    const std::size_t points = band.weight.size();
    for (std::size_t first = 0; first < band.thousandth_ln.size(); first += points) {
      double sum = 0;
      for (std::size_t n = 0; n < points; ++n)
        sum += band.weight[n] * std::exp(1e-3 * band.thousandth_ln[first + n]);
      band.ln_mean.push_back(std::log(sum));
    }
  }

  std::vector<std::optional<HotLineBand>> h2o, co2, co;
};

const HotLines& hot_lines() {
  static const HotLines table({kHotLines, sizeof kHotLines - 1});
  return table;
}

}  // namespace

const HotLineBand* hot_line_band(HotGas gas, std::size_t band) {
  return hot_lines().find(gas, band);
}

const HotLineKnots& hot_line_knots() { return hot_lines().knots; }

double mean_absorption_m2_mol(const HotLineBand& band, const HotLinePlace& at) {
  double ln = 0;
  for (std::size_t r = 0; r < at.row.size(); ++r) ln += at.weight[r] * band.ln_mean[at.row[r]];
  return std::exp(ln);
}

HotLinePlace hot_line_place(double temperature_k, double pressure_pa) {
  // Four knots around the temperature, at the table's ends those next to them.
  const std::vector<double>&t = hot_line_knots().ln_temperature,
        &p = hot_line_knots().ln_pressure_atm;
  const double x = std::log(temperature_k);
  std::size_t i = 0;
  while (i + 4 < t.size() && x > t[i + 2]) ++i;
  const double y = std::log(pressure_pa / 101325);
  std::size_t j = 0;
  while (j + 2 < p.size() && y > p[j + 1]) ++j;
  const double v = (y - p[j]) / (p[j + 1] - p[j]);
  HotLinePlace out;
  for (std::size_t a = 0; a < 4; ++a) {
    double knot = 1;
    for (std::size_t b = 0; b < 4; ++b) {
      if (b != a) knot *= (x - t[i + b]) / (t[i + a] - t[i + b]);
    }
    out.row[a] = j * t.size() + i + a;
    out.row[4 + a] = out.row[a] + t.size();
    out.weight[a] = knot * (1 - v);
    out.weight[4 + a] = knot * v;
  }
  return out;
}

}  // namespace irsig
