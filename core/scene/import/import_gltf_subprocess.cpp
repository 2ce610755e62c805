// glTF and GLB are read in a process of their own: a small file may ask for gigabytes.
#include "absl/strings/match.h"
#include "core/scene/import/import_formats.h"
#include "core/scene/import/import_subprocess.h"
#include "fmt/format.h"

namespace irsig {

absl::StatusOr<FileMesh> read_gltf_apart(std::string_view bytes, const std::string& file_name) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (!bytes.starts_with("glTF") && (first == bytes.npos || bytes[first] != '{'))
    return absl::InvalidArgumentError(fmt::format(
        "{}: this is no glTF: it begins neither with \"glTF\" nor with \"{{\"", file_name));
  absl::StatusOr<FileMesh> mesh = import_subprocess(importer_program(), bytes, file_name);
  // A finding of the process names the file; the message on how the process ended does not.
  if (mesh.ok() || absl::StartsWith(mesh.status().message(), file_name + ":")) return mesh;
  return absl::Status(mesh.status().code(),
                      fmt::format("{}: {}", file_name, std::string(mesh.status().message())));
}

}  // namespace irsig
