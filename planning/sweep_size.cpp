#include "planning/sweep_size.h"

#include <algorithm>
#include <cmath>

#include "fmt/format.h"
#include "planning/amount_text.h"
#include "schema/image_size.h"
#include "schema/shard.h"

namespace irsig {
namespace {

// Measured on databases of the examples, pages and indexes included.
constexpr double kFixedBytes = 0.6e6;
constexpr double kBytesOfRow = 2000, kBytesOfPart = 40;  // scalars, ledger; one part's intensity
constexpr double kBytesOfWavelength = 20 * 4 * 1.5;      // arrays of float32
constexpr double kBytesOfSquarePixel = 1.7;  // all images, over the square of the long side
constexpr double kBytesOfProfileRow = 250;

std::uint64_t rows_of_view(const schema::Profile& profile) {
  return std::uint64_t{std::max(1u, profile.points())} *
         static_cast<std::uint64_t>(std::max(1, profile.reflections_size()));
}

std::string counted(std::uint64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace

SweepSize size_of(const schema::ResolvedSweep& resolved, std::size_t asset_bytes) {
  const schema::Sweep& sweep = resolved.sweep();
  SweepSize size;
  size.viewpoints = shard_size(resolved);
  size.all_viewpoints = static_cast<std::uint64_t>(resolved.viewpoint_size());
  size.conditions = static_cast<std::uint64_t>(resolved.condition_size());
  size.bands = static_cast<std::uint64_t>(sweep.band_size());
  for (const schema::Band& band : sweep.band())
    size.wavelengths += static_cast<std::uint64_t>(std::max(
        1.0, std::round((band.lambda_max_um() - band.lambda_min_um()) / band.step_um()) + 1));
  for (const schema::Profile& profile : sweep.profile())
    size.profile_rows += rows_of_view(profile) * size.rows();
  const double rows = static_cast<double>(size.rows());
  const double per_view = static_cast<double>(size.viewpoints * size.conditions);
  const double image_px = sweep.has_image() ? 0 : sweep.output().thumbnail_px();
  size.database_bytes = kFixedBytes + static_cast<double>(asset_bytes) +
                        rows * (kBytesOfRow + kBytesOfPart * sweep.part_size()) +
                        per_view * static_cast<double>(size.wavelengths) * kBytesOfWavelength +
                        rows * image_px * image_px * kBytesOfSquarePixel +
                        rows * image_bytes_of_row(sweep) +
                        static_cast<double>(size.profile_rows) * kBytesOfProfileRow;
  return size;
}

std::string rows_text(const SweepSize& size) {
  const std::string viewpoints =
      size.viewpoints < size.all_viewpoints
          ? fmt::format("{} of {}", size.viewpoints, counted(size.all_viewpoints, "viewpoint"))
          : counted(size.viewpoints, "viewpoint");
  return fmt::format("{} x {} x {} = {}", viewpoints, counted(size.conditions, "condition"),
                     counted(size.bands, "band"), counted(size.rows(), "row"));
}

std::string size_text(const SweepSize& size) {
  return fmt::format(
      "{}, {}{}, database about {}", rows_text(size), counted(size.wavelengths, "wavelength"),
      size.profile_rows > 0 ? fmt::format(", {} of profiles", counted(size.profile_rows, "row"))
                            : "",
      bytes_text(size.database_bytes));
}

absl::Status check_size(const SweepSize& size) {
  std::string above;
  const auto say = [&](const std::string& text) { above += (above.empty() ? "" : ", ") + text; };
  if (size.database_bytes > kMostBytesUnasked)
    say(fmt::format("a database of about {} (limit {})", bytes_text(size.database_bytes),
                    bytes_text(kMostBytesUnasked)));
  if (size.rows() + size.profile_rows > kMostRowsUnasked)
    say(fmt::format("{} rows (limit {})", size.rows() + size.profile_rows, kMostRowsUnasked));
  if (size.wavelengths > kMostWavelengthsUnasked)
    say(
        fmt::format("{} wavelengths (limit {}), each of which costs time in every viewpoint and "
                    "condition",
                    size.wavelengths, kMostWavelengthsUnasked));
  if (above.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      fmt::format("this sweep makes {}: add --yes if that is meant, or ask for fewer viewpoints, "
                  "conditions or a wider step_um",
                  above));
}

}  // namespace irsig
