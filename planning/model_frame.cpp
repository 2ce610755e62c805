#include "planning/model_frame.h"

#include "core/scene/import/import_mesh.h"

namespace irsig {

FrameSources choose_frame(std::string_view bytes, const AskedFrame& asked, MeshImport& how) {
  const StatedFrame stated = stated_frame(bytes, how.file_name);
  const auto choose = [](const auto& given, const auto& of_file, const std::string& from,
                         auto& value) -> std::string {
    if (given) {
      value = *given;
      return "given";
    }
    if (!of_file) return "assumed";
    value = *of_file;
    return "from " + from;
  };
  return {choose(asked.unit_m, stated.unit_m, stated.unit_from, how.unit_m),
          choose(asked.forward_axis, stated.forward_axis, stated.axes_from, how.forward_axis),
          choose(asked.up_axis, stated.up_axis, stated.axes_from, how.up_axis)};
}

}  // namespace irsig
