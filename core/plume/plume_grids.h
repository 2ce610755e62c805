#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"

namespace irsig {

// A quantity of the gas: a grid of the file or one number for all gas. Exactly one must be said:
// for a species that is not there, constant 0.
struct GridOrConstant {
  std::string grid;
  std::optional<double> constant;
  // temperature: K or degC; pressure: Pa, hPa, kPa, bar or atm; mole fractions and the soot volume
  // fraction: 1, percent or ppm (by volume).
  std::string unit;
};

// Interpolation of the field between the centres of voxels.
enum class PlumeInterpolation {
  // Amounts (number densities, soot volume fraction) are trilinear between centres and 0 at those
  // of
  // empty voxels; temperature and pressure are means of the centres around, weighted by their
  // amounts: what is empty never cools an edge. The amount of gas is that of the voxels.
  kLinear,
  // Each voxel is homogeneous, up to half a voxel around its centre.
  kConstant,
};

// Meaning and position of the grids of a VDB file.
struct PlumeGrids {
  GridOrConstant temperature, pressure, co2, h2o, co, soot;
  PlumeInterpolation interpolation = PlumeInterpolation::kLinear;
  double unit_m = 1;  // metres in the file's world unit
  std::string forward_axis = "+x", up_axis = "+z";
  Vec<Body> position_m{};  // of the file's world origin
};

// A quantity as it is used: a channel of the volume or a constant, and its unit undone:
// value_si = scale * value + offset.
struct PlumeQuantity {
  const char* name = "";
  int channel = -1;  // -1: the constant
  double constant = 0;
  double scale = 1, offset = 0;
};

// Species in the order of everything below.
inline constexpr std::size_t kPlumeSpecies = 4;  // CO2, H2O, CO, soot
inline constexpr std::size_t kSoot = 3;

// A specification that was checked, before any file is opened.
struct PlumeReading {
  std::vector<std::string> grid;  // to be read, each once: channel c is grid[c]
  PlumeQuantity temperature, pressure;
  std::array<PlumeQuantity, kPlumeSpecies> species;
  PlumeInterpolation interpolation = PlumeInterpolation::kLinear;
  std::array<double, 12> body_from_world{};  // three rows of four, in metres
};

// Checks the grids. INVALID_ARGUMENT lists all faults, a line each: a quantity with neither or both
// of grid and constant, an unknown unit, one grid for two quantities, a constant out of range
// (temperature 100 to 5000 K, pressure 100 Pa to 10 MPa, fractions 0 to 1), no species at all,
// invalid axes.
[[nodiscard]] absl::StatusOr<PlumeReading> check_plume_grids(const PlumeGrids& grids);

// Bounds of both constants and voxels. Below 100 K there is no exhaust; above 5000 K no molecule.
inline constexpr double kLeastPlumeK = 100, kMostPlumeK = 5000;
inline constexpr double kLeastPlumePa = 100, kMostPlumePa = 1e7;

}  // namespace irsig
