// irsig-gas-table HOT AIR [GAS ...]: makes core/gas/data/hot_lines.txt (HOT) line by line, and
// replaces the entries of carbon dioxide at 2140-2430 cm-1 in core/atmosphere/data/gas_table.txt
// (AIR) by terms of the same lines, so that what is hot and what is cold share their wavenumbers.
// Half an hour, nearly all of it for H2O. Where gases are named, HOT's others stay as they are;
// with "-" for HOT the air alone, seconds.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>

#include "core/base/check.h"
#include "core/gas/lines/absorption.h"
#include "core/gas/lines/co2_lines.h"
#include "core/gas/lines/co_lines.h"
#include "core/gas/lines/cold_fit.h"
#include "core/gas/lines/joint_terms.h"
#include "core/gas/lines/water_lines.h"

namespace irsig {
namespace {

constexpr double kM2MolPerCm2 = 6.02214076e19;  // per molecule: cm2 -> m2/mol
constexpr double kBandCm1 = 10, kStepCm1 = 0.0025;
constexpr std::size_t kPoints = 4000;
// Where plumes are: dense where absorption changes fastest.
constexpr double kTemperatureK[] = {200, 240,  300,  370,  460,  580, 740,
                                    950, 1200, 1550, 2000, 2500, 3000};
constexpr double kPressureAtm[] = {0.1, 0.4, 1, 2};

// Bands of the table for one gas.
struct Plan {
  const char* name;
  LineShape shape;
  std::vector<SpectralLine> (*lines)(double, double);
  double first_cm1, last_cm1;              // bands
  double joint_first_cm1, joint_last_cm1;  // those that share the cold air's terms
  std::vector<double> bins;                // of each term, from the weakest
  bool with_air = true;                    // terms are the cold air's
};
// Bands without terms have one term, and finer bins.
const std::vector<double> kBinsAlone = {0.3, 0.2, 0.15, 0.12, 0.1, 0.07, 0.04, 0.02};

std::vector<double> absorption(const Plan& plan, double temperature_k, double pressure_atm) {
  const WavenumberGrid grid{
      plan.first_cm1, kStepCm1,
      static_cast<std::size_t>((plan.last_cm1 - plan.first_cm1) / kBandCm1) * kPoints};
  // Hot gas has a million lines, of which those that are weaker than this add less than 1e-3.
  const double weakest = temperature_k < 400 ? 1e-28 : temperature_k < 900 ? 1e-27 : 3e-27;
  std::vector<double> k = absorption_cm2(plan.lines(temperature_k, weakest), plan.shape,
                                         temperature_k, pressure_atm, grid);
  for (double& x : k) x *= kM2MolPerCm2;
  return k;
}

// ---- the cold air's terms of carbon dioxide

constexpr double kColdK = 288.15;

struct ColdBand {
  ColdTerms terms;
  std::string entry;  // of gas_table.txt
};

// Terms of equal ratios of absorption at the surface; their absorption is that which shows where a
// term's depth is about 1. How it changes with pressure and temperature is fitted.
std::map<int, ColdBand> cold_bands(const Plan& plan) {
  struct State {
    double pressure_atm, temperature_k, importance;
  };
  // The standard atmosphere's own, warmer and colder days, and above 8 km what is thin there.
  constexpr State kStates[] = {{1, 288.15, 2},   {1, 305, 0.5}, {1, 260, 1},     {1, 235, 0.4},
                               {0.85, 280, 2},   {0.7, 268, 2}, {0.7, 288, 0.5}, {0.7, 250, 0.5},
                               {0.54, 256, 2},   {0.4, 243, 1}, {0.3, 229, 0.7}, {0.15, 217, 0.3},
                               {0.05, 217, 0.15}};
  const std::vector<double> reference = absorption(plan, kColdK, 1);
  const std::array<std::vector<double>, kThroughColdAir> hot = {absorption(plan, 400, 1),
                                                                absorption(plan, 700, 1)};
  std::vector<std::vector<double>> in_state;
  for (const State& s : kStates)
    in_state.push_back(absorption(plan, s.temperature_k, s.pressure_atm));
  std::map<int, ColdBand> out;
  for (double low = plan.joint_first_cm1; low < plan.joint_last_cm1; low += kBandCm1) {
    const auto first = static_cast<std::size_t>((low - plan.first_cm1) / kBandCm1) * kPoints;
    ColdBand band{terms_by_ratio(&reference[first], first, kPoints, 16), ""};
    std::vector<double> k;
    std::array<std::vector<double>, kThroughColdAir> hot_fraction;
    std::array<double, kThroughColdAir> sent{};
    for (std::size_t h = 0; h < hot.size(); ++h) {
      for (std::size_t i = 0; i < kPoints; ++i) sent[h] += hot[h][first + i];
    }
    for (const auto& point : band.terms.point) {
      k.push_back(effective(reference, point, reference[point[point.size() / 2]]));
      for (std::size_t h = 0; h < hot.size(); ++h) {
        double sum = 0;
        for (const std::uint32_t p : point) sum += hot[h][p];
        hot_fraction[h].push_back(sum / sent[h]);
      }
    }
    double mean = 0;
    for (std::size_t i = 0; i < kPoints; ++i) mean += reference[first + i] / kPoints;
    std::vector<ColdState> states;
    for (std::size_t j = 0; j < std::size(kStates); ++j) {
      ColdState& s = states.emplace_back(ColdState{kStates[j].pressure_atm,
                                                   kStates[j].temperature_k,
                                                   kStates[j].importance,
                                                   {},
                                                   {},
                                                   {},
                                                   {}});
      for (std::size_t i = 0; i < k.size(); ++i) {
        const auto& point = band.terms.point[i];
        s.ratio.push_back(effective(in_state[j], point, reference[point[point.size() / 2]]) / k[i]);
      }
      for (const double depth : {0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0}) {
        const double amount = depth / mean;
        double t = 0;
        std::array<double, kThroughColdAir> through{};
        for (std::size_t i = 0; i < kPoints; ++i) {
          const double passed = std::exp(-in_state[j][first + i] * amount);
          t += passed / kPoints;
          for (std::size_t h = 0; h < hot.size(); ++h)
            through[h] += hot[h][first + i] * passed / sent[h];
        }
        s.amount.push_back(amount);
        s.transmittance.push_back(t);
        for (std::size_t h = 0; h < hot.size(); ++h) s.hot_through[h].push_back(through[h]);
      }
    }
    const ColdFit fit = fit_cold_band(k, band.terms.weight, kColdK, hot_fraction, states);
    std::ostringstream entry;
    entry.precision(6);
    entry << static_cast<int>(low) << " 101325 " << kColdK << " 0 " << fit.first.a << ' '
          << fit.first.b << ' ' << fit.first.c << ' ' << k.size();
    for (std::size_t i = 0; i < k.size(); ++i) {
      const double m2_kg = k[i] / (plan.shape.molar_mass_g * 1e-3);
      entry << ' ' << m2_kg * fit.share[i] << ' ' << m2_kg * (1 - fit.share[i]) << ' '
            << band.terms.weight[i];
    }
    entry << ' ' << fit.second.a << ' ' << fit.second.b << ' ' << fit.second.c;
    band.entry = entry.str();
    out[static_cast<int>(low)] = std::move(band);
  }
  return out;
}

// gas_table.txt with these entries of CO2 instead of its own, and without its far wing there.
void rewrite_air(const std::string& name, const std::map<int, ColdBand>& bands) {
  std::ifstream in(name);
  IRSIG_CHECK(in.good());
  std::ostringstream out;
  std::string gas;
  bool far_wing = false;
  auto next = bands.end();
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    const bool of_band = !word.empty() && std::isdigit(static_cast<unsigned char>(word[0])) != 0;
    if (gas == "CO2") {
      const int low = of_band ? std::stoi(word) : 1000000;
      for (; next != bands.end() && next->first <= low; ++next) out << next->second.entry << '\n';
      if (of_band && bands.contains(low)) continue;
    }
    // Their wings beyond the band's head were a continuum of their own.
    if (far_wing && of_band && bands.contains(std::stoi(word))) continue;
    if (!of_band) {
      gas.clear();
      if (word == "gas") words >> gas;
      far_wing = word == "collision" && line.find("CO2") != std::string::npos;
      if (gas == "CO2") next = bands.begin();
    }
    out << line << '\n';
  }
  in.close();
  std::ofstream(name) << out.str();
}

// ---- the hot table

ColdTerms alone(std::size_t first) {
  ColdTerms out;
  out.weight = {1};
  auto& point = out.point.emplace_back();
  for (std::size_t i = 0; i < kPoints; ++i) point.push_back(static_cast<std::uint32_t>(first + i));
  return out;
}

// Water's terms: wavenumbers sorted by what gas of 400 K absorbs and cut into shares, each sorted
// by gas of 1500 K and cut again; the same at all temperatures, so that what a cool rim absorbs of
// hotter gas behind it is met. Sorted at each temperature anew, bins of hot and cool gas have more
// in common than their lines: 500-700 K absorbed 1.2 to 1.8 times too much of 1500 K. Cool gas has
// few lines, hence the small shares at its end.
std::map<int, ColdTerms> water_terms(const Plan& plan) {
  const std::vector<double> cool = absorption(plan, 400, 1), hot = absorption(plan, 1500, 1);
  std::map<int, ColdTerms> out;
  for (double low = plan.first_cm1; low < plan.last_cm1; low += kBandCm1) {
    const auto first = static_cast<std::size_t>((low - plan.first_cm1) / kBandCm1) * kPoints;
    out[static_cast<int>(low)] =
        nested_terms(&cool[first], hot, first, kPoints, {0.45, 0.25, 0.15, 0.09, 0.04, 0.02},
                     {0.4, 0.3, 0.2, 0.1});
  }
  return out;
}

// Returns the section of each gas in a file of hot lines.
std::map<std::string, std::string> sections(const std::string& name) {
  std::ifstream in(name);
  std::map<std::string, std::string> out;
  std::string gas;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("gas ")) gas = line.substr(4);
    if (!gas.empty()) out[gas] += line + '\n';
  }
  return out;
}

void print(std::ostream& out, const Plan& plan, const std::map<int, ColdTerms>& joint) {
  std::map<int, std::vector<std::string>> rows;
  for (const double p : kPressureAtm) {
    for (const double t : kTemperatureK) {
      const std::vector<double> k = absorption(plan, t, p);
      std::printf("%s %g K %g atm\n", plan.name, t, p);
      std::fflush(stdout);
      for (double low = plan.first_cm1; low < plan.last_cm1; low += kBandCm1) {
        const int band = static_cast<int>(low);
        const auto first = static_cast<std::size_t>((low - plan.first_cm1) / kBandCm1) * kPoints;
        const auto it = joint.find(band);
        std::string row;
        for (const double x : it != joint.end() ? hot_bins(k, it->second, plan.bins)
                                                : hot_bins(k, alone(first), kBinsAlone)) {
          row += (row.empty() ? "" : " ") +
                 std::to_string(std::lround(1000 * std::log(std::fmax(x, 1e-12))));
        }
        rows[band].push_back(row);
      }
    }
  }
  out << "gas " << plan.name << '\n';
  for (const auto& [band, lines] : rows) {
    const auto it = joint.find(band);
    const std::vector<double>& bins = it != joint.end() ? plan.bins : kBinsAlone;
    const std::vector<double> weight =
        it != joint.end() ? it->second.weight : std::vector<double>{1};
    out << "band " << band << (it != joint.end() && plan.with_air ? " joint " : " alone ")
        << weight.size();
    for (const double w : weight) out << ' ' << w;
    out << ' ' << bins.size();
    for (const double b : bins) out << ' ' << b;
    out << '\n';
    for (const std::string& line : lines) out << line << '\n';
  }
}

int run(const std::string& hot, const std::string& air, const std::set<std::string>& asked) {
  const Plan co2{"CO2",
                 kCo2Shape,
                 [](double t, double weakest) { return co2_lines(Co2Region::k4um, t, weakest); },
                 1970,
                 2460,
                 2140,
                 2430,
                 {0.4, 0.3, 0.2, 0.1}};
  const Plan co2_long{"CO2",
                      kCo2Shape,
                      [](double t, double weakest) { return co2_lines(Co2Region::k15um, t, weakest); },
                      500,
                      880,
                      0,
                      0,
                      {}};
  const Plan co2_window{"CO2",
                        kCo2Shape,
                        [](double t, double weakest) { return co2_lines(Co2Region::k10um, t, weakest); },
                        880,
                        1110,
                        0,
                        0,
                        {}};
  const Plan water{"H2O", kWaterShape, water_lines, 50, 7000, 0, 0, {1}, false};
  // The cold air's eight terms of core/atmosphere/data/co_lines.py, made at 250 K and 500 hPa.
  const Plan co{"CO", kCoShape, co_lines, 1750, 2350, 1900, 2300, {0.4, 0.3, 0.2, 0.1}};
  const std::vector<double> shares = {0.25, 0.25, 0.2, 0.13, 0.08, 0.05, 0.025, 0.015};

  const std::map<int, ColdBand> cold = cold_bands(co2);
  rewrite_air(air, cold);
  if (hot == "-") return 0;  // the air alone
  std::map<int, ColdTerms> co2_terms, co_terms;
  for (const auto& [band, b] : cold) co2_terms[band] = b.terms;
  const std::vector<double> cold_co = absorption(co, 250, 50000 / 101325.0);
  std::ifstream table(air);
  std::string gas;
  for (std::string line; std::getline(table, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "gas") {
      words >> gas;
    } else if (gas == "CO" && !word.empty() &&
               std::isdigit(static_cast<unsigned char>(word[0])) != 0) {
      const auto first =
          static_cast<std::size_t>((std::stod(word) - co.first_cm1) / kBandCm1) * kPoints;
      co_terms[std::stoi(word)] = terms_by_share(&cold_co[first], first, kPoints, shares);
    } else if (word == "continuum") {
      break;
    }
  }
  const std::map<std::string, std::string> old =
      asked.empty() ? std::map<std::string, std::string>() : sections(hot);
  std::ofstream out(hot);
  out << "# irsig hot lines 1: absorption of hot gas in 10 cm-1 bands by the cold air's terms; "
         "made by irsig-gas-table,\n"
         "# format in README.md. Computed line by line from molecular constants; no line list is "
         "in it.\n";
  out << "temperatures";
  for (const double t : kTemperatureK) out << ' ' << t;
  out << "\npressures";
  for (const double p : kPressureAtm) out << ' ' << p;
  out << '\n';
  const auto remade = [&](const Plan& plan) {
    if (asked.empty() || asked.contains(plan.name)) return true;
    const auto kept = old.find(plan.name);
    IRSIG_CHECK(kept != old.end());
    out << kept->second;
    return false;
  };
  if (remade(co2)) {
    print(out, co2_long, {});
    print(out, co2_window, {});
    print(out, co2, co2_terms);
  }
  if (remade(co)) print(out, co, co_terms);
  if (remade(water)) print(out, water, water_terms(water));
  return out.good() ? 0 : 1;
}

}  // namespace
}  // namespace irsig

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: irsig-gas-table HOT_LINES.txt GAS_TABLE.txt [CO2] [CO] [H2O]\n");
    return 2;
  }
  return irsig::run(argv[1], argv[2], {argv + 3, argv + argc});
}
