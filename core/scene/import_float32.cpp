// Binary PLY and STL, glTF and GLB: what can be told without Assimp, which reads them elsewhere.
#include "core/scene/import_apart.h"
#include "core/scene/import_formats.h"
#include "fmt/format.h"

namespace irsig {
namespace {

bool magic_fits(std::string_view bytes, std::string_view form) {
  if (form == "glb") return bytes.substr(0, 4) == "glTF";
  if (form == "ply") return bytes.substr(0, 3) == "ply";
  if (form == "gltf")
    return bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf") < bytes.size() &&
           bytes[bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf")] == '{';
  if (bytes.size() < 84) return false;
  std::uint32_t facets = 0;
  for (std::size_t i = 4; i-- > 0;)
    facets = facets << 8 | static_cast<unsigned char>(bytes[80 + i]);
  return bytes.size() >= 84 + std::uint64_t{50} * facets;
}

}  // namespace

absl::StatusOr<FileMesh> read_float32(std::string_view bytes, const std::string& file_name,
                                      const std::string& form) {
  // Assimp would try its other forty readers on what is not the form that it claims to be.
  if (!magic_fits(bytes, form)) {
    return absl::InvalidArgumentError(
        fmt::format("{}: this is no complete {} file", file_name, form));
  }
  absl::StatusOr<FileMesh> mesh = import_apart(importer_program(), bytes, form);
  if (mesh.ok()) return mesh;
  return {absl::Status(mesh.status().code(),
                       fmt::format("{}: {}", file_name, std::string(mesh.status().message())))};
}

}  // namespace irsig
