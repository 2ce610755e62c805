#include "core/plume/plume_grids.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/base/problems.h"
#include "fmt/format.h"

namespace irsig {
namespace {

struct Unit {
  std::string_view name;
  double scale, offset;
};
constexpr Unit kTemperatureUnits[] = {{"K", 1, 0}, {"degC", 1, 273.15}};
constexpr Unit kPressureUnits[] = {
    {"Pa", 1, 0}, {"hPa", 100, 0}, {"kPa", 1000, 0}, {"bar", 1e5, 0}, {"atm", 101325, 0}};
constexpr Unit kFractionUnits[] = {{"1", 1, 0}, {"percent", 0.01, 0}, {"ppm", 1e-6, 0}};

template <std::size_t N>
std::string names_of(const Unit (&units)[N]) {
  std::string out;
  for (std::size_t i = 0; i < N; ++i)
    out += fmt::format("{}{}", i == 0 ? "" : i + 1 == N ? " or " : ", ", units[i].name);
  return out;
}

class Checker {
 public:
  Checker(PlumeReading& reading, Problems& wrong) : reading_(reading), wrong_(wrong) {}

  template <std::size_t N>
  PlumeQuantity check(const char* name, const GridOrConstant& said, const Unit (&units)[N],
                      double least, double most) {
    PlumeQuantity out;
    out.name = name;
    const Unit* unit = std::find_if(std::begin(units), std::end(units),
                                    [&](const Unit& u) { return u.name == said.unit; });
    if (unit == std::end(units)) {
      wrong_.add(
          keyed_problem(name, fmt::format("unit \"{}\", expected {}", said.unit, names_of(units))));
      return out;
    }
    out.scale = unit->scale;
    out.offset = unit->offset;
    if (said.grid.empty() == !said.constant) {
      wrong_.add(keyed_problem(
          name, said.constant ? "both a grid and a constant, expected one of them"
                              : "neither a grid nor a constant; for none of it, constant 0"));
    } else if (said.constant) {
      out.constant = out.scale * *said.constant + out.offset;
      // Written so that NaN is outside.
      if (!(out.constant >= least && out.constant <= most))
        wrong_.add(keyed_problem(
            name, fmt::format("constant {} {}, expected {:g} to {:g} {}", *said.constant,
                              unit->name, (least - out.offset) / out.scale,
                              (most - out.offset) / out.scale, unit->name)));
    } else if (std::find(reading_.grid.begin(), reading_.grid.end(), said.grid) !=
               reading_.grid.end()) {
      wrong_.add(
          keyed_problem(name, fmt::format("grid \"{}\" is another quantity already", said.grid)));
    } else {
      out.channel = static_cast<int>(reading_.grid.size());
      reading_.grid.push_back(said.grid);
    }
    return out;
  }

 private:
  PlumeReading& reading_;
  Problems& wrong_;
};

std::optional<std::array<double, 3>> axis_of(std::string_view name) {
  if (name.size() != 2 || (name[0] != '+' && name[0] != '-')) return std::nullopt;
  std::array<double, 3> axis{};
  if (name[1] < 'x' || name[1] > 'z') return std::nullopt;
  axis[static_cast<std::size_t>(name[1] - 'x')] = name[0] == '+' ? 1 : -1;
  return axis;
}

// Rows forward, starboard = forward x up, down; as models have them (core/scene/mesh.h).
void check_axes(const PlumeGrids& grids, PlumeReading& reading, Problems& wrong) {
  const auto forward = axis_of(grids.forward_axis), up = axis_of(grids.up_axis);
  if (!forward || !up ||
      (*forward)[0] * (*up)[0] + (*forward)[1] * (*up)[1] + (*forward)[2] * (*up)[2] != 0) {
    wrong.add({"", "forward_axis",
               fmt::format("forward_axis \"{}\" and up_axis \"{}\", expected two of +x, -x, +y, "
                           "-y, +z, -z that are perpendicular",
                           grids.forward_axis, grids.up_axis)});
    return;
  }
  if (!(grids.unit_m > 0) || !std::isfinite(grids.unit_m))
    wrong.add({"", "unit_m",
               fmt::format("unit_m = {}, expected a positive number of metres", grids.unit_m)});
  const double at[] = {grids.position_m.x, grids.position_m.y, grids.position_m.z};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t a = (c + 1) % 3, b = (c + 2) % 3;
    const double starboard = (*forward)[a] * (*up)[b] - (*forward)[b] * (*up)[a];
    reading.body_from_world[c] = grids.unit_m * (*forward)[c];
    reading.body_from_world[4 + c] = grids.unit_m * starboard;
    reading.body_from_world[8 + c] = -grids.unit_m * (*up)[c];
    reading.body_from_world[4 * c + 3] = at[c];
    if (!std::isfinite(at[c])) wrong.add({"", "position_m", "position_m is not finite"});
  }
}

}  // namespace

absl::StatusOr<PlumeReading> check_plume_grids(const PlumeGrids& grids) {
  PlumeReading out;
  Problems wrong;
  Checker checker(out, wrong);
  out.temperature =
      checker.check("temperature", grids.temperature, kTemperatureUnits, kLeastPlumeK, kMostPlumeK);
  out.pressure =
      checker.check("pressure", grids.pressure, kPressureUnits, kLeastPlumePa, kMostPlumePa);
  const GridOrConstant* species[] = {&grids.co2, &grids.h2o, &grids.co, &grids.soot};
  const char* names[] = {"co2", "h2o", "co", "soot"};
  bool any = false, grid = out.temperature.channel >= 0;
  for (std::size_t s = 0; s < kPlumeSpecies; ++s) {
    out.species[s] = checker.check(names[s], *species[s], kFractionUnits, 0, 1);
    any = any || out.species[s].channel >= 0 || out.species[s].constant > 0;
    grid = grid || out.species[s].channel >= 0;
  }
  out.interpolation = grids.interpolation;
  check_axes(grids, out, wrong);
  if (wrong.empty() && !any)
    wrong.add({"", "", "no gas: co2, h2o, co and soot are all the constant 0; state one of them"});
  if (wrong.empty() && !grid)
    wrong.add({"", "",
               "no grid: temperature and all species are constants, so that nothing says where the "
               "gas is; name a grid of the file for one of them"});
  if (!wrong.empty()) return wrong.status();
  return out;
}

}  // namespace irsig
