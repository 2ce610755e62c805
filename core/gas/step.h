#pragma once

namespace irsig {

// A quantity before a change, and what the change adds, carried through sums, products and
// functions without subtracting two nearly equal numbers: a gas of optical depth 1e-12 behind one
// of 1 or 1e4 keeps its digits.
struct Step {
  double from = 0, by = 0;
  [[nodiscard]] double to() const { return from + by; }
};

[[nodiscard]] inline Step constant(double value) { return {value, 0}; }
[[nodiscard]] inline Step operator+(Step a, Step b) { return {a.from + b.from, a.by + b.by}; }
[[nodiscard]] inline Step operator-(Step a, Step b) { return {a.from - b.from, a.by - b.by}; }
[[nodiscard]] inline Step operator*(Step a, Step b) {
  return {a.from * b.from, a.by * b.to() + a.from * b.by};
}
[[nodiscard]] inline Step operator/(Step a, Step b) {
  const double ratio = a.from / b.from;
  return {ratio, (a.by - ratio * b.by) / b.to()};
}
[[nodiscard]] inline Step operator*(double a, Step b) { return {a * b.from, a * b.by}; }

}  // namespace irsig
