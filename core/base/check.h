#pragma once

#include <concepts>
#include <sstream>
#include <string>
#include <utility>

// IRSIG_CHECK(a < b): for what is impossible unless the program is wrong. Prints the place, the
// expression and both operands, and aborts, in every build type. What a user or a file can cause is
// an absl::Status instead.
//
// The condition is one comparison, or one value that converts to bool; for "and" write two checks.
#define IRSIG_CHECK(...)                                                                     \
  do {                                                                                       \
    _Pragma("GCC diagnostic push") _Pragma("GCC diagnostic ignored \"-Wparentheses\"");      \
    if (const ::irsig::check_detail::Outcome irsig_outcome = ::irsig::check_detail::Start{}  \
                                                             << __VA_ARGS__;                 \
        !irsig_outcome.holds) [[unlikely]] {                                                 \
      ::irsig::check_detail::fail(__FILE__, __LINE__, #__VA_ARGS__, irsig_outcome.operands); \
    }                                                                                        \
    _Pragma("GCC diagnostic pop")                                                            \
  } while (false)

namespace irsig::check_detail {

[[noreturn]] void fail(const char* file, int line, const char* expression,
                       const std::string& operands);

template <typename T>
concept StandardInteger = std::integral<T> && !std::same_as<T, bool> && !std::same_as<T, char>;

template <typename T>
std::string printed(const T& value) {
  if constexpr (requires(std::ostream & out) { out << value; }) {
    std::ostringstream out;
    out.precision(17);
    out << value;
    return out.str();
  } else {
    return "(unprintable)";
  }
}

// The left operand, caught by Start{} << a because << binds tighter than any comparison.
template <typename A>
struct Left {
  const A& value;
};
struct Start {
  template <typename A>
  friend Left<A> operator<<(Start, const A& value) {
    return {value};
  }
};

struct Outcome {
  bool holds;
  std::string operands;

  Outcome(bool outcome, std::string text) : holds(outcome), operands(std::move(text)) {}
  template <typename A>
  Outcome(Left<A> left)  // NOLINT(google-explicit-constructor): IRSIG_CHECK(pointer)
      : holds(static_cast<bool>(left.value)), operands(holds ? "" : printed(left.value)) {}
};

template <typename A, typename B>
Outcome outcome(bool holds, const A& a, const B& b) {
  return {holds, holds ? std::string() : printed(a) + " against " + printed(b)};
}

// Integers of different signedness compare by value, as std::cmp_less does.
#define IRSIG_CHECK_COMPARISON(op, compare)                   \
  template <typename A, typename B>                           \
  Outcome operator op(Left<A> a, const B& b) {                \
    if constexpr (StandardInteger<A> && StandardInteger<B>) { \
      return outcome(std::compare(a.value, b), a.value, b);   \
    } else {                                                  \
      return outcome(a.value op b, a.value, b);               \
    }                                                         \
  }
IRSIG_CHECK_COMPARISON(==, cmp_equal)
IRSIG_CHECK_COMPARISON(!=, cmp_not_equal)
IRSIG_CHECK_COMPARISON(<, cmp_less)
IRSIG_CHECK_COMPARISON(<=, cmp_less_equal)
IRSIG_CHECK_COMPARISON(>, cmp_greater)
IRSIG_CHECK_COMPARISON(>=, cmp_greater_equal)
#undef IRSIG_CHECK_COMPARISON

}  // namespace irsig::check_detail
