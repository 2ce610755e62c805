#include "cli/renamed_option.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace irsig {
namespace {

struct RenamedOption {
  std::string_view command, was, is;
};
constexpr auto kRenamed = std::to_array<RenamedOption>({
    {"material check", "--sweep", "--sweep-file"},
    {"model plume", "--diameter-m", "--opening-diameter-m"},
    {"model terrain", "--layer", "--map-layer"},
    {"profile", "--profile", "--profile-name"},
    {"selftest", "--filter", "--cases"},
    {"show atmosphere", "--sun-azimuth-deg", "--sun-from-path-deg"},
    {"show atmosphere", "--sweep", "--sweep-file"},
    {"show atmosphere", "--temperature-k", "--air-temperature-k"},
    {"show gas", "--height-m", "--altitude-m"},
    {"show gas", "--sweep", "--sweep-file"},
    {"show sky", "--height-m", "--altitude-m"},
    {"show sky", "--sweep", "--sweep-file"},
    {"show sky", "--temperature-k", "--air-temperature-k"},
    {"show sun", "--height-m", "--altitude-m"},
    {"show sun", "--sweep", "--sweep-file"},
    {"show sun", "--temperature-k", "--air-temperature-k"},
    {"status", "--workers", "--by-worker"},
    {"verify-effects", "--reference", "--reference-paths"},
});

}  // namespace

std::string new_spelling(const CLI::App& command, const std::string& word) {
  std::string name;
  for (const CLI::App* at = &command; at->get_parent() != nullptr; at = at->get_parent())
    name = at->get_name() + (name.empty() ? "" : " " + name);
  const std::string option = word.substr(0, word.find('='));
  const auto* const found = std::ranges::find_if(kRenamed, [&](const RenamedOption& renamed) {
    return renamed.command == name && renamed.was == option;
  });
  return found == kRenamed.end() ? "" : std::string(found->is);
}

}  // namespace irsig
