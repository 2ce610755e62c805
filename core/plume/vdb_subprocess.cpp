#include "core/plume/vdb_subprocess.h"

#include "core/base/run_subprocess.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr std::string_view kFile = "irsig vdb 1\n";

absl::StatusOr<std::string> run(std::vector<std::string> arguments, std::string_view bytes) {
  arguments.insert(arguments.begin() + 1, std::to_string(bytes.size()));
  return run_subprocess(program_beside("irsig-volume"), arguments, bytes,
                        apart_limits(bytes.size()));
}

}  // namespace

absl::StatusOr<VoxelVolume> read_vdb_apart(std::string_view file,
                                           const std::vector<std::string>& grids) {
  std::vector<std::string> arguments{"read"};
  arguments.insert(arguments.end(), grids.begin(), grids.end());
  ASSIGN_OR_RETURN(const std::string reply, run(arguments, file));
  absl::StatusOr<VoxelVolume> volume = decode_volume(reply);
  if (absl::IsDataLoss(volume.status())) return absl::InternalError("the importer said nothing");
  // Whatever the library did to that process: these are the channels that were asked for.
  if (volume.ok() && volume->channel != grids)
    return absl::InternalError("the importer read other grids");
  return volume;
}

std::string encode_vdb(const absl::StatusOr<std::string>& file) {
  return file.ok() ? std::string(kFile) + *file : std::string(file.status().message());
}

absl::StatusOr<std::string> write_vdb_apart(const VoxelVolume& volume) {
  const std::string bytes = encode_volume(volume);
  ASSIGN_OR_RETURN(std::string reply, run({"write"}, bytes));
  if (!reply.starts_with(kFile)) return absl::InternalError("cannot write VDB: " + reply);
  return reply.substr(kFile.size());
}

}  // namespace irsig
