#include "serve/json_text.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "core/base/printable.h"

namespace irsig {
namespace {

void append_number(std::string& out, double value) {
  if (std::isfinite(value))
    fmt::format_to(std::back_inserter(out), "{}", value);
  else
    out += "null";
}

template <typename Values, typename Append>
void append_array(std::string& out, const Values& values, const Append& append) {
  out += "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) out += ",";
    append(values[i]);
  }
  out += "]";
}

}  // namespace

void JsonObject::name(std::string_view name) {
  if (!body_.empty()) body_ += ",";
  body_ += json_string(name);
  body_ += ":";
}

void JsonObject::text(std::string_view field, std::string_view value) {
  name(field);
  body_ += json_string(value);
}

void JsonObject::number(std::string_view field, double value) {
  name(field);
  append_number(body_, value);
}

void JsonObject::count(std::string_view field, std::uint64_t value) {
  name(field);
  body_ += fmt::format("{}", value);
}

void JsonObject::flag(std::string_view field, bool value) {
  name(field);
  body_ += value ? "true" : "false";
}

void JsonObject::numbers(std::string_view field, const std::vector<double>& values) {
  name(field);
  append_array(body_, values, [&](double v) { append_number(body_, v); });
}

void JsonObject::counts(std::string_view field, const std::vector<std::uint64_t>& values) {
  name(field);
  append_array(body_, values, [&](std::uint64_t v) { body_ += fmt::format("{}", v); });
}

void JsonObject::texts(std::string_view field, const std::vector<std::string>& values) {
  name(field);
  append_array(body_, values, [&](const std::string& v) { body_ += json_string(v); });
}

void JsonObject::json(std::string_view field, std::string_view value) {
  name(field);
  body_ += value;
}

void JsonObject::objects(std::string_view field, const std::vector<std::string>& values) {
  name(field);
  append_array(body_, values, [&](const std::string& v) { body_ += v; });
}

}  // namespace irsig
