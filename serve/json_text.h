#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace irsig {

// An object of JSON, written field by field. Numbers have enough digits to give the same double
// back; numbers that are not finite become null.
class JsonObject {
 public:
  void text(std::string_view name, std::string_view value);
  void number(std::string_view name, double value);
  void count(std::string_view name, std::uint64_t value);
  void flag(std::string_view name, bool value);
  void numbers(std::string_view name, const std::vector<double>& values);
  void counts(std::string_view name, const std::vector<std::uint64_t>& values);
  void texts(std::string_view name, const std::vector<std::string>& values);
  void json(std::string_view name, std::string_view value);  // as it is
  void objects(std::string_view name, const std::vector<std::string>& values);

  [[nodiscard]] std::string finish() const { return "{" + body_ + "}"; }

 private:
  std::string body_;
  void name(std::string_view name);
};

}  // namespace irsig
