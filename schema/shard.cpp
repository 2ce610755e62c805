#include "schema/shard.h"

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

// A database may come from anywhere: what no submission could be is no shard.
bool is_shard(const schema::ResolvedSweep& sweep) {
  const schema::Shard& shard = sweep.shard();
  return sweep.has_shard() && shard.number() >= 1 && shard.number() <= shard.of();
}

}  // namespace

std::uint64_t shard_size(const schema::ResolvedSweep& sweep) {
  const auto all = static_cast<std::uint64_t>(sweep.viewpoint_size());
  if (!is_shard(sweep)) return all;
  const schema::Shard& shard = sweep.shard();
  return (all + shard.of() - shard.number()) / shard.of();
}

std::uint64_t shard_viewpoint(const schema::ResolvedSweep& sweep, std::uint64_t i) {
  return is_shard(sweep) ? i * sweep.shard().of() + sweep.shard().number() - 1 : i;
}

bool in_shard(const schema::ResolvedSweep& sweep, std::uint64_t viewpoint) {
  return !is_shard(sweep) || viewpoint % sweep.shard().of() == sweep.shard().number() - 1;
}

std::string shard_name(const schema::Shard& shard) {
  return absl::StrCat("shard ", shard.number(), "/", shard.of());
}

absl::Status check_may_replace(const schema::ResolvedSweep& stored,
                               const schema::ResolvedSweep& submitted) {
  if (!submitted.has_shard()) return absl::OkStatus();
  if (stored.has_shard() && stored.shard().number() == submitted.shard().number() &&
      stored.shard().of() == submitted.shard().of())
    return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "the database holds ",
      stored.slice_size() > 0 ? "a slice"
      : stored.has_shard()    ? shard_name(stored.shard())
                              : "all",
      " of the sweep \"", stored.sweep().name(), "\", in which ", shard_name(submitted.shard()),
      " has no place: expected a database of its own (`irsig merge` unites them)"));
}

}  // namespace irsig
