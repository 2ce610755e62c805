// A file is read in a process of its own (docs/decisions/0021), whose memory and time have limits.
#include "core/scene/import/import_subprocess.h"

#include "core/base/status_macros.h"
#include "core/scene/import/import_reply.h"

namespace irsig {

std::string importer_program() { return program_beside("irsig-import"); }

absl::StatusOr<FileMesh> import_subprocess(const std::string& program, std::string_view bytes,
                                           const std::string& file_name) {
  ASSIGN_OR_RETURN(const std::string reply,
                   run_subprocess(program, {file_name, std::to_string(bytes.size())}, bytes,
                                  apart_limits(bytes.size())));
  absl::StatusOr<FileMesh> mesh = decode_reply(reply);
  if (absl::IsDataLoss(mesh.status())) return absl::InternalError("the importer said nothing");
  return mesh;
}

}  // namespace irsig
