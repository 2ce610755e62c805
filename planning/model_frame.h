#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"

namespace irsig {

// Unit and axes of a model file as given to a command; empty ones are read from the file, or
// assumed.
struct AskedFrame {
  std::optional<double> unit_m;
  std::optional<std::string> forward_axis, up_axis;
};

// Origin of unit and axes: "given", "from the glTF 2.0 standard", "assumed".
struct FrameSources {
  std::string unit_m, forward_axis, up_axis;
};

// Fills unit_m, forward_axis and up_axis of `how`, whose file_name is set. Without a statement they
// are 1, +x and +z.
[[nodiscard]] FrameSources choose_frame(std::string_view bytes, const AskedFrame& asked,
                                        MeshImport& how);

}  // namespace irsig
