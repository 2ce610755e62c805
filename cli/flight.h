#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "live/session.h"
#include "planning/load_sweep.h"

namespace irsig {

// The sweep file from which irsig fly makes its views.
class Flight {
 public:
  // Reads the sweep file. Errors: those of load_sweep().
  [[nodiscard]] static absl::StatusOr<Flight> load(const std::string& path);

  [[nodiscard]] const LoadedSweep& loaded() const { return loaded_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  // The sweep's first condition and band, from its first viewpoint, with the target in the middle.
  [[nodiscard]] const LiveAsk& first() const { return first_; }
  [[nodiscard]] std::vector<std::string> conditions() const;  // names for people
  [[nodiscard]] std::vector<std::string> bands() const;
  // Returns the sweep with the requested condition alone. Errors of the edited file name its own
  // lines.
  [[nodiscard]] absl::StatusOr<LiveInput> input(const LiveAsk& ask) const;
  // Returns the text of a sweep file with one view, to be stored beside the sweep's own file.
  [[nodiscard]] absl::StatusOr<std::string> view_text(const LiveAsk& ask,
                                                      const std::string& name) const;

 private:
  [[nodiscard]] absl::StatusOr<std::string> edited(const LiveAsk& ask, const std::string& name,
                                                   bool camera) const;

  std::string path_, text_;
  LoadedSweep loaded_;
  LiveAsk first_;
};

// Writes the sweep of a view beside the sweep file and runs it into a database. Returns a message
// for people that names the stored result and its place.
[[nodiscard]] absl::StatusOr<std::string> keep_view(const Flight& flight, const LiveAsk& ask,
                                                    std::uint32_t number, const std::string& db);

// Writes an animated PNG of 24 hours, one frame each half an hour, all on one scale.
[[nodiscard]] absl::Status write_film(const Flight& flight, std::uint32_t threads,
                                      const std::string& path);

}  // namespace irsig
