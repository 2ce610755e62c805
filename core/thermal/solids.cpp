#include "core/thermal/solids.h"

#include <array>

namespace irsig {
namespace {

constexpr std::string_view kIso = "iso10456, table 3", kOke = "oke1987, table 2.1";

constexpr auto kSolids = std::to_array<Solid>({
    {"steel", 50, 7800, 450, "structural steel", kIso},
    {"stainless_steel", 17, 7900, 500, "austenitic", kIso},
    {"aluminium", 160, 2800, 880, "alloys", kIso},
    {"copper", 380, 8900, 380, "", kIso},
    {"cast_iron", 50, 7500, 450, "", kIso},
    {"concrete", 2.0, 2400, 1000, "high density", kIso},
    {"concrete_medium", 1.15, 1800, 1000, "medium density", kIso},
    {"reinforced_concrete", 2.3, 2300, 1000, "1 % of steel", kIso},
    {"brick", 0.72, 1920, 835, "common brick", "incropera2007, table A.3"},
    {"roof_tiles", 1.0, 2000, 800, "clay", kIso},
    {"granite", 2.8, 2600, 1000, "", kIso},
    {"marble", 3.5, 2800, 1000, "", kIso},
    {"asphalt", 0.70, 2100, 1000, "", kIso},
    {"bitumen", 0.17, 1050, 1000, "", kIso},
    {"polystyrene", 0.035, 20, 1450, "expanded; specific heat by iso10456, table 4",
     "iso10456, EN 13163"},
    {"mineral_wool", 0.040, 50, 1030, "specific heat by iso10456, table 4", "iso10456, EN 13162"},
    {"timber", 0.13, 500, 1600, "across the grain", kIso},
    {"plywood", 0.13, 500, 1600, "", kIso},
    {"glass", 1.0, 2500, 750, "soda lime", kIso},
    {"acrylic", 0.20, 1050, 1500, "", kIso},
    {"epoxy", 0.20, 1200, 1400, "resin: also paint films", kIso},
    {"polyurethane", 0.25, 1200, 1800, "resin: also paint films", kIso},
    {"rubber", 0.13, 910, 1100, "natural", kIso},
    {"water", 0.60, 1000, 4190, "at rest, 10 deg C", kIso},
    {"ice", 2.2, 900, 2000, "0 deg C", kIso},
    {"snow", 0.08, 100, 2090, "fresh", kOke},
    {"sandy_soil_dry", 0.30, 1600, 800, "40 % of pores", kOke},
    {"sandy_soil_wet", 2.20, 2000, 1480, "saturated", kOke},
    {"clay_soil_dry", 0.25, 1600, 890, "40 % of pores", kOke},
    {"clay_soil_wet", 1.58, 2000, 1550, "saturated", kOke},
    {"peat_dry", 0.06, 300, 1920, "80 % of pores", kOke},
    {"peat_wet", 0.50, 1100, 3650, "saturated", kOke},
});

}  // namespace

std::span<const Solid> solids() { return kSolids; }

const Solid* solid_named(std::string_view name) {
  for (const Solid& solid : kSolids)
    if (solid.name == name) return &solid;
  return nullptr;
}

}  // namespace irsig
