#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>

namespace irsig::fuzz {

// Changes a text in one to four places: bytes put in, taken out, changed; words that readers trip
// over; pieces of itself; its end cut off. The same for the same seed.
class Mutator {
 public:
  // words: what a reader of this kind may trip over. Half of the places lie in the first
  // `crowded` bytes (0: all are equal).
  Mutator(std::uint64_t seed, std::span<const char* const> words, std::size_t crowded = 0)
      : random_(seed), words_(words), crowded_(crowded) {}

  std::string mutate(std::string text) {
    for (std::size_t i = below(4) + 1; i > 0; --i) {
      const bool in_front = crowded_ > 0 && below(2) == 0;
      const std::size_t at = below((in_front ? std::min(text.size(), crowded_) : text.size()) + 1);
      const std::size_t length = below(12);
      switch (below(6)) {
        case 0:
          text.insert(at, 1, static_cast<char>(below(256)));
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          if (at < text.size()) text[at] = static_cast<char>(below(256));
          break;
        case 3:
          text.insert(at, words_[below(words_.size())]);
          break;
        case 4:
          text.insert(at, text.substr(below(text.size() + 1), (crowded_ > 0 ? 40 : 4) * length));
          break;
        default:
          if (below(8) == 0) text.resize(at);
      }
    }
    return text;
  }

 private:
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }
  std::mt19937_64 random_;
  std::span<const char* const> words_;
  std::size_t crowded_;
};

}  // namespace irsig::fuzz
