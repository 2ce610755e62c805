#include "messages/scene/scene_from_message.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"

namespace irsig {

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
    bool found = false;
    for (int m = 0; m < sweep.material_size(); ++m)
      if (sweep.material(m).name() == p.material()) {
        part.material = static_cast<std::uint32_t>(m);
        found = true;
      }
    if (!found)
      return keyed_problem(absl::StrCat("part[", i, "].material"),
                           absl::StrCat("no material is called \"", p.material(), "\""));
    parts.push_back(std::move(part));
  }
  return parts;
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
