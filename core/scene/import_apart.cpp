// A file is read in a process of its own (docs/decisions/0021), whose memory and time have limits.
#include "core/scene/import_apart.h"

#include "core/scene/import_reply.h"

namespace irsig {

std::string importer_program() { return program_beside("irsig-import"); }

absl::StatusOr<FileMesh> import_apart(const std::string& program, std::string_view bytes,
                                      const std::string& file_name) {
  const absl::StatusOr<std::string> reply =
      run_apart(program, {file_name, std::to_string(bytes.size())}, bytes, apart_limits(bytes.size()));
  if (!reply.ok()) return reply.status();
  absl::StatusOr<FileMesh> mesh = decode_reply(*reply);
  if (absl::IsDataLoss(mesh.status())) return absl::InternalError("the importer said nothing");
  return mesh;
}

}  // namespace irsig
