#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace irsig {

// Returns the new spelling of an option that a command had under another name; empty: it had none.
// Those options had two meanings, depending on the command; each spelling has one meaning now.
[[nodiscard]] std::string new_spelling(const CLI::App& command, const std::string& word);

}  // namespace irsig
