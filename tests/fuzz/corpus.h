#pragma once

#include <string>
#include <vector>

namespace irsig::fuzz {

// Inputs of a reader that together reach what a search has reached of its branches, of the file
// tests/fuzz/corpus/NAME: for each a line with its length, its bytes and a line's end.
std::vector<std::string> read_corpus(const std::string& name);
void write_corpus(const std::string& name, std::vector<std::string> inputs);

}  // namespace irsig::fuzz
