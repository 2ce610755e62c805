#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"

namespace irsig {

// A user's query of the profiles of a database; an empty string means "any".
struct ProfileQuery {
  ProfileFilter filter;
  std::optional<std::uint64_t> row{};  // of the signature that the profiles belong to
};

// Returns the stored rows of profiles. NOT_FOUND: nothing matches; the message lists the stored
// profiles.
[[nodiscard]] absl::StatusOr<std::vector<StoredProfileRow>> find_profiles(
    StoreReader& reader, const ProfileQuery& query);

// Writes one line for each point and number of reflections, in a format of table.h.
[[nodiscard]] absl::Status write_profiles(const std::vector<StoredProfileRow>& rows,
                                          std::string_view format, std::ostream& out);

// Returns a summary for people: source radiance temperature against the number of reflections of
// every profile at one point, the extent of profiles along a line, and published numbers beside
// ours, with the difference and the remark that explains it.
[[nodiscard]] std::string profile_summary(const std::vector<StoredProfileRow>& rows,
                                          const std::vector<StoredPublished>& published);

// Returns a line for each profile of a sweep whose standard error exceeds the requested one.
[[nodiscard]] std::vector<std::string> profile_notes(const std::vector<StoredProfileRow>& rows,
                                                     const schema::Sweep& sweep);

// Plots source radiance temperature with its 2 sigma error as a complete SVG document. A profile
// along a line (the first one) is plotted against the distance from its middle, one curve for each
// number of reflections. If all profiles are at one point, each is plotted against the number of
// reflections, with the published values. INVALID_ARGUMENT: the rows have several viewpoints,
// conditions or bands.
[[nodiscard]] absl::StatusOr<std::string> plot_profile(
    const std::vector<StoredProfileRow>& rows, const std::vector<StoredPublished>& published);

}  // namespace irsig
