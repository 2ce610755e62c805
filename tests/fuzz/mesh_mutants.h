#pragma once

#include <cctype>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/mutator.h"
#include "tests/unit/float32_files.h"

namespace irsig::fuzz {

inline constexpr const char* kMeshWords[] = {
    " ",     "\n",       " -1 ", " 0 ",   "nan",          "1e308 ",
    "/",     "-1e-320 ", "//",   "f ",    " 4294967296 ", " 99999999999999999999 ",
    "\\\n",  "v ",       "o ",   "list ", "vertex ",      "\nf 1 2 3 4 5 6 7 8 9 10\n",
    "facet "};

// Puts numbers in place of up to three numbers of a JSON text: it stays JSON, and says what is not
// so.
inline std::string with_other_numbers(std::string json, std::mt19937_64& random) {
  constexpr const char* kNumbers[] = {
      "0",     "1",          "2",          "3",    "4",          "5",   "7",    "12",
      "5120",  "5121",       "5123",       "5125", "5126",       "-1",  "1000", "65535",
      "65536", "2147483647", "4294967295", "48",   "4294967296", "1e9", "0.5",  "1e300"};
  for (std::uint64_t left = 1 + random() % 3; left > 0; --left) {
    std::vector<std::size_t> at;
    for (std::size_t i = 1; i < json.size(); ++i)
      if (std::isdigit(static_cast<unsigned char>(json[i])) != 0 &&
          std::string_view("[,:").find(json[i - 1]) != std::string_view::npos)
        at.push_back(i);
    if (at.empty()) return json;
    const std::size_t begin = at[random() % at.size()];
    const std::size_t end = json.find_first_of(",]}", begin);
    json.replace(begin, end - begin, kNumbers[random() % std::size(kNumbers)]);
  }
  return json;
}

// Damaged glTF and GLB files: half of them in their bytes, half in their JSON's numbers alone.
class GltfMutator {
 public:
  GltfMutator(bool glb, std::uint64_t seed)
      : glb_(glb), scene_(gltf_scene(!glb)), random_(seed), bytes_(seed, kMeshWords) {}

  std::string next() {
    const bool in_bytes = random_() % 2 == 0;
    if (!glb_)
      return in_bytes ? bytes_.mutate(scene_.json) : with_other_numbers(scene_.json, random_);
    if (!in_bytes) return glb_file(with_other_numbers(scene_.json, random_), scene_.buffer);
    // The lengths are right again in half of these, so that the JSON is looked at.
    return random_() % 2 == 0 ? glb_file(bytes_.mutate(scene_.json), scene_.buffer)
                              : bytes_.mutate(glb_file(scene_.json, scene_.buffer));
  }

 private:
  bool glb_;
  GltfScene scene_;
  std::mt19937_64 random_;
  Mutator bytes_;
};

}  // namespace irsig::fuzz
