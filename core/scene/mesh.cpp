#include "core/scene/mesh.h"

#include <algorithm>
#include <limits>

namespace irsig {

void place(Mesh& mesh, const MeshPlacement& where) {
  Vec<Body> by = where.offset_m;
  if (where.draft_m) {
    double lowest = -std::numeric_limits<double>::infinity();
    for (const Vec<Body>& v : mesh.vertex) lowest = std::max(lowest, v.z);
    by.z += *where.draft_m - lowest;
  }
  for (Vec<Body>& v : mesh.vertex) v = v + by;
}

bool group_matches(std::string_view group, std::string_view pattern) {
  const auto fits = [pattern](std::string_view name) {
    std::size_t at = 0, p = 0, star = pattern.npos, star_at = 0;
    while (at < name.size()) {
      if (p < pattern.size() && pattern[p] == '*') {
        star = p++;
        star_at = at;
      } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[at])) {
        ++p;
        ++at;
      } else if (star != pattern.npos) {
        p = star + 1;
        at = ++star_at;
      } else {
        return false;
      }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
  };
  if (fits(group)) return true;
  for (std::size_t at = 0; at <= group.size();) {
    const std::size_t slash = std::min(group.find('/', at), group.size());
    if (fits(group.substr(at, slash - at))) return true;
    at = slash + 1;
  }
  return false;
}

}  // namespace irsig
