#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace irsig::fuzz {

// Reader of files that somebody else wrote. Whatever stands in a file, the reader refuses it with a
// place, or its result is sound.
struct Reader {
  std::string name;
  std::vector<std::string> sound;  // files that are accepted: mutants start from them
  std::vector<const char*> words;  // that it may trip over
  // Whether a file is accepted; what must not be breaks an expectation of gtest.
  std::function<bool(const std::string&)> accepts;
  int turns = 2000;         // mutants in a usual run
  std::size_t crowded = 0;  // Mutator
};

// All of them, each under its own name.
const std::vector<Reader>& readers();
const Reader* reader_named(std::string_view name);  // null: there is none

std::vector<Reader> air_readers();      // soundings, paths of other codes, weather
std::vector<Reader> optical_readers();  // materials
std::vector<Reader> table_readers();    // responses, detectors, weights, temperatures
std::vector<Reader> scene_readers();    // sweeps, goniometers, meshes

bool accepts_mesh(const std::string& bytes, const std::string& name, const std::string& reference);

// A refusal: INVALID_ARGUMENT, with a place (file:line:column) at the beginning of each line, or
// at least the file at its beginning. false.
enum class Says { kPlace, kFile };
bool refused(const absl::Status& status, std::string_view file, Says says = Says::kPlace);

}  // namespace irsig::fuzz
