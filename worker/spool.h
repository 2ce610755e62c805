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
// one machine may share. A file belongs to the worker that has it locked, and to nobody when that
// one has died, in whatever way; another one takes it over then. Belongs to one thread.
//
// NAME is 32 hexadecimal digits; other files of the folder are not looked at, let alone removed.
//
//   NAME.result    "irsigsp1", the length of the record (8 bytes, little-endian), the record (a
//                  serialized SpooledResult), the SHA-256 of all that in hex
//   NAME.new-PID   one that is being written
//
// A file is written beside its name, synced, renamed, and the folder synced: it is there whole or
// not at all. One that is torn all the same (a disk that lied) is told by its hash, and removed.
class Spool {
 public:
  // Positions between two steps of a record's life, for tests that end the process there.
  enum class Step { kCreated, kWritten, kSynced, kNamed, kKept, kRemoved, kForgotten };
  using AtStep = std::function<void(Step)>;

  // INVALID_ARGUMENT: the folder cannot be made, or others may write to it. most_bytes: of all
  // records together; the oldest that belong to nobody make room.
  static absl::StatusOr<std::unique_ptr<Spool>> open(const std::string& folder,
                                                     std::uint64_t most_bytes = 4'000'000'000,
                                                     AtStep at_step = {});
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  // The record is on the disk, and this worker's. RESOURCE_EXHAUSTED: there is no room; anything
  // else that fails has its reason in the message.
  absl::StatusOr<std::string> keep(const schema::SpooledResult& record);

  struct Found {
    std::string name;
    schema::SpooledResult record;
  };
  // Whole records that belonged to nobody, the oldest first, and to this worker from now on: those
  // of which `mine` is true. Torn ones are removed, with a line in the log.
  std::vector<Found> take_over(const std::function<bool(const schema::SpooledResult&)>& mine);

  // A result was acknowledged, or nobody wants it.
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
