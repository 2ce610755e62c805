// Assimp reads a file in a process of its own (docs/decisions/0021): damaged files crash it.
#include "core/scene/import_apart.h"

#include "core/scene/import_reply.h"

namespace irsig {

std::string importer_program() { return program_beside("irsig-import"); }

absl::StatusOr<FileMesh> import_apart(const std::string& program, std::string_view bytes,
                                      const std::string& form) {
  const absl::StatusOr<std::string> reply =
      run_apart(program, {form, std::to_string(bytes.size())}, bytes, apart_limits(bytes.size()));
  if (!reply.ok()) return reply.status();
  absl::StatusOr<FileMesh> mesh = decode_reply(*reply);
  if (absl::IsDataLoss(mesh.status())) return absl::InternalError("the importer said nothing");
  return mesh;
}

}  // namespace irsig
