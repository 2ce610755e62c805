#include "messages/scene/scene_from_message.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// The number of the material of this name, which the key at `path` states.
absl::StatusOr<std::uint32_t> material_named(const schema::Sweep& sweep, const std::string& name,
                                             const std::string& path) {
  for (int m = sweep.material_size() - 1; m >= 0; --m)
    if (sweep.material(m).name() == name) return static_cast<std::uint32_t>(m);
  return keyed_problem(path, absl::StrCat("no material is called \"", name, "\""));
}

}  // namespace

absl::StatusOr<std::vector<PartSpec>> parts_from_sweep(const schema::Sweep& sweep) {
  std::vector<PartSpec> parts;
  for (int i = 0; i < sweep.part_size(); ++i) {
    const schema::Part& p = sweep.part(i);
    PartSpec part;
    part.name = p.name();
    part.match.assign(p.match().begin(), p.match().end());
    part.two_sided = p.two_sided();
    part.hot = p.hot();
    part.rest = p.rest();
    ASSIGN_OR_RETURN(part.material,
                     material_named(sweep, p.material(), absl::StrCat("part[", i, "].material")));
    parts.push_back(std::move(part));
  }
  return parts;
}

absl::StatusOr<std::vector<std::uint32_t>> land_materials_from_sweep(const schema::Sweep& sweep) {
  std::vector<std::uint32_t> out;
  for (int i = 0; i < sweep.land().material_size(); ++i) {
    ASSIGN_OR_RETURN(out.emplace_back(),
                     material_named(sweep, sweep.land().material(i).material(),
                                    absl::StrCat("land.material[", i, "].material")));
  }
  return out;
}

std::vector<Band> bands_from_sweep(const schema::Sweep& sweep) {
  std::vector<Band> out;
  for (const schema::Band& b : sweep.band()) {
    Band band{b.name(), b.lambda_min_um(), b.lambda_max_um(), b.step_um(), {}};
    for (const schema::SpectralPoint& p : b.response())
      band.response.push_back({p.lambda_um(), p.value()});
    out.push_back(std::move(band));
  }
  return out;
}

}  // namespace irsig
