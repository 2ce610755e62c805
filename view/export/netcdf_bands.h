#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "schema/job.pb.h"
#include "view/export/netcdf_file.h"

namespace irsig {

// Writes the bands of a cube: their stored wavelengths with the bins' limits (its CF bounds),
// responses and in-band weights, all over (band, bin), and the responses as the sweep states them,
// over points. NaN: a band of an earlier version of the sweep; bins that a band does not have.
//   bands      their names, in their order
//   lambda_um  of each; at most `bins`
[[nodiscard]] absl::Status write_bins(NetcdfFile& file, const schema::ResolvedSweep& sweep,
                                      const std::vector<std::string>& bands,
                                      const std::vector<std::vector<double>>& lambda_um,
                                      NetcdfFile::Dimension band, NetcdfFile::Dimension bin,
                                      std::size_t bins);

}  // namespace irsig
