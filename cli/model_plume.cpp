#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_join.h"
#include "cli/commands.h"
#include "cli/output_options.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "core/plume/generate_plume.h"
#include "core/plume/plume_field.h"
#include "core/plume/plume_silhouette.h"
#include "core/plume/vdb_subprocess.h"
#include "view/base/print.h"

namespace irsig {
namespace {

// Kinds of plumes as bits, for what each has.
enum : unsigned { kFunnel = 1, kSlab = 2, kCylinder = 4, kSphere = 8, kBody = 14, kAll = 15 };
constexpr const char* kKinds[] = {"funnel", "slab", "cylinder", "sphere"};

struct Dimension {
  CLI::Option* option = nullptr;
  unsigned has = 0, needs = 0;
};

struct PlumeCommand {
  explicit PlumeCommand(CLI::App& command) : output(command, {"vdb"}) {
    output.out_option()->required();
    const auto add = [&](const char* name, double& value, unsigned has, unsigned needs,
                         const char* type, const char* text) {
      dimensions.push_back({command.add_option(name, value, text)->type_name(type), has, needs});
      if (needs == 0) dimensions.back().option->capture_default_str();
    };
    add("--temperature-k", temperature_k, kAll, kAll, "K",
        "Temperature of the gas; funnel: at the opening");
    add("--voxel-m", voxel_m, kAll, kAll, "M", "Edge of a voxel");
    add("--length-m", length_m, kFunnel | kSlab | kCylinder, kFunnel | kSlab | kCylinder, "M",
        "Length along x of a slab or cylinder; funnel: of the plume's axis");
    add("--pressure-pa", pressure_pa, kAll, 0, "PA", "Pressure of gas and air");
    add("--opening-diameter-m", funnel.exit.diameter_m, kFunnel, kFunnel, "M",
        "Diameter of the opening");
    add("--velocity-m-s", funnel.exit.velocity_m_s, kFunnel, kFunnel, "M/S",
        "Upwards, at the opening");
    add("--air-temperature-k", funnel.air_temperature_k, kFunnel, 0, "K",
        "Temperature of the air around");
    add("--wind-m-s", funnel.wind_m_s, kFunnel, kFunnel, "M/S", "True wind");
    add("--wind-from-deg", funnel.wind_from_deg, kFunnel, 0, "DEG",
        "Where the wind comes from: 0 from ahead, 90 from starboard");
    add("--ship-speed-m-s", funnel.ship_speed_m_s, kFunnel, 0, "M/S", "Ahead");
    add("--hydrogen-per-carbon", funnel.exhaust.hydrogen_per_carbon, kFunnel, 0, "NUMBER",
        "Atoms in the fuel");
    add("--excess-air", funnel.exhaust.excess_air, kFunnel, kFunnel, "NUMBER",
        "More air than the fuel needs, as a share of that (diesel at load: about 1.2)");
    add("--carbon-as-co", funnel.exhaust.carbon_as_co, kFunnel, 0, "NUMBER",
        "Share of the fuel's carbon");
    add("--soot-g-per-kg", funnel.exhaust.soot_g_per_kg, kFunnel, 0, "G/KG",
        "Soot from a kg of fuel");
    add("--width-m", body.width_m, kSlab, kSlab, "M", "Width along y");
    add("--height-m", body.height_m, kSlab, kSlab, "M", "Height along z");
    add("--radius-m", body.radius_m, kCylinder | kSphere, kCylinder | kSphere, "M",
        "Radius of a cylinder or sphere");
    add("--co2", body.co2, kBody, 0, "NUMBER", "Mole fraction");
    add("--h2o", body.h2o, kBody, 0, "NUMBER", "Mole fraction");
    add("--co", body.co, kBody, 0, "NUMBER", "Mole fraction");
    add("--soot", body.soot, kBody, 0, "NUMBER", "Volume fraction");
  }

  std::string kind;
  FunnelPlume funnel;
  UniformPlume body;
  double temperature_k = 0, voxel_m = 0, length_m = 0, pressure_pa = 101325;
  std::vector<Dimension> dimensions;
  OutputOptions output;

  [[nodiscard]] absl::Status run() {
    RETURN_IF_ERROR(check_options());
    ASSIGN_OR_RETURN(const GeneratedPlume made, generate());
    ASSIGN_OR_RETURN(const std::string file, write_vdb_apart(made.volume));
    RETURN_IF_ERROR(output.write(file));
    return print(made, file.size());
  }

 private:
  [[nodiscard]] absl::Status check_options() const {
    unsigned bit = 0;
    for (std::size_t k = 0; k < std::size(kKinds); ++k)
      if (kind == kKinds[k]) bit = 1U << k;
    std::vector<std::string> missing, foreign;
    for (const Dimension& d : dimensions) {
      if (d.option->count() == 0 && (d.needs & bit) != 0) missing.push_back(d.option->get_name());
      if (d.option->count() > 0 && (d.has & bit) == 0) foreign.push_back(d.option->get_name());
    }
    if (!missing.empty())
      return absl::InvalidArgumentError(kind + " needs " + absl::StrJoin(missing, ", "));
    if (!foreign.empty())
      return absl::InvalidArgumentError(kind + " has no " + absl::StrJoin(foreign, ", "));
    return absl::OkStatus();
  }

  [[nodiscard]] absl::StatusOr<GeneratedPlume> generate() {
    if (kind == "funnel") {
      funnel.exit.temperature_k = temperature_k;
      funnel.air_pressure_pa = pressure_pa;
      funnel.length_m = length_m;
      funnel.voxel_m = voxel_m;
      return generate_funnel_plume(funnel);
    }
    body.kind = kind;
    body.temperature_k = temperature_k;
    body.pressure_pa = pressure_pa;
    body.length_m = length_m;
    body.voxel_m = voxel_m;
    return generate_uniform_plume(body);
  }

  [[nodiscard]] absl::Status print(const GeneratedPlume& made, std::size_t bytes) const {
    ASSIGN_OR_RETURN(const auto field, plume_of(made.volume, made.grids));
    std::FILE* to = output.out() == "-" ? stderr : stdout;  // the file itself is there
    const PlumeReport& r = field->report();
    print_plain(
        to, fmt::format("{}: {} bytes, {} voxels of gas of {:g} m, {:.6g} to {:.6g} K\n",
                        one_line(output.out()), bytes, r.gas_voxels, voxel_m, r.least_k, r.most_k));
    Vec<Body> low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (const Vec<Body>& c : gas_corners(*field)) {
      low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
    }
    print_plain(to,
                fmt::format("x forward {:.6g} to {:.6g} m, y starboard {:.6g} to {:.6g} m, z down "
                            "{:.6g} to {:.6g} m\n",
                            low.x, high.x, low.y, high.y, low.z, high.z));
    print_plain(to, fmt::format("co2 {:.6g} mol  h2o {:.6g} mol  co {:.6g} mol  soot {:.6g} m3\n",
                                r.amount[0], r.amount[1], r.amount[2], r.amount[3]));
    if (made.axis.empty()) return absl::OkStatus();
    const PlumeStation& end = made.axis.back();
    const Vec<Body> wind =
        relative_wind(funnel.wind_m_s, funnel.wind_from_deg, funnel.ship_speed_m_s);
    print_plain(
        to, fmt::format("relative wind {:.6g} m/s; at the end {:.6g} m downwind, {:.6g} m above "
                        "the opening, radius {:.6g} m, exhaust diluted {:.6g} times\n",
                        length(wind), end.x_m, end.height_m, end.radius_m, 1 / end.share));
    return absl::OkStatus();
  }
};

}  // namespace

void add_model_plume(CLI::App& model, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "plume", "Hot gas as an OpenVDB file: a funnel's plume in the wind, or a homogeneous body");
  const auto options = std::make_shared<PlumeCommand>(*command);
  command->add_option("KIND", options->kind, absl::StrJoin(kKinds, ", "))
      ->required()
      ->type_name("NAME")
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(kKinds), std::end(kKinds))));
  command->callback([options, &exit_code] { exit_code = report(options->run()); });
}

}  // namespace irsig
