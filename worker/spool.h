#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/farm.pb.h"

namespace irsig {

// Results that no coordinator has acknowledged, as files of a folder (mode 0700) that workers of
// one machine may share. A file belongs to the worker that has locked it. When that worker has
// died, however it ended, another one takes the file over. Belongs to one thread.
//
// NAME is 32 hexadecimal digits; other files of the folder are neither read nor removed.
//
//   NAME.result    "irsigsp1", the length of the record (8 bytes, little-endian), the record (a
//                  serialized SpooledResult), the SHA-256 of all that in hex
//   NAME.new-PID   a file that is being written
//
// A file is written beside its name, synced, renamed, and the folder synced: the file is there
// completely or not at all. A torn file (from a faulty disk) is recognized by its hash, and
// removed.
class Spool {
 public:
  // Positions between two steps of a record's life, for tests that end the process there.
  enum class Step { kCreated, kWritten, kSynced, kNamed, kKept, kRemoved, kForgotten };
  using AtStep = std::function<void(Step)>;

  // Opens or creates a spool. most_bytes: limit for all records together; the oldest records
  // without an owner are removed to stay below it. INVALID_ARGUMENT: the folder cannot be made, or
  // other users may write to it.
  static absl::StatusOr<std::unique_ptr<Spool>> open(const std::string& folder,
                                                     std::uint64_t most_bytes = 4'000'000'000,
                                                     AtStep at_step = {});
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  // Writes a record to the disk as one of this worker and returns its name. RESOURCE_EXHAUSTED: the
  // record does not fit below most_bytes. Other errors have their reason in the message.
  absl::StatusOr<std::string> keep(const schema::SpooledResult& record);

  struct Found {
    std::string name;
    schema::SpooledResult record;
  };
  // Takes over complete records without an owner for which `mine` returns true. Returns them, the
  // oldest first. Torn records are removed and logged.
  std::vector<Found> take_over(const std::function<bool(const schema::SpooledResult&)>& mine);

  // Removes a record whose result was acknowledged, or that nobody needs.
  void remove(const std::string& name);
  // Keeps the record without an owner.
  void leave(const std::string& name);

 private:
  struct Held {
    std::string name;
    int fd;
  };
  Spool(std::string folder, std::uint64_t most_bytes, AtStep at_step)
      : folder_(std::move(folder)), most_bytes_(most_bytes), at_step_(std::move(at_step)) {}
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ + "/" + name; }
  void step(Step step) const {
    if (at_step_) at_step_(step);
  }
  bool make_room(std::uint64_t bytes);
  void sync_folder() const;

  std::string folder_;
  std::uint64_t most_bytes_;
  AtStep at_step_;
  std::vector<Held> held_;
};

}  // namespace irsig
