#include "tests/fuzz/sweep_grammar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/effects/effects.h"
#include "jobs/files/material_kinds.h"
#include "jobs/text/number_bounds.h"
#include "jobs/text/sweep_file.h"

namespace irsig::fuzz {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

using Texts = std::vector<std::string>;

// Returns the words that the readers take, by message and key; text() adds names of the sweep.
const Texts& words_of(const std::string& key) {
  static const std::map<std::string, Texts> known = [] {
    const Texts axes = {"+x", "-x", "+y", "-y", "+z", "-z"};
    const Texts profiles = {"tropical",         "midlatitude_summer", "midlatitude_winter",
                            "subarctic_summer", "subarctic_winter",   "us_standard_1976"};
    std::map<std::string, Texts> out = {
        {"Plume.kind", {"funnel", "slab", "cylinder", "sphere", "file"}},
        {"Plume.interpolation", {"linear", "constant"}},
        {"Plume.forward_axis", axes},
        {"Plume.up_axis", axes},
        {"GasQuantity.grid", {"temperature", "density", "co2", "h2o", "none"}},
        {"GasQuantity.unit",
         {"K", "degC", "Pa", "hPa", "kPa", "bar", "atm", "1", "percent", "ppm"}},
        {"Uncertainty.sides", {"one", "both"}},
        {"Model.generate",
         {"disk", "sphere", "box", "cylinder", "cone", "frigate", "cooling_tower", "houses"}},
        {"Model.forward_axis", axes},
        {"Model.up_axis", axes},
        {"Model.reference", {"origin", "bbox_center", "bbox_bottom_center"}},
        {"Material.fresnel", {"exact", "schlick"}},
        {"Material.masking", {"v_groove", "smith"}},
        {"Material.entry", {"sea_water", "generic_grey_paint", "white_paint", "steel"}},
        {"Part.material", {"blackbody", "hull", "hull_index", "generic_grey_paint", "sea_water"}},
        {"Part.match", {"*", "hull*", "?", "none"}},
        {"BuildUp.inside", {"adiabatic", "heat_flux", "air", "temperature", "open"}},
        {"BuildUp.inside_between", {"linear", "steps"}},
        {"Layer.solid", {"steel", "concrete", "air", "mineral_wool", "nothing"}},
        {"Heat.history", {"periodic", "days"}},
        {"TemperatureField.unit", {"K", "degC", "degF"}},
        {"TemperatureField.match", {"index", "centroid"}},
        {"Season.profile", profiles},
        {"Vary.profile", profiles},
        {"Vary.combine", {"cross", "zip"}},
        {"Viewpoints.kind", {"fibonacci", "grid", "ring", "list"}},
        {"Surroundings.kind", {"none", "sea", "ground"}},
        {"Surroundings.sea_model", {"cox_munk", "flat", "grey"}},
        {"Air.model", {"vacuum", "homogeneous", "atmosphere"}},
        {"Air.profile", profiles},
        {"Air.aerosol",
         {"none", "rural", "urban", "maritime", "tropospheric", "navy_maritime", "advection_fog",
          "radiation_fog"}},
        {"Effects.mode", {"auto", "all", "only"}},
        {"Published.relation", {"equal", "below", "above"}},
        {"Season.date",
         {"2025-06-21", "2025-12-21", "2026-01-27", "2024-02-29", "2025-02-29", "1900-01-01",
          "2100-12-31", "21.6.2025", "2025", "2025-13-41"}}};
    const Texts times = {"12:00Z",
                         "10:30+09:00",
                         "23:59:59.5-07:30",
                         "2026-01-27T20:00:00Z",
                         "00:00+00:00",
                         "24:00Z",
                         "12:00",
                         "T",
                         "2026-01-27T"};
    for (const char* of : {"Sweep.time", "Season.time", "InsideAt.time"}) out[of] = times;
    for (const MaterialKind& kind : material_kinds()) out["Material.kind"].push_back(kind.name);
    for (const char* more : {"library", "blackbody", "hull", "hull_index", "hull_paper"})
      out["Material.kind"].push_back(more);
    const auto add_effects = [&](const auto& table) {
      for (const EffectInfo& effect : table)
        for (const char* list : {"Effects.only", "Effects.without"})
          out[list].emplace_back(effect.name);
    };
    add_effects(effect_table());
    add_effects(heat_effect_table());
    add_effects(plume_effect_table());
    return out;
  }();
  static const Texts none;
  const auto found = known.find(key);
  return found == known.end() ? none : found->second;
}

// Keys that name something of the sweep's own, and the list that it is in.
const char* list_named_by(const std::string& key) {
  static const std::map<std::string, const char*> lists = {
      {"Part.material", "material"},
      {"Part.build_up", "build_up"},
      {"Season.season", "season"},
      {"Season.temperature_field", "temperature_field"},
      {"Published.profile", "profile"}};
  const auto found = lists.find(key);
  return found == lists.end() ? nullptr : found->second;
}

std::string key_of(const Message& message, const FieldDescriptor& field) {
  return message.GetDescriptor()->name() + "." + field.name();
}

void write_text(const std::string& text, std::string& out) {
  out += '"';
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\u{:04x}", byte);
    else
      out += c;
  }
  out += '"';
}

void write_number(double value, std::string& out) {
  out += std::isnan(value)   ? "nan"
         : std::isinf(value) ? (value < 0 ? "-inf" : "inf")
                             : fmt::format("{}", value);
}

void write_scalar(const Message& message, const FieldDescriptor& field, int index,
                  std::string& out) {
  const Reflection& r = *message.GetReflection();
  const bool one = index < 0;
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING:
      return write_text(
          one ? r.GetString(message, &field) : r.GetRepeatedString(message, &field, index), out);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return write_number(
          one ? r.GetDouble(message, &field) : r.GetRepeatedDouble(message, &field, index), out);
    case FieldDescriptor::CPPTYPE_UINT32:
      out += std::to_string(one ? r.GetUInt32(message, &field)
                                : r.GetRepeatedUInt32(message, &field, index));
      return;
    case FieldDescriptor::CPPTYPE_UINT64:
      out += std::to_string(one ? r.GetUInt64(message, &field)
                                : r.GetRepeatedUInt64(message, &field, index));
      return;
    case FieldDescriptor::CPPTYPE_BOOL:
      out += (one ? r.GetBool(message, &field) : r.GetRepeatedBool(message, &field, index))
                 ? "true"
                 : "false";
      return;
    default:
      out += "0";
  }
}

// Keys first, then tables: what follows a table's heading is of that table.
void write_table(const Message& message, const std::string& path, std::string& out) {
  const Reflection& r = *message.GetReflection();
  std::vector<const FieldDescriptor*> present;
  r.ListFields(message, &present);
  for (const FieldDescriptor* field : present) {
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) continue;
    out += field->name() + " = ";
    if (field->is_repeated()) {
      out += "[";
      for (int i = 0; i < r.FieldSize(message, field); ++i) {
        if (i > 0) out += ", ";
        write_scalar(message, *field, i, out);
      }
      out += "]";
    } else {
      write_scalar(message, *field, -1, out);
    }
    out += "\n";
  }
  for (const FieldDescriptor* field : present) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const std::string below = path.empty() ? field->name() : path + "." + field->name();
    if (field->is_map()) {
      out += fmt::format("[{}]\n", below);
      for (int i = 0; i < r.FieldSize(message, field); ++i) {
        const Message& entry = r.GetRepeatedMessage(message, field, i);
        write_scalar(entry, *field->message_type()->map_key(), -1, out);
        out += " = ";
        write_scalar(entry, *field->message_type()->map_value(), -1, out);
        out += "\n";
      }
    } else if (field->is_repeated()) {
      for (int i = 0; i < r.FieldSize(message, field); ++i) {
        out += fmt::format("[[{}]]\n", below);
        write_table(r.GetRepeatedMessage(message, field, i), below, out);
      }
    } else {
      out += fmt::format("[{}]\n", below);
      write_table(r.GetMessage(message, field), below, out);
    }
  }
}

// Every number of a message, for others to be swapped with.
void collect_numbers(const Message& message, std::vector<double>& out) {
  const Reflection& r = *message.GetReflection();
  std::vector<const FieldDescriptor*> present;
  r.ListFields(message, &present);
  for (const FieldDescriptor* field : present) {
    if (field->is_map()) continue;
    const int count = field->is_repeated() ? r.FieldSize(message, field) : 1;
    for (int i = 0; i < std::min(count, 4); ++i) {
      if (field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE)
        out.push_back(field->is_repeated() ? r.GetRepeatedDouble(message, field, i)
                                           : r.GetDouble(message, field));
      if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
        collect_numbers(field->is_repeated() ? r.GetRepeatedMessage(message, field, i)
                                             : r.GetMessage(message, field),
                        out);
    }
  }
}

}  // namespace

std::string toml_of(const Message& message) {
  std::string out;
  write_table(message, "", out);
  return out;
}

SweepGrammar::SweepGrammar(const std::vector<std::string>& sound,
                           const std::vector<std::string>& parsed, std::vector<std::string> files)
    : files_(std::move(files)) {
  for (const auto& [texts, to] : {std::pair{&sound, &sound_}, {&parsed, &parsed_}})
    for (const std::string& text : *texts) {
      auto file = parse_sweep(text, "sound.toml");
      if (file.ok()) to->push_back(std::move(file->sweep));
    }
}

const schema::Sweep& SweepGrammar::other() { return one_of(below(4) > 0 ? sound_ : parsed_); }

// One of the sound ones; or its tables, some of them from others; or nothing at all.
schema::Sweep SweepGrammar::begin() {
  schema::Sweep out = other();
  const std::size_t how = below(10);
  if (how < 5) return out;
  if (how == 9) out.Clear();
  const Reflection& r = *out.GetReflection();
  for (int f = 0; f < out.GetDescriptor()->field_count(); ++f) {
    if (below(4) > 0) continue;
    const Field& field = *out.GetDescriptor()->field(f);
    const schema::Sweep& from = other();
    r.ClearField(&out, &field);
    if (field.cpp_type() != Field::CPPTYPE_MESSAGE || field.is_map()) continue;
    if (!field.is_repeated()) {
      if (r.HasField(from, &field))
        r.MutableMessage(&out, &field)->CopyFrom(r.GetMessage(from, &field));
      continue;
    }
    for (int i = 0; i < std::min(r.FieldSize(from, &field), 4); ++i)
      r.AddMessage(&out, &field)->CopyFrom(r.GetRepeatedMessage(from, &field, i));
  }
  if (how == 9) fill(out, 1);
  return out;
}

double SweepGrammar::number(const Message& message, const Field& field) {
  const NumberBounds& bounds = bounds_of(key_of(message, field));
  static const std::vector<double> odd = {0,   1,     -1,  0.5,  2,    10,   288,   300, 1e-9,
                                          1e9, 1e300, 5,   0.01, 0.1,  100,  1000,  45,  90,
                                          -90, 360,   3.3, 12,   1e-3, 0.05, 101325};
  switch (below(8)) {
    case 0:
      return below(2) == 0 ? bounds.least : bounds.most;
    case 1:
      return below(2) == 0 ? bounds.least - std::max(1e-9, std::abs(bounds.least) * 1e-6)
                           : bounds.most * 1.000001 + 1e-9;
    case 2:
    case 3:
      return one_of(odd);
    case 4:
    case 5: {
      std::vector<double> others;
      collect_numbers(other(), others);
      return others.empty() ? 0 : one_of(others);
    }
    default: {
      const double share = static_cast<double>(below(1001)) / 1000;
      const bool wide = bounds.least >= 0 && bounds.most > 1000 * (bounds.least + 1);
      return wide ? (bounds.least + 1e-3) *
                        std::pow((bounds.most + 1) / (bounds.least + 1e-3), share)
                  : bounds.least + share * (bounds.most - bounds.least);
    }
  }
}

std::uint64_t SweepGrammar::whole(const Message& message, const Field& field) {
  const NumberBounds& bounds = bounds_of(key_of(message, field));
  static const std::vector<std::uint64_t> odd = {0, 1, 2, 3, 5, 32, 100, 1000, 4294967295u};
  if (below(4) > 0) return one_of(odd);
  return static_cast<std::uint64_t>(
      std::clamp(below(2) == 0 ? bounds.least : bounds.most, 0.0, 1e15));
}

std::string SweepGrammar::text(const Message& message, const Field& field) {
  const std::string key = key_of(message, field);
  static const Texts odd = {"",         "x",  "hull", "any",  "a, b",      std::string(200, 'y'),
                            "\x1b[31m", "\t", "=1+1", "../x", "season[0]", "part[0].name: ",
                            "\u00e9"};
  if (below(10) == 0) return one_of(odd);
  if (field.name() == "file" || field.name().ends_with("_file"))
    return below(12) == 0 ? "none.csv" : one_of(files_);
  const Texts& words = words_of(key);
  if (!words.empty() && below(3) > 0) return one_of(words);
  // A name that some sound sweep has.
  const schema::Sweep& from = other();
  const char* list = list_named_by(key);
  const std::string of = list != nullptr ? list : field.name() == "name" ? "part" : "";
  if (const Field* names = from.GetDescriptor()->FindFieldByName(of)) {
    const int count = from.GetReflection()->FieldSize(from, names);
    if (count > 0) {
      const Message& named = from.GetReflection()->GetRepeatedMessage(
          from, names, static_cast<int>(below(static_cast<std::size_t>(count))));
      return named.GetReflection()->GetString(named,
                                              named.GetDescriptor()->FindFieldByName("name"));
    }
  }
  return words.empty() ? one_of(odd) : one_of(words);
}

void SweepGrammar::set(Message& message, const Field& field) {
  const Reflection& r = *message.GetReflection();
  const bool list = field.is_repeated();
  if (list && !field.is_map() && r.FieldSize(message, &field) > 0 && below(3) == 0)
    return r.RemoveLast(&message, &field);
  switch (field.cpp_type()) {
    case Field::CPPTYPE_DOUBLE:
      if (!list) return r.SetDouble(&message, &field, number(message, field));
      if (const int size = r.FieldSize(message, &field); size > 0 && below(2) == 0)
        return r.SetRepeatedDouble(&message, &field,
                                   static_cast<int>(below(static_cast<std::size_t>(size))),
                                   number(message, field));
      for (std::size_t i = below(4); i > 0; --i)
        r.AddDouble(&message, &field, number(message, field));
      return;
    case Field::CPPTYPE_UINT32: {
      const auto value = static_cast<std::uint32_t>(whole(message, field));
      return list ? r.AddUInt32(&message, &field, value) : r.SetUInt32(&message, &field, value);
    }
    case Field::CPPTYPE_UINT64:
      return r.SetUInt64(&message, &field, whole(message, field));
    case Field::CPPTYPE_BOOL:
      return r.SetBool(&message, &field, below(2) == 0);
    case Field::CPPTYPE_STRING:
      return list ? r.AddString(&message, &field, text(message, field))
                  : r.SetString(&message, &field, text(message, field));
    case Field::CPPTYPE_MESSAGE:
      break;
    default:
      return;
  }
  if (field.is_map()) {
    Message& entry = *r.AddMessage(&message, &field);
    const Field& value = *field.message_type()->map_value();
    entry.GetReflection()->SetString(&entry, field.message_type()->map_key(),
                                     below(2) == 0 ? "hull" : "funnel");
    return entry.GetReflection()->SetDouble(&entry, &value, 1 + static_cast<double>(below(600)));
  }
  if (!list) return fill(*r.MutableMessage(&message, &field), 1 + below(3));
  const int size = r.FieldSize(message, &field);
  Message& added = *r.AddMessage(&message, &field);
  if (size > 0 && below(2) == 0)  // twice
    added.CopyFrom(r.GetRepeatedMessage(message, &field, 0));
  else
    fill(added, 1 + below(3));
}

// Each field with a chance of so many in four.
void SweepGrammar::fill(Message& message, std::size_t of_four) {
  for (int f = 0; f < message.GetDescriptor()->field_count(); ++f)
    if (below(4) < of_four) set(message, *message.GetDescriptor()->field(f));
}

void SweepGrammar::change(Message& message) {
  const Reflection& r = *message.GetReflection();
  std::vector<const Field*> present;
  r.ListFields(message, &present);
  if (!present.empty() && below(5) > 0) {
    const Field& field = *one_of(present);
    if (field.cpp_type() == Field::CPPTYPE_MESSAGE && !field.is_map() && below(8) > 0) {
      if (!field.is_repeated()) return change(*r.MutableMessage(&message, &field));
      const auto size = static_cast<std::size_t>(r.FieldSize(message, &field));
      return change(*r.MutableRepeatedMessage(&message, &field, static_cast<int>(below(size))));
    }
    if (below(3) == 0) return r.ClearField(&message, &field);
    return set(message, field);
  }
  const auto fields = static_cast<std::size_t>(message.GetDescriptor()->field_count());
  set(message, *message.GetDescriptor()->field(static_cast<int>(below(fields))));
}

void SweepGrammar::shrink(schema::Sweep& sweep) {
  if (sweep.model().triangles() > 400 && sweep.model().triangles() < 1'000'000)
    sweep.mutable_model()->set_triangles(100 + below(300));
  if (sweep.viewpoints().count() > 12 && sweep.viewpoints().count() < 100'000)
    sweep.mutable_viewpoints()->set_count(static_cast<std::uint32_t>(1 + below(12)));
  while (sweep.time_size() > 3 && below(20) > 0) sweep.mutable_time()->RemoveLast();
}

// Damages the text in ways that no message has: values of another type, lines and tables twice or
// not at all.
void SweepGrammar::damage(std::string& toml) {
  static const Texts values = {
      "true",     "[]",       "{}",         "\"\"",  "nan",       "-inf",  "2025-12-21",
      "12:00:00", "\"text\"", "[1, \"a\"]", "1e999", "{ a = 1 }", "[[1]]", "18446744073709551616"};
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < toml.size();) {
    const std::size_t end = std::min(toml.find('\n', at), toml.size());
    lines.push_back(toml.substr(at, end - at));
    at = end + 1;
  }
  if (lines.empty()) return;
  const std::size_t at = below(lines.size());
  switch (below(4)) {
    case 0:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(at));
      break;
    case 1:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(below(lines.size())), lines[at]);
      break;
    default:
      if (const std::size_t equals = lines[at].find(" = "); equals != std::string::npos)
        lines[at] = lines[at].substr(0, equals + 3) + one_of(values);
  }
  toml.clear();
  for (const std::string& line : lines) toml += line + "\n";
}

std::string SweepGrammar::make(std::uint64_t seed) {
  random_.seed(seed);
  schema::Sweep sweep = begin();
  for (std::size_t i = below(4); i > 0; --i) change(sweep);
  shrink(sweep);
  std::string toml = toml_of(sweep);
  if (below(6) == 0) damage(toml);
  return toml;
}

}  // namespace irsig::fuzz
