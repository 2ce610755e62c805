#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "schema/job.pb.h"

namespace irsig {

// The bytes of files that a resolved sweep refers to, by their SHA-256.
using Assets = std::map<std::string, std::string>;

// Results of a sweep's heat runs, in their order: each a serialized HeatField. Empty: not known.
using HeatOutputs = std::vector<std::string>;

// Returns the SHA-256 of every file that a sweep refers to: its model (unless the model is
// generated), its temperature fields, its hot gas and the maps of its land.
[[nodiscard]] std::set<std::string> needed_assets(const schema::ResolvedSweep& sweep);

// Returns the bytes of the file with this SHA-256. Empty: the sweep has no such file.
[[nodiscard]] std::string_view asset(const Assets& assets, const std::string& sha256);

// Returns the assets of a sweep whose only file is its model; none if the model is generated.
[[nodiscard]] Assets model_alone(const schema::ResolvedSweep& sweep, std::string_view bytes);

// Returns the number of bytes of all files together.
[[nodiscard]] std::size_t bytes_of(const Assets& assets);

}  // namespace irsig
