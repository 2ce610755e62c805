#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/problems.h"
#include "core/base/status_macros.h"
#include "jobs/text/nearest_name.h"
#include "jobs/text/number_bounds.h"
#include "jobs/text/section_check.h"
#include "jobs/text/sweep_file.h"
#include "jobs/text/toml_nesting.h"

namespace irsig {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

std::string what_it_is(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    case toml::node_type::date:
      return "a date";
    case toml::node_type::time:
      return "a time";
    case toml::node_type::date_time:
      return "a date and time";
    default:
      return "nothing";
  }
}

// A number alone may stand for a table with this key.
const FieldDescriptor* constant_of(const FieldDescriptor& field) {
  return field.message_type() == nullptr ? nullptr
                                         : field.message_type()->FindFieldByName("constant");
}

std::string what_is_expected(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING:
      return "a string in quotes";
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return "a number";
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return constant_of(field) != nullptr ? "a number or a table" : "a table";
    default:
      return "a whole number, 0 or more";
  }
}

// Returns true for a field that is a table, or an array of tables, and nothing else.
bool is_table(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_map() &&
         constant_of(field) == nullptr;
}

std::vector<std::string> table_keys(const Descriptor& table) {
  std::vector<std::string> keys;
  for (int i = 0; i < table.field_count(); ++i) keys.push_back(table.field(i)->name());
  return keys;
}

// Every table of the grammar that has a key, as it is written: "[air]", "[[season]]". Where the key
// is a table by itself, that table: "[[season.cloud]]".
void find_homes(const std::string& key, const Descriptor& table, const std::string& path,
                bool repeated, std::vector<std::string>& out) {
  const FieldDescriptor* found = table.FindFieldByName(key);
  if (found != nullptr && is_table(*found) && !path.empty())
    out.push_back(found->is_repeated() ? absl::StrCat("[[", path, ".", key, "]]")
                                       : absl::StrCat("[", path, ".", key, "]"));
  else if (found != nullptr)
    out.push_back(path.empty() ? "the top level"
                  : repeated   ? absl::StrCat("[[", path, "]]")
                               : absl::StrCat("[", path, "]"));
  for (int i = 0; i < table.field_count(); ++i) {
    const FieldDescriptor& field = *table.field(i);
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE || field.is_map()) continue;
    find_homes(key, *field.message_type(),
               path.empty() ? field.name() : absl::StrCat(path, ".", field.name()),
               field.is_repeated(), out);
  }
}
std::vector<std::string> homes_of(const std::string& key, const Descriptor& root) {
  std::vector<std::string> out;
  find_homes(key, root, "", false, out);
  return out;
}

// "season.cloud" of "season[0].cloud": as the header of a table is written.
std::string without_indices(std::string_view path) {
  std::string out;
  bool inside = false;
  for (const char c : path) {
    inside = inside || c == '[';
    if (!inside) out += c;
    if (c == ']') inside = false;
  }
  return out;
}

// The key of a table that has another unit than an unknown key, and the conversion; else empty.
std::string meant_in_another_unit(std::string_view key, const std::vector<std::string>& keys) {
  struct Unit {
    std::string_view typed, kept, example;
  };
  static constexpr Unit units[] = {{"_c", "_k", "20 C are 293.15 K"},
                                   {"_celsius", "_k", "20 C are 293.15 K"},
                                   {"_degc", "_k", "20 C are 293.15 K"},
                                   {"_f", "_k", "68 F are 293.15 K"},
                                   {"_km", "_m", "5 km are 5000 m"},
                                   {"_mm", "_m", "5 mm are 0.005 m"},
                                   {"_cm", "_m", "5 cm are 0.05 m"},
                                   {"_ft", "_m", "1 ft is 0.3048 m"},
                                   {"_um", "_m", "15 um are 1.5e-05 m"},
                                   {"_nm", "_um", "4000 nm are 4 um"},
                                   {"_mk", "_k", "25 mK are 0.025 K"},
                                   {"_mrad", "_rad", "1 mrad is 0.001 rad"},
                                   {"_mrad", "_deg", "10 mrad are 0.572958 deg"},
                                   {"_hpa", "_pa", "1013 hPa are 101300 Pa"},
                                   {"_mbar", "_pa", "1013 mbar are 101300 Pa"},
                                   {"_rad", "_deg", "1 rad is 57.2958 deg"},
                                   {"_kn", "_m_s", "10 kn are 5.144 m/s"},
                                   {"_kmh", "_m_s", "36 km/h are 10 m/s"},
                                   {"_km_h", "_m_s", "36 km/h are 10 m/s"}};
  for (const Unit& unit : units) {
    if (!key.ends_with(unit.typed)) continue;
    const std::string kept =
        std::string(key.substr(0, key.size() - unit.typed.size())) + std::string(unit.kept);
    if (std::ranges::find(keys, kept) != keys.end())
      return absl::StrCat("expected \"", kept, "\" (", std::string(unit.example), ")");
  }
  return "";
}

// Keys that the unknown one stands for together: "lambda_min_um" and "lambda_max_um" of
// "lambda_um".
std::vector<std::string> parts_of(std::string_view key, const std::vector<std::string>& keys) {
  std::vector<std::string> out;
  const std::size_t end = key.rfind('_');
  if (end == key.npos) return out;
  for (const std::string& known : keys)
    if (known.starts_with(key.substr(0, end + 1)) && known.ends_with(key.substr(end)))
      out.push_back(known);
  return out;
}

// Returns the most likely cause of a TOML syntax error in this line.
std::string hint_of_toml(std::string_view what, std::string_view line) {
  const auto says = [&](std::string_view words) { return what.find(words) != what.npos; };
  const std::size_t equals = line.find('=');
  std::string value(equals == line.npos ? line.substr(line.size()) : line.substr(equals + 1));
  absl::StripAsciiWhitespace(&value);
  const bool number =
      !value.empty() && absl::ascii_isdigit(static_cast<unsigned char>(
                            value.front() == '-' && value.size() > 1 ? value[1] : value[0]));
  const std::string word = absl::AsciiStrToLower(value.substr(0, value.find_first_of(" #\t")));
  if (word == "yes" || word == "no" || word == "on" || word == "off" || word == "true" ||
      word == "false")
    return " (a switch is true or false, in lower case and without quotes)";
  if (says("control characters other than TAB"))
    return " (the closing quote of this text is missing)";
  if (says("unknown escape sequence")) return " (names of files are written with /)";
  if (says("cannot redefine existing array"))
    return " (another one of a kind is [[in two brackets]])";
  if (says("cannot redefine existing table")) return " (several of a kind are [[in two brackets]])";
  if (says("cannot redefine existing")) return " (each key stands once in its table: delete one)";
  if (says("saw '%'")) return " (a fraction: 1 % is 0.01)";
  if (says("saw ';'")) return " (a line ends without a semicolon)";
  if (says("saw '/'")) return " (a remark begins with #)";
  if (says("saw ':'")) return " (KEY = VALUE)";
  if (number && says("saw ','")) return " (numbers have a decimal point: 54.3)";
  if (says("expected decimal digit, saw '.'") || (value.starts_with(".")))
    return " (a number begins with a digit: 0.01)";
  if (number && (says("expected a comment or whitespace") || says("expected digit")))
    return " (a number stands alone, without its unit)";
  if (says("saw ','")) return " (numbers have a decimal point: 54.3)";
  if (says("could not determine value type")) return " (text stands in \"straight quotes\")";
  return "";
}

// Walks a TOML table and the message of the same shape together.
class Filler {
 public:
  // root: the grammar.
  Filler(SweepFile& file, Findings& findings, const Descriptor& root)
      : file_(file), findings_(findings), root_(&root) {}

  void fill_table(const toml::table& table, const std::string& path, Message& message) {
    for (const auto& [toml_key, node] : table) {
      const std::string key(toml_key.str());
      const std::string key_path = path.empty() ? key : absl::StrCat(path, ".", key);
      remember(key_path, toml_key.source());
      const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(key);
      if (field == nullptr) {
        findings_.add(key_path, absl::StrCat("unknown key \"", key, "\"", home_of(path), ", ",
                                             what_was_meant(key, *message.GetDescriptor())));
      } else if (field->is_map()) {
        fill_map(node, key_path, *field, message);
      } else if (field->is_repeated()) {
        fill_array(node, key_path, *field, message);
      } else {
        fill_value(node, key_path, *field, message);
      }
    }
  }

 private:
  void remember(const std::string& path, const toml::source_region& source) {
    file_.where[path] =
        absl::StrCat(file_.file_name, ":", source.begin.line, ":", source.begin.column);
  }

  // A key of this table that is like it, else the tables that have it.
  [[nodiscard]] std::string what_was_meant(const std::string& key, const Descriptor& table) const {
    const std::vector<std::string> keys = table_keys(table);
    std::vector<std::string> homes = homes_of(key, *root_);
    if (std::string unit = meant_in_another_unit(key, keys); !unit.empty()) return unit;
    if (const auto parts = parts_of(key, keys); parts.size() > 1)
      return absl::StrCat("expected ", quoted_list(parts));
    if (homes.empty() || nearest_name(key, keys)) return suggestion(key, keys);
    constexpr std::size_t kMost = 4;
    if (homes.size() > kMost) homes.resize(kMost);
    const bool is_header = homes.front().find(absl::StrCat(".", key, "]")) != std::string::npos;
    return absl::StrCat(is_header ? "expected " : "it is a key of ", absl::StrJoin(homes, ", "));
  }

  static std::string home_of(const std::string& path) {
    return path.empty() ? "" : absl::StrCat(" in ", path);
  }

  void wrong_type(const toml::node& node, const std::string& path, const std::string& expected) {
    const bool quoted_number = node.is_string() && expected == "a number";
    findings_.add(path, absl::StrCat(path, " is ", what_it_is(node), ", expected ", expected,
                                     quoted_number ? " without quotes and unit" : ""));
  }

  // The key for several numbers, of a list that stands at the key for one: ranges_m of range_m.
  static std::string of_several(const toml::node& node, const FieldDescriptor& field) {
    std::string name(field.name());
    name.insert(std::min(name.rfind('_'), name.size()), "s");
    const FieldDescriptor* several = field.containing_type()->FindFieldByName(name);
    return node.is_array() && several != nullptr && several->is_repeated()
               ? absl::StrCat(" (several: ", name, ")")
               : "";
  }

  // Every key of a map is a name of the user's own.
  void fill_map(const toml::node& node, const std::string& path, const FieldDescriptor& field,
                Message& message) {
    const toml::table* table = node.as_table();
    if (table == nullptr) return wrong_type(node, path, "a table: name = number");
    for (const auto& [toml_key, value] : *table) {
      const std::string key(toml_key.str());
      const std::string key_path = absl::StrCat(path, ".", key);
      remember(key_path, toml_key.source());
      Message* entry = message.GetReflection()->AddMessage(&message, &field);
      entry->GetReflection()->SetString(entry, field.message_type()->map_key(), key);
      fill_value(value, key_path, *field.message_type()->map_value(), *entry);
    }
  }

  void fill_array(const toml::node& node, const std::string& path, const FieldDescriptor& field,
                  Message& message) {
    const bool of_tables = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    const toml::array* array = node.as_array();
    if (array == nullptr) {
      return wrong_type(node, path,
                        of_tables
                            ? absl::StrCat("an array of tables: [[", without_indices(path), "]]")
                            : absl::StrCat("an array: [ ", what_is_expected(field), ", ... ]"));
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::node& element = (*array)[i];
      const std::string element_path = absl::StrCat(path, "[", i, "]");
      remember(element_path, element.source());
      fill_value(element, element_path, field, message);
    }
  }

  // One value, set or (repeated field) appended.
  void fill_value(const toml::node& node, const std::string& path, const FieldDescriptor& field,
                  Message& message) {
    const Reflection& reflection = *message.GetReflection();
    const bool append = field.is_repeated();
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE: {
        const toml::table* table = node.as_table();
        const FieldDescriptor* constant = constant_of(field);
        if (table == nullptr && (constant == nullptr || !node.is_number()))
          return wrong_type(node, path,
                            node.is_array() && !append
                                ? absl::StrCat("a table: [", without_indices(path), "]")
                                : what_is_expected(field));
        Message* inner = append ? reflection.AddMessage(&message, &field)
                                : reflection.MutableMessage(&message, &field);
        if (table == nullptr) return fill_value(node, path, *constant, *inner);
        return fill_table(*table, path, *inner);
      }
      case FieldDescriptor::CPPTYPE_STRING: {
        const std::optional<std::string> text = string_of(node, field);
        if (!text) return wrong_string(node, path, field);
        return append ? reflection.AddString(&message, &field, *text)
                      : reflection.SetString(&message, &field, *text);
      }
      case FieldDescriptor::CPPTYPE_BOOL: {
        const toml::value<bool>* value = node.as_boolean();
        if (value == nullptr) return wrong_type(node, path, what_is_expected(field));
        return append ? reflection.AddBool(&message, &field, value->get())
                      : reflection.SetBool(&message, &field, value->get());
      }
      case FieldDescriptor::CPPTYPE_DOUBLE: {
        double value = 0;
        if (const auto* real = node.as_floating_point()) {
          value = real->get();
        } else if (const auto* integer = node.as_integer()) {
          constexpr std::int64_t kExact = std::int64_t{1} << 53;
          if (integer->get() > kExact || integer->get() < -kExact) {
            return findings_.add(
                path, absl::StrCat(path, " = ", integer->get(), " has more digits than a number ",
                                   "keeps, expected it from ", -kExact, " to ", kExact,
                                   ", or with a decimal point"));
          }
          value = static_cast<double>(integer->get());
        } else {
          return wrong_type(node, path,
                            absl::StrCat(what_is_expected(field), of_several(node, field)));
        }
        if (!std::isfinite(value)) {
          return findings_.add(path,
                               absl::StrCat(path, " is ", std::isnan(value) ? "nan" : "infinite",
                                            ", expected a finite number"));
        }
        return append ? reflection.AddDouble(&message, &field, value)
                      : reflection.SetDouble(&message, &field, value);
      }
      case FieldDescriptor::CPPTYPE_UINT32:
        if (const auto value =
                whole_number(node, path, field, std::numeric_limits<std::uint32_t>::max())) {
          const auto narrow = static_cast<std::uint32_t>(*value);
          append ? reflection.AddUInt32(&message, &field, narrow)
                 : reflection.SetUInt32(&message, &field, narrow);
        }
        return;
      case FieldDescriptor::CPPTYPE_UINT64:
        if (const auto value =
                whole_number(node, path, field, std::numeric_limits<std::uint64_t>::max())) {
          append ? reflection.AddUInt64(&message, &field, *value)
                 : reflection.SetUInt64(&message, &field, *value);
        }
        return;
      default:
        findings_.add(path, absl::StrCat(path, " has a type that sweep files do not use"));
    }
  }

  // A TOML date without quotes is what people write for a season's date.
  static std::optional<std::string> string_of(const toml::node& node,
                                              const FieldDescriptor& field) {
    if (const auto* text = node.as_string()) return text->get();
    if (const auto* date = node.as_date(); date != nullptr && field.name() == "date") {
      char text[16];
      std::snprintf(text, sizeof text, "%04u-%02u-%02u", unsigned{date->get().year},
                    unsigned{date->get().month}, unsigned{date->get().day});
      return text;
    }
    return std::nullopt;
  }

  void wrong_string(const toml::node& node, const std::string& path, const FieldDescriptor& field) {
    if (field.name() == "time" && (node.is_time() || node.is_date_time())) {
      return wrong_type(node, path,
                        "a time of day with its offset from UTC, in quotes: \"10:30+09:00\"");
    }
    wrong_type(node, path, what_is_expected(field));
  }

  // 24 and 2e6 are whole numbers, -1 and 1.5 are not.
  std::optional<std::uint64_t> whole_number(const toml::node& node, const std::string& path,
                                            const FieldDescriptor& field, std::uint64_t largest) {
    std::string found;
    if (const auto* integer = node.as_integer()) {
      const std::int64_t value = integer->get();
      if (value >= 0 && static_cast<std::uint64_t>(value) <= largest) {
        return static_cast<std::uint64_t>(value);
      }
      found = absl::StrCat(value);
    } else if (const auto* real = node.as_floating_point()) {
      constexpr double kExactlyCounted = 9007199254740992.0;  // 2^53
      const double value = real->get();
      if (value >= 0 && value <= kExactlyCounted && value == std::floor(value) &&
          value <= static_cast<double>(largest)) {
        return static_cast<std::uint64_t>(value);
      }
      found = absl::StrCat(value);
    } else {
      wrong_type(node, path, what_is_expected(field));
      return std::nullopt;
    }
    const NumberBounds& bounds =
        bounds_of(absl::StrCat(field.containing_type()->name(), ".", field.name()));
    findings_.add(path, absl::StrCat(path, " = ", found, ", expected a whole number ",
                                     bounds.most < static_cast<double>(largest)
                                         ? text_of(bounds)
                                         : absl::StrCat("from 0 to ", largest)));
    return std::nullopt;
  }

  SweepFile& file_;
  Findings& findings_;
  const Descriptor* root_;
};

}  // namespace

absl::Status fill_from_toml(std::string_view text, SweepFile& file, Message& message) {
  RETURN_IF_ERROR(check_toml_nesting(text, file.file_name));
  toml::table table;
  try {
    table = toml::parse(text, file.file_name);
  } catch (
      const toml::parse_error& error) {  // the library's way to say it; goes no further than this
    const toml::source_position at = error.source().begin;
    std::string what = one_line(std::string(error.description()));
    std::string_view line = text;
    for (toml::source_index i = 1; i < at.line && !line.empty(); ++i)
      line.remove_prefix(std::min(line.find('\n'), line.size() - 1) + 1);
    what += hint_of_toml(what, line.substr(0, line.find('\n')));
    return placed_problem(absl::StrCat(file.file_name, ":", at.line, ":", at.column), what);
  }
  Findings findings(file);
  Filler(file, findings, *message.GetDescriptor()).fill_table(table, "", message);
  return findings.status();
}

absl::StatusOr<SweepFile> parse_sweep(std::string_view text, std::string_view file_name) {
  SweepFile file;
  file.file_name = std::string(file_name);
  RETURN_IF_ERROR(fill_from_toml(text, file, file.sweep));
  return file;
}

}  // namespace irsig
