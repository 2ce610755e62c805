#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/air_options.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/base/status_macros.h"
#include "core/gas/gas_spectrum.h"
#include "view/base/table.h"
#include "view/plot/plot_curves.h"

// irsig show gas: a column of hot gas, alone and behind air.
namespace irsig {
namespace {

struct GasCommand {
  explicit GasCommand(CLI::App& command)
      : air(command, AirOptions::Use::kHotGas), output(command, {"csv", "json", "text", "svg"}) {
    command.add_option("--temperature-k", temperature_k, "Temperature of the gas: 200 to 3000")
        ->required();
    command.add_option("--pressure-atm", pressure_atm, "0.1 to 2; default 1");
    command.add_option("--length-m", length_m, "Length of the column; default 1");
    command.add_option("--co2", state.co2, "Mole fraction; default 0");
    command.add_option("--h2o", state.h2o, "Mole fraction; default 0");
    command.add_option("--co", state.co, "Mole fraction; default 0");
    command.add_option("--soot", state.soot, "Volume fraction; default 0");
    command
        .add_option(
            "--range-m", range_m,
            "As seen from this range, behind air (--profile ...) at one height as well; 0 to 1e6")
        ->type_name("R");
    command.add_option("--altitude-m", height_m, "Altitude of that air above the sea; default 0");
    command.add_option("--lambda-min-um", lambda_min_um,
                       "Shortest wavelength (default: 2, with air 2.94)");
    command.add_option("--lambda-max-um", lambda_max_um,
                       "Longest wavelength (default: 20, with air 15.4)");
  }

  AirOptions air;
  OutputOptions output;
  GasState state;
  double temperature_k = 0, pressure_atm = 1, length_m = 1, height_m = 0;
  std::optional<double> range_m, lambda_min_um, lambda_max_um;

  [[nodiscard]] absl::Status run() {
    state.temperature_k = temperature_k;
    state.pressure_pa = 101325 * pressure_atm;
    if (state.co2 + state.h2o + state.co + state.soot == 0) {
      return absl::InvalidArgumentError(
          "nothing absorbs: one of --co2, --h2o, --co, --soot is missing");
    }
    ASSIGN_OR_RETURN(const auto bands, chosen_bands());
    const std::vector<GasLayer> column = {{state, length_m}};
    ASSIGN_OR_RETURN(const auto alone, gas_spectrum(column, bands));
    // So thin that absorptance is absorption times length.
    constexpr double kThinM = 1e-9;
    const auto thin = gas_spectrum(std::vector<GasLayer>{{state, kThinM}}, bands);
    if (!thin.ok()) return thin.status();
    std::vector<double> absorption_per_m = thin->absorptance;
    for (double& x : absorption_per_m) x /= kThinM;
    std::optional<GasThroughAir> behind;
    std::string subtitle = composition();
    if (range_m) {
      ASSIGN_OR_RETURN(const auto chosen, air.choose());
      if (!(*range_m >= 0 && *range_m <= 1e6 && height_m >= 0 && height_m <= 1e5)) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "--range-m %g, --altitude-m %g: expected 0 to 1e6, 0 to 1e5", *range_m, height_m));
      }
      if (chosen.weather.cloud_cover > 0) {
        std::fprintf(stderr,
                     "irsig: warning: hot gas is seen through clear air; the cloud of %s is left "
                     "out\n",
                     chosen.title.c_str());
      }
      const AbsorberAmounts amounts = chosen.atmosphere.amounts(level_path(height_m, *range_m));
      ASSIGN_OR_RETURN(behind, gas_through_air(column, amounts, bands));
      absl::StrAppend(&subtitle, absl::StrFormat("; behind %g km of %s at %g m", *range_m / 1000,
                                                 chosen.title, height_m));
    } else if (air.given()) {
      return absl::InvalidArgumentError("an air is described, but --range-m is missing");
    }
    return output.write([&](std::string_view format, std::ostream& out) -> absl::Status {
      if (format == "svg") {
        out << draw(alone, behind, subtitle);
        return absl::OkStatus();
      }
      return write(alone, absorption_per_m, behind, format, out);
    });
  }

 private:
  [[nodiscard]] absl::StatusOr<GasBands> chosen_bands() const {
    const double low = lambda_min_um.value_or(range_m ? 1e4 / 3400 : 2);
    const double high = lambda_max_um.value_or(range_m ? 1e4 / 650 : 20);
    const GasBands most = range_m ? kAirGasBands : GasBands{};
    GasBands bands = {most.last, most.first};
    for (std::size_t b = most.first; b < most.last; ++b) {
      const double um = gas_band_lambda_um(b);
      if (um < low || um > high) continue;
      bands.first = std::min(bands.first, b);
      bands.last = std::max(bands.last, b + 1);
    }
    if (bands.first < bands.last) return bands;
    return absl::InvalidArgumentError(absl::StrFormat(
        "no band between --lambda-min-um %g and --lambda-max-um %g: the table covers %.4g to %.4g "
        "um",
        low, high, gas_band_lambda_um(most.last - 1), gas_band_lambda_um(most.first)));
  }

  [[nodiscard]] std::string composition() const {
    std::string out = absl::StrFormat("%g K, %g atm, %g m", temperature_k, pressure_atm, length_m);
    const auto add = [&](const char* name, double value) {
      if (value > 0) absl::StrAppend(&out, absl::StrFormat(", %s %g", name, value));
    };
    add("CO\u2082", state.co2);
    add("H\u2082O", state.h2o);
    add("CO", state.co);
    add("soot", state.soot);
    return out;
  }

  static absl::Status write(const GasSpectrum& alone, const std::vector<double>& absorption_per_m,
                            const std::optional<GasThroughAir>& behind, std::string_view format,
                            std::ostream& out) {
    std::vector<Column> heads = {{"wavenumber_cm1"}, {"lambda_um"},  {"absorption_per_m"},
                                 {"transmittance"},  {"emissivity"}, {"radiance_w_m2_sr_um"}};
    if (behind) {
      heads.insert(heads.end(), {{"air_transmittance"},
                                 {"apparent_radiance_w_m2_sr_um"},
                                 {"model_error_water_correlation_w_m2_sr_um"}});
    }
    ASSIGN_OR_RETURN(auto writer, make_table_writer(format, heads, out));
    for (std::size_t i = alone.bands.size(); i-- > 0;) {  // increasing wavelength
      const std::size_t b = alone.bands.first + i;
      std::vector<Cell> row = {gas_band_centre_cm1(b), gas_band_lambda_um(b),
                               absorption_per_m[i],    alone.transmittance[i],
                               alone.absorptance[i],   alone.radiance_w_m2_sr_um[i]};
      if (behind) {
        row.insert(row.end(),
                   {behind->air_transmittance[i], behind->spectrum.radiance_w_m2_sr_um[i],
                    behind->water_correlation_error_w_m2_sr_um[i]});
      }
      writer->row(row);
    }
    return writer->finish();
  }

  static std::string draw(const GasSpectrum& alone, const std::optional<GasThroughAir>& behind,
                          const std::string& subtitle) {
    const auto curve = [&](const char* name, const std::vector<double>& value) {
      Curve out{name, {}, {}};
      for (std::size_t i = alone.bands.size(); i-- > 0;) {
        out.x.push_back(gas_band_lambda_um(alone.bands.first + i));
        out.y.push_back(value[i]);
      }
      return out;
    };
    CurvePanel emissivity{"Emissivity of the column",
                          "Wavelength in \u00b5m",
                          "Mean over 10 cm\u207b\u00b9",
                          {curve("gas", alone.absorptance)},
                          0,
                          1};
    CurvePanel radiance{"Radiance",
                        "Wavelength in \u00b5m",
                        "W/(m\u00b2 sr \u00b5m)",
                        {curve("gas", alone.radiance_w_m2_sr_um)}};
    if (behind) {
      emissivity.curve.push_back(curve("air: transmittance", behind->air_transmittance));
      radiance.curve.push_back(curve("behind air", behind->spectrum.radiance_w_m2_sr_um));
    }
    return plot_curves("Hot gas", subtitle, {emissivity, radiance}, 1);
  }
};

}  // namespace

void add_show_gas(CLI::App& show, int& exit_code) {
  CLI::App* command = show.add_subcommand(
      "gas",
      "Absorption and emission of a column of hot CO2, H2O, CO and soot, alone or behind air");
  const auto asked = std::make_shared<GasCommand>(*command);
  command->footer(
      "csv, json and text have one line for each band of 10 cm-1. absorption_per_m is the mean of "
      "a\n"
      "thin layer; the column's emissivity grows more slowly, because its lines saturate.");
  command->callback([asked, &exit_code] {
    absl::Status status = asked->run();
    if (!status.ok())
      status = absl::Status(status.code(), absl::StrCat("show gas: ", status.message()));
    exit_code = report(status);
  });
}

}  // namespace irsig
