#pragma once

#include <string>

#include "CLI/CLI.hpp"

namespace irsig {

// Returns a check of an option's value: a number above 0. CLI11's own prints all digits of the
// largest number as the upper limit.
inline CLI::Validator positive_number() {
  return {[](const std::string& text) {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && value > 0) return std::string();
            return text + " is not a number above 0";
          },
          "POSITIVE"};
}

// Returns a check of a seed: only digits are allowed, because CLI11 reads -1 as the largest number.
inline CLI::Validator seed_number() {
  return {[](const std::string& text) {
            const bool digits =
                !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
            return digits ? std::string() : text + " is not a whole number of at least 0";
          },
          ""};
}

}  // namespace irsig
