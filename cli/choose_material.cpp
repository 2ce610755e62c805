#include "cli/choose_material.h"

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "core/materials/material.h"
#include "jobs/files/sweep_materials.h"
#include "jobs/text/nearest_name.h"
#include "messages/scene/material_from_message.h"
#include "planning/load_sweep.h"

namespace irsig {
namespace {

// Where irsig looks if nothing says where: from the visible to the end of the long-wave window.
constexpr double kFirstUm = 0.4, kLastUm = 14;
constexpr std::array kUsualUm{0.55, 1.6, 4.0, 10.0};

// No bands: where the material is known, as far as it is of use here.
ChosenMaterial known_range(MaterialSpec spec) {
  const WavelengthRange range = wavelength_range(spec);
  ChosenMaterial out{
      std::move(spec), {}, std::max(range.min_um, kFirstUm), std::min(range.max_um, kLastUm), {}};
  if (!(out.min_um < out.max_um)) {  // known elsewhere only
    out.min_um = range.min_um;
    out.max_um = range.max_um;
  }
  for (const double um : kUsualUm)
    if (um >= out.min_um && um <= out.max_um) out.lambda_um.push_back(um);
  if (out.lambda_um.empty()) out.lambda_um.push_back((out.min_um + out.max_um) / 2);
  return out;
}

ChosenMaterial in_bands(MaterialSpec spec, const schema::Sweep& sweep) {
  if (sweep.band_size() == 0) return known_range(std::move(spec));
  ChosenMaterial out{
      std::move(spec), {}, sweep.band(0).lambda_min_um(), sweep.band(0).lambda_max_um(), {}};
  for (const schema::Band& band : sweep.band()) {
    out.min_um = std::min(out.min_um, band.lambda_min_um());
    out.max_um = std::max(out.max_um, band.lambda_max_um());
    out.lambda_um.push_back((band.lambda_min_um() + band.lambda_max_um()) / 2);
  }
  std::sort(out.lambda_um.begin(), out.lambda_um.end());
  out.lambda_um.erase(std::unique(out.lambda_um.begin(), out.lambda_um.end()), out.lambda_um.end());
  return out;
}

}  // namespace

absl::StatusOr<std::vector<ChosenMaterial>> materials_of_sweep(const std::string& path) {
  ASSIGN_OR_RETURN(const auto file, load_sweep_file(path));
  for (int i = 0; i < file.sweep.band_size(); ++i) {
    const schema::Band& band = file.sweep.band(i);
    if (!(band.lambda_min_um() > 0 && band.lambda_max_um() > band.lambda_min_um()))
      return placed_problem(
          file.location(absl::StrCat("band[", i, "]")),
          absl::StrCat("band[", i, "] has no limits, expected lambda_min_um below lambda_max_um"));
  }
  ASSIGN_OR_RETURN(const auto materials, resolved_materials(file));
  std::vector<ChosenMaterial> out;
  for (const schema::Material& material : materials) {
    ASSIGN_OR_RETURN(auto spec, material_from_message(material));
    out.push_back(in_bands(std::move(spec), file.sweep));
    if (const auto entry = library_entry(material.entry()); entry.ok()) out.back().entry = *entry;
  }
  return out;
}

absl::StatusOr<ChosenMaterial> choose_material(const std::string& name) {
  if (auto entry = library_entry(name); entry.ok()) {
    ChosenMaterial out = known_range(entry->spec);
    out.entry = *std::move(entry);
    return out;
  }
  if (auto spec = builtin_material(name); spec.ok()) return known_range(*std::move(spec));
  const std::size_t colon = name.rfind(':');
  std::vector<std::string> known;
  if (colon == std::string::npos) {
    for (const LibraryEntry& entry : material_library()) known.push_back(entry.spec.name);
    return absl::InvalidArgumentError(absl::StrCat("no material is called \"", name,
                                                   "\": ", suggestion(name, known),
                                                   ", or SWEEP.toml:MATERIAL"));
  }
  ASSIGN_OR_RETURN(auto materials, materials_of_sweep(name.substr(0, colon)));
  for (ChosenMaterial& material : materials) {
    if (material.spec.name == name.substr(colon + 1)) return std::move(material);
    known.push_back(material.spec.name);
  }
  return absl::InvalidArgumentError(absl::StrCat(
      name.substr(0, colon), " has no material \"", name.substr(colon + 1),
      "\": ", known.empty() ? "it has none" : suggestion(name.substr(colon + 1), known)));
}

}  // namespace irsig
