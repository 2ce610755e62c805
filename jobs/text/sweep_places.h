#pragma once

#include <cstddef>
#include <string>

#include "schema/sweep.pb.h"

namespace irsig {

// Returns true if [place] states the target's position on the Earth. Without latitude_deg it states
// the height only.
[[nodiscard]] inline bool has_position(const schema::Sweep& sweep) {
  return sweep.place().has_latitude_deg();
}
// Returns the height of the target's reference point above sea or ground in a season of the sweep.
// [m]
[[nodiscard]] inline double above_surface_m(const schema::Sweep& sweep,
                                            const schema::Season& season) {
  return season.has_above_surface_m() ? season.above_surface_m() : sweep.place().above_surface_m();
}

// Returns the key from which viewpoint `index` of `all` viewpoints comes.
[[nodiscard]] std::string viewpoint_path(const schema::Viewpoints& set, std::size_t index,
                                         std::size_t all);

}  // namespace irsig
