#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/materials/material.h"
#include "core/scene/trace/target.h"
#include "core/scene/trace/target_facets.h"
#include "core/spectral/solar.h"
#include "core/spectral/spectral_axis.h"
#include "core/transport/spectral_basis.h"

namespace irsig {

// Inputs that do not change during a sweep.
struct SceneSpec {
  Mesh mesh;
  std::vector<PartSpec> part;
  std::vector<MaterialSpec> material;
  std::vector<MaterialSpec> land_material = {};  // of LandScene::cover; each is taken as diffuse
  std::vector<Band> band;
  // Wavelengths at which the air's spectrum jumps (air_band_edges_um); empty: none. [um]
  std::vector<double> spectral_breaks_um;
  TracerIsa isa = widest_isa();
  TracerOptions tracer;
};

// A scene ready for any number of views.
struct PreparedScene {
  Target target;
  std::shared_ptr<const TargetFacets> facets;  // of the target
  std::vector<Band> band;
  SpectralAxis axis;
  // [band] What materials' tables hold between the corners that cut the quadrature (TableCorners).
  std::vector<double> corners_left_out;
  std::vector<SolarQuadrature> sun_quadrature;  // [band]
  std::vector<Material> material;               // prepared at every node of the axis
  // [band][spectrum][node of the band] Emissivities of materials that are not grey, towards their
  // normals, and 1 less these: what blackbodies' spectra are multiplied with.
  std::vector<std::vector<std::vector<double>>> spectrum;
  // [land material][node] Hemispherical emissivity, at every node of the axis.
  std::vector<std::vector<double>> land_emissivity;
  SpectralBasis basis;
  std::vector<Material> carried;  // at the nodes that paths carry; empty: at all
  bool energy_gain = false;       // some part's material creates energy
  // Hash of geometry, materials and strata, from which the seeds of random numbers are made.
  std::uint64_t hash = 0;

  [[nodiscard]] static absl::StatusOr<PreparedScene> make(const SceneSpec& spec);

  [[nodiscard]] const std::vector<Material>& carried_material() const {
    return basis.identity() ? material : carried;
  }
  // Returns the bound of the quadrature of what bodies of these temperatures send and reflect,
  // relative to it.
  [[nodiscard]] double quadrature_relative(std::uint32_t of_band, double coldest_k,
                                           double hottest_k) const;
  // Null if all materials are grey: weights then have one column.
  [[nodiscard]] const SpectralBasis* path_basis() const;
  // Returns the height of the water or ground on which the target stands, relative to its centre.
  [[nodiscard]] double surface_z_m() const { return -target.centre.z; }
};

}  // namespace irsig
