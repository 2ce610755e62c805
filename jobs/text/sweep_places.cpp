#include "jobs/text/sweep_places.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace irsig {

std::string viewpoint_path(const schema::Viewpoints& set, std::size_t index, std::size_t all) {
  const std::size_t of_range = all / static_cast<std::size_t>(std::max(1, set.ranges_m_size()));
  const std::size_t spread_ones = of_range - static_cast<std::size_t>(set.aspect_size());
  const std::size_t at = index % of_range;
  return at < spread_ones ? "viewpoints"
                          : absl::StrCat("viewpoints.aspect[", at - spread_ones, "]");
}

}  // namespace irsig
