#include "core/signature/view/prepared_scene.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/materials/spectra.h"
#include "core/signature/view/scene_hash.h"
#include "core/spectral/solar.h"

namespace irsig {

namespace {

// Each costs two nodes, and every material is prepared at every node: of a noisy table only those
// that stand out are cuts, what is left is bounded.
constexpr std::size_t kMostCorners = 512;
constexpr double kFineCorners = 1e-5;

TableCorners corners_of(const SceneSpec& spec, const Band& band) {
  for (double tolerance = kFineCorners;; tolerance *= 2) {
    TableCorners all;
    for (const auto* materials : {&spec.material, &spec.land_material})
      for (const MaterialSpec& material : *materials) {
        const TableCorners own = table_corners(material, band.lambda_min_um - 0.5 * band.step_um,
                                               band.lambda_max_um + 0.5 * band.step_um, tolerance);
        all.um.insert(all.um.end(), own.um.begin(), own.um.end());
        all.left_out = std::max(all.left_out, own.left_out);
      }
    // Beyond that only tables of BRDFs are left, which lose none.
    if (all.um.size() > kMostCorners && tolerance < 1) continue;
    std::sort(all.um.begin(), all.um.end());
    return all;
  }
}

// Returns the emissivity of each node, integrated over the hemisphere with the cosine.
std::vector<double> hemispherical_emissivity(const Material& material, std::size_t nodes) {
  constexpr int kSteps = 64;  // of the cosine squared, middles
  std::vector<double> out(nodes, 0.0);
  std::vector<float> row(nodes);
  for (int k = 0; k < kSteps; ++k) {
    const auto cosine = static_cast<float>(std::sqrt((k + 0.5) / kSteps));
    if (material.grey())
      std::fill(row.begin(), row.end(), material.emissivity(cosine));
    else
      material.spectral_emissivity(cosine, row.data());
    for (std::size_t i = 0; i < nodes; ++i) out[i] += static_cast<double>(row[i]) / kSteps;
  }
  return out;
}

std::vector<std::vector<double>> spectra_of(const std::vector<Material>& materials,
                                            const BandOnAxis& band) {
  std::vector<std::vector<double>> out;
  for (const Material& material : materials) {
    if (material.grey()) continue;
    std::vector<float> row(material.nodes());
    material.spectral_emissivity(1.0f, row.data());
    std::vector<double> emissivity, reflectance;
    for (std::size_t i = 0; i < band.nodes(); ++i) {
      const auto e = static_cast<double>(row[band.first_node + i]);
      emissivity.push_back(e);
      reflectance.push_back(std::max(0.0, 1 - e));
    }
    out.push_back(std::move(emissivity));
    out.push_back(std::move(reflectance));
  }
  return out;
}

}  // namespace

absl::StatusOr<PreparedScene> PreparedScene::make(const SceneSpec& spec) {
  PreparedScene out;
  out.band = spec.band;
  std::vector<BandGrid> grids;
  for (const Band& band : spec.band) {
    const TableCorners corners = corners_of(spec, band);
    auto grid = make_band_grid(band, spec.spectral_breaks_um, corners.um);
    if (!grid.ok())
      return problem_status(
          {{"", absl::StrCat("band[", grids.size(), "]"), std::string(grid.status().message())}});
    out.corners_left_out.push_back(corners.left_out);
    out.sun_quadrature.push_back(solar_quadrature(band, *grid));
    grids.push_back(*std::move(grid));
  }
  out.axis = SpectralAxis(std::move(grids));
  Hash hash;
  const std::vector<double>& node_um = out.axis.node_um();
  std::vector<double> sorted = node_um;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < spec.material.size(); ++i) {
    const MaterialSpec& m = spec.material[i];
    auto prepared = Material::prepare(m, node_um, sorted.front(), sorted.back());
    if (!prepared.ok()) return at_key(absl::StrCat("material[", i, "]"), prepared.status());
    out.material.push_back(*std::move(prepared));
    hash.add(m);
  }
  std::vector<Material> all = out.material;
  for (std::size_t i = 0; i < spec.land_material.size(); ++i) {
    auto prepared =
        Material::prepare(spec.land_material[i], node_um, sorted.front(), sorted.back());
    if (!prepared.ok()) return at_key(absl::StrCat("land.material[", i, "]"), prepared.status());
    out.land_emissivity.push_back(hemispherical_emissivity(*prepared, node_um.size()));
    all.push_back(*std::move(prepared));
  }
  for (std::uint32_t b = 0; b < out.axis.bands(); ++b)
    out.spectrum.push_back(spectra_of(all, out.axis.band(b)));
  out.basis = make_spectral_basis(out.material);
  if (!out.basis.identity()) {
    std::vector<double> carried_um;
    for (const std::uint32_t i : out.basis.carried) carried_um.push_back(node_um[i]);
    for (const MaterialSpec& m : spec.material) {
      ASSIGN_OR_RETURN(auto prepared,
                       Material::prepare(m, carried_um, sorted.front(), sorted.back()));
      out.carried.push_back(std::move(prepared));
    }
  }
  ASSIGN_OR_RETURN(auto target, make_target(spec.mesh, spec.part, spec.isa, spec.tracer));
  out.target = std::move(target);
  out.facets = std::make_shared<const TargetFacets>();
  hash.add(out.target.vertex);
  for (const std::uint32_t corner : out.target.triangle)
    hash.add(static_cast<std::uint64_t>(corner));
  for (const PartSpec& part : out.target.part) {
    hash.add(static_cast<std::uint64_t>(part.material * 4 + part.two_sided * 2 + part.hot));
    out.energy_gain |= out.material[part.material].creates_energy();
  }
  out.hash = hash.value();
  return out;
}

double PreparedScene::quadrature_relative(std::uint32_t of_band, double coldest_k,
                                          double hottest_k) const {
  const BandGrid& grid = axis.grids()[of_band];
  return std::max(
      quadrature_relative_bound(band[of_band], grid, coldest_k, hottest_k),
      quadrature_relative_bound(band[of_band], grid, coldest_k, hottest_k, spectrum[of_band]));
}

const SpectralBasis* PreparedScene::path_basis() const {
  const std::vector<Material>& m = carried_material();
  return std::all_of(m.begin(), m.end(), [](const Material& x) { return x.grey(); }) ? nullptr
                                                                                     : &basis;
}

}  // namespace irsig
