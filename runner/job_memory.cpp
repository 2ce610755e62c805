#include "runner/job_memory.h"

#include <algorithm>
#include <vector>

#include "core/environment/land_air.h"
#include "messages/environment/sweep_environment.h"
#include "runner/heat_land.h"
#include "runner/heat_weather.h"
#include "runner/input_views.h"
#include "schema/heat_run.h"
#include "schema/image_size.h"

namespace irsig {
namespace {

// Measured as tests/system/memory_test.py does: a worker with the quickstart; the mesh with its ray
// tracer (5000 and 200 000 triangles); a weather's air and skies, clear and overcast; what
// allocation and small tables add to the large ones.
constexpr double kProgramBytes = 45e6;
constexpr double kBytesPerFacet = 300, kBytesPerWeather = 20e6;
constexpr double kAllocation = 1.2;
// A field's file and its rows while they are read, in sizes of the file; numbers of weights that an
// emitter has in a replicate, seen and reflected, with what pages leave empty.
constexpr double kFieldBytes = 4, kWeightsPerEmitter = 3;
constexpr double kNumber = sizeof(double);
// A heat job's faces: exchange and walls, and what shines on each at each knot of the weather.
constexpr double kBytesPerFace = 4.1e3, kBytesPerFaceAndKnot = 36;

// Light and weights of the land's sources under one condition: of each kind in the open and facing
// land, with an error each, and of each material in the sun, at each range; twice, since the window
// of the clutter has its own; and the weights of its sun's land, of all paths and of those of the
// last order.
double land_bytes_per_condition(const schema::Sweep& sweep, double wavelengths,
                                double path_weights) {
  const double materials = sweep.land().material_size();
  if (materials == 0) return 0;
  constexpr double kAround = kLandRangeM.size(), kBehind = 12;  // ranges
  const auto kinds = static_cast<double>(most_land_kinds(sweep));
  const double spectra =
      (2 * kinds + materials + 4) * (2 * kAround + kBehind) + (kinds > materials ? 2 * kinds : 0);
  return kNumber * (2 * spectra * wavelengths + 2 * path_weights * materials * (kAround + kBehind));
}

// The largest of the sweep's heat jobs.
double heat_bytes(const schema::ResolvedSweep& sweep, std::size_t facets) {
  double most = 0;
  bool sheets = false;  // both of whose faces are outside
  for (const schema::BuildUp& b : sweep.sweep().build_up()) sheets |= b.inside() == "open";
  const double faces = static_cast<double>(facets) * (sheets ? 2 : 1);
  for (const schema::HeatRun& run : sweep.heat()) {
    const auto weather = heat_weather(sweep.sweep(), run);
    if (!weather.ok()) continue;
    const double each =
        kBytesPerFace + kBytesPerFaceAndKnot * static_cast<double>(weather->knot_s.size());
    // One after the other.
    if (computes_parts(run)) most = std::max(most, faces * each);
    if (computes_land(run) || changes_land(run))
      most = std::max(most, static_cast<double>(most_land_kinds(sweep.sweep())) * each);
  }
  return most;
}

}  // namespace

std::uint64_t JobMemory::conditions_in(double bytes, std::uint32_t workers) const {
  const double of_conditions = (bytes - shared_bytes) / workers - (fixed_bytes - shared_bytes);
  return of_conditions > 0 && of_conditions >= heat_bytes
             ? static_cast<std::uint64_t>(of_conditions / bytes_per_condition)
             : 0;
}

JobMemory job_memory(const schema::ResolvedSweep& sweep, const Simulator& simulator,
                     const Environment* environment, std::size_t emitters, std::size_t field_bytes,
                     std::size_t plume_bytes, std::size_t land_bytes) {
  double wavelengths = 0;
  for (const BandGrid& grid : simulator.band_grids())
    wavelengths += static_cast<double>(grid.node_um.size());
  const std::vector<Material>& materials = simulator.carried_materials();
  const bool grey = std::all_of(materials.begin(), materials.end(),
                                [](const Material& material) { return material.grey(); });
  const double carried = grey ? 1 : static_cast<double>(simulator.basis().columns());
  const double parts = sweep.sweep().part_size();
  const double directions = environment == nullptr ? 2 : environment->nodes().count();
  const double of_condition = environment == nullptr ? 2 * directions * wavelengths * kNumber
                                                     : environment->bytes_per_condition();
  // Weights of paths, by replicate, first part, source and carried wavelength: summed, and as
  // means.
  const double row = 2 * sweep.sweep().accuracy().replicates() * parts * carried * kNumber;
  JobMemory memory;
  const auto elements = static_cast<double>(emitters);
  memory.bytes_per_condition =
      kAllocation * (of_condition +
                     land_bytes_per_condition(sweep.sweep(), wavelengths, row / (2 * kNumber))) +
      row + 2 * elements * static_cast<double>(sizeof(float));
  memory.heat_bytes = heat_bytes(sweep, simulator.target().facet.size());
  memory.shared_bytes =
      kProgramBytes + kBytesPerFacet * static_cast<double>(simulator.target().facet.size()) +
      (environment == nullptr
           ? 0
           : kBytesPerWeather * weathers_of(sweep).count * (1 + moved_environments(sweep))) +
      kAllocation * static_cast<double>(plume_bytes) + static_cast<double>(land_bytes) +
      kFieldBytes * static_cast<double>(field_bytes);
  memory.fixed_bytes =
      memory.shared_bytes + row * (parts + directions) +
      kWeightsPerEmitter * elements * carried * kNumber * sweep.sweep().accuracy().replicates();
  const double rows = static_cast<double>(sweep.condition_size()) * sweep.sweep().band_size();
  memory.fixed_bytes +=
      image_memory_of_row(sweep.sweep()) * std::min(rows, most_rows_with_images(sweep.sweep()));
  return memory;
}

}  // namespace irsig
