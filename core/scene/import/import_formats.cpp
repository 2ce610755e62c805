#include "core/scene/import/import_formats.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "fmt/format.h"

namespace irsig {

bool coordinate_of(const Token& word, FileErrors& errors, double& out) {
  const std::optional<double> value = number_of(word.text);
  if (!value) {
    const bool comma = word.text.find(',') != word.text.npos;
    add_at(errors, word,
           word ? fmt::format("\"{}\" is not a number that a double can hold{}", word.text,
                              comma ? ": export the model with decimal points" : "")
                : std::string("a number is missing"));
    return false;
  }
  if (!std::isfinite(*value)) {
    add_at(errors, word, fmt::format("the coordinate \"{}\" is not finite", word.text));
    return false;
  }
  out = *value;
  return true;
}

std::string GroupTable::join(const std::vector<std::string>& names) {
  std::vector<std::string> kept;
  for (const std::string& name : names) {
    if (!name.empty() && std::find(kept.begin(), kept.end(), name) == kept.end())
      kept.push_back(name);
  }
  return kept.empty() ? "default" : fmt::format("{}", fmt::join(kept, "/"));
}

std::uint32_t GroupTable::number(const std::string& name) {
  const auto [at, added] =
      number_.try_emplace(name, static_cast<std::uint32_t>(mesh_.group.size()));
  if (added) mesh_.group.push_back(name);
  return at->second;
}

std::uint32_t VertexMerger::number(const Vec<FileFrame>& at) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
  const auto [entry, added] = number_.try_emplace({bits(at.x), bits(at.y), bits(at.z)},
                                                  static_cast<std::uint32_t>(mesh_.vertex.size()));
  if (added) mesh_.vertex.push_back(at);
  return entry->second;
}

}  // namespace irsig
