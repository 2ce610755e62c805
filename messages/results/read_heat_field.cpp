#include "messages/results/read_heat_field.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace irsig {

absl::StatusOr<schema::HeatField> read_heat_field(const std::string& bytes, std::size_t facets) {
  schema::HeatField field;
  if (!field.ParseFromString(bytes))
    return absl::InvalidArgumentError("computed temperatures cannot be read");
  const std::size_t expected =
      sizeof(float) * facets * static_cast<std::size_t>(field.unix_s_size());
  const auto fits = [&](const std::string& rows) { return rows.size() == expected; };
  const bool of_changes = field.change_k_size() > 0;
  if (field.facets() != facets ||
      (of_changes ? !std::all_of(field.change_k().begin(), field.change_k().end(), fits)
                  : !fits(field.kelvin()) || !fits(field.error_k())))
    return absl::InvalidArgumentError(absl::StrCat(
        "computed temperatures are of another mesh: of ", field.facets(), " facets, the model has ",
        facets, " (of another irsig: run the sweep again)"));
  for (const schema::HeatEffect& effect : field.effect())
    if (effect.bound_k().size() != sizeof(float) * facets)
      return absl::InvalidArgumentError(absl::StrCat("computed temperatures: the bound of ",
                                                     effect.effect(), " is of other facets"));
  return field;
}

}  // namespace irsig
