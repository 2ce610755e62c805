#pragma once

#include <cstdint>
#include <vector>

namespace irsig {

// Returns into how many groups of equal size the samples of a pixel are divided, each stratified
// over the pixel. The scatter of the groups' sums is the pixel's error: right where light scatters
// at random; too large by 2^(1/4) for each doubling of the groups on an edge, where the samples
// together are better stratified than each group alone. Hence two, unless samples are many, as in
// pictures of few pixels, whose errors few neighbours steady.
//   pixel_samples  a power of two, at least 2
[[nodiscard]] constexpr std::uint32_t pixel_groups(std::uint32_t pixel_samples) {
  return pixel_samples < 32 ? 2 : pixel_samples < 128 ? 4 : 8;
}

// Sums over the paths of pictures, row by row from the top left.
struct TracedPictures {
  std::vector<double> sum;     // [pixel][ImagePlan::images] radiance x solid angle x range^2 [W/sr]
  std::vector<float> stderr_;  // of it, from the scatter of the pixel's groups [W/sr]
  // How many of a pixel's samples met each part first: by pixel, then by part; behind hot gas
  // empty.
  struct Met {
    std::uint32_t pixel, part, samples;
  };
  std::vector<Met> met;
  // With ImagePlan::whole_parts: of which parts a pixel's samples meet any facet, one behind the
  // other, up to sea or ground. `part` of such an entry is a place in `part_set`, whose parts
  // increase.
  std::vector<Met> met_set;
  std::vector<std::vector<std::uint32_t>> part_set;
  // [pixel][image][kind] The parts of `sum`, if the plan keeps kinds of light apart.
  std::vector<float> kind_sum;
  std::vector<float> kind_stderr;  // of them, as `stderr_` is of `sum`
  // Where the plan has first hits: sums over the samples that met the target, of the distance
  // from the sensor [m] and the plan's further numbers. [pixel][ImagePlan::first_numbers()]
  std::vector<double> first_sum;
};

}  // namespace irsig
