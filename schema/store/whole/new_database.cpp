#include "schema/store/whole/new_database.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/open_database.h"

namespace irsig {
namespace {

absl::Status cannot(const std::string& what, const std::string& path) {
  return absl::UnavailableError(absl::StrCat(what, " ", path, ": ", std::strerror(errno)));
}

absl::Status to_disk(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return cannot("cannot open", path);
  const bool done = ::fsync(descriptor) == 0;
  const absl::Status status = done ? absl::OkStatus() : cannot("cannot write", path);
  ::close(descriptor);
  return status;
}

absl::Status not_there(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(path, ignored)))
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": exists already, expected the name of a new file"));
}

}  // namespace

absl::Status make_new_database(const std::string& to,
                               const std::function<absl::Status(const std::string&)>& fill) {
  IRSIG_STORE_TRY(not_there(to));
  const std::string beside = absl::StrCat(to, ".", ::getpid(), ".partial");
  const absl::Cleanup remove = [&] { remove_database(beside); };
  IRSIG_STORE_TRY(fill(beside));
  IRSIG_STORE_TRY(to_disk(beside));
  IRSIG_STORE_TRY(not_there(to));
  if (std::rename(beside.c_str(), to.c_str()) != 0) return cannot("cannot make", to);
  return absl::OkStatus();
}

absl::Status make_empty_database(const std::string& path) {
  ASSIGN_OR_RETURN(WritableDatabase made, open_for_writing(path));
  return end_write_ahead(made);
}

}  // namespace irsig
