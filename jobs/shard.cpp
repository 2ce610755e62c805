#include "jobs/shard.h"

#include <cstdint>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "jobs/keys/expand.h"

namespace irsig {
namespace {

// Digits alone: SimpleAtoi takes signs and spaces.
bool read_count(std::string_view text, std::uint32_t& count) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos &&
         absl::SimpleAtoi(absl::string_view(text.data(), text.size()), &count);
}

}  // namespace

absl::Status take_shard(std::string_view shard, schema::ResolvedSweep& sweep) {
  const std::string option =
      absl::StrCat("--shard ", absl::string_view(shard.data(), shard.size()));
  const std::size_t slash = shard.find('/');
  std::uint32_t number = 0, of = 0;
  if (slash == std::string_view::npos || !read_count(shard.substr(0, slash), number) ||
      !read_count(shard.substr(slash + 1), of) || number < 1 || number > of)
    return absl::InvalidArgumentError(
        absl::StrCat(option, ": expected K/N, the K-th of N shards: 1/3, 2/3, 3/3"));
  if (of > static_cast<std::uint32_t>(sweep.viewpoint_size()))
    return absl::InvalidArgumentError(absl::StrCat(option, ": the sweep has ",
                                                   sweep.viewpoint_size(),
                                                   " viewpoints, expected at most as many shards"));
  if (of == 1) return absl::OkStatus();
  if (sweep.sweep().accuracy().has_time_budget_s())
    return absl::InvalidArgumentError(
        absl::StrCat(option,
                     ": accuracy.time_budget_s becomes a number of samples on each machine, and "
                     "shards of different samples are no sweep; expected relative_error, "
                     "target_paths or samples_per_replicate"));
  schema::Shard made;
  made.set_sweep_sha256(sha256_hex(canonical_encoding(sweep)));
  made.set_number(number);
  made.set_of(of);
  *sweep.mutable_shard() = made;
  return absl::OkStatus();
}

}  // namespace irsig
