// docs/reference/keys is complete: a table for each table of schema/sweep.proto with a row for each
// of its keys and nothing else, and the defaults and examples in it are those of the code.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "core/effects/effects.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

struct Row {
  std::string unit, fallback, meaning, example;
};
struct Page {
  std::map<std::string, std::map<std::string, Row>> rows;  // by table path ("" = top level), by key
  std::vector<std::string> blocks;                         // the TOML blocks
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream in(line);
  std::string cell;
  while (std::getline(in, cell, '|')) {
    const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

// `[air]`, `[season.surroundings]` and `[[part]]` name tables in a heading.
std::vector<std::string> tables_named_in(const std::string& heading) {
  std::vector<std::string> names;
  for (std::size_t at = heading.find("`["); at != std::string::npos; at = heading.find("`[", at)) {
    const std::size_t first = heading.find_first_not_of("`[", at);
    at = heading.find(']', first);
    names.push_back(heading.substr(first, at - first));
  }
  return names;
}

std::filesystem::path reference() {
  return std::filesystem::path(IRSIG_SOURCE_DIR) / "docs/reference";
}

// Adds a page: "# `[place]`", then, where it has several tables, "- `[[other.table]]`", then keys.
void read_page(const std::filesystem::path& file, Page& page) {
  std::stringstream in(text_of(file));
  std::string line;
  std::vector<std::string> tables;
  bool in_block = false, has_keys = false;
  while (std::getline(in, line)) {
    if (line == "```toml") {
      in_block = true;
      page.blocks.emplace_back();
    } else if (line == "```") {
      in_block = false;
    } else if (in_block) {
      page.blocks.back() += line + "\n";
    } else if (line.rfind("# ", 0) == 0 || (line.rfind("- `[", 0) == 0 && !has_keys)) {
      if (line == "# Top level") tables.emplace_back("");
      for (const std::string& name : tables_named_in(line)) tables.push_back(name);
    } else if (line.rfind("| `", 0) == 0) {
      const std::vector<std::string> cells = cells_of(line);
      if (cells.size() != 8) continue;
      has_keys = true;
      const std::string key = cells[1].substr(1, cells[1].size() - 2);
      for (const std::string& table : tables) {
        EXPECT_TRUE(
            page.rows[table].try_emplace(key, Row{cells[3], cells[5], cells[6], cells[7]}).second)
            << file << ": " << key << " twice";
      }
    }
  }
}

// The blocks of sweep-file.md come first.
Page read_pages() {
  Page page;
  read_page(reference() / "sweep-file.md", page);
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(reference() / "keys"))
    if (entry.path().filename() != "README.md") files.insert(entry.path());
  for (const std::filesystem::path& file : files) read_page(file, page);
  return page;
}

bool is_table(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && !field.is_map();
}

// Every table that a sweep file can have, by its path.
void collect_documented(const Descriptor& message, const std::string& path,
                        std::map<std::string, const Descriptor*>& out) {
  out[path] = &message;
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    if (is_table(field))
      collect_documented(*field.message_type(),
                         path.empty() ? field.name() : path + "." + field.name(), out);
  }
}

TEST(SweepDocs, HaveEveryKeyOfTheGrammarAndNoOther) {
  std::map<std::string, const Descriptor*> tables;
  collect_documented(*schema::Sweep::descriptor(), "", tables);
  const Page page = read_pages();
  std::set<std::string> expected, documented;
  for (const auto& [path, message] : tables) {
    for (int i = 0; i < message->field_count(); ++i)
      expected.insert("[" + path + "] " + message->field(i)->name());
  }
  for (const auto& [path, rows] : page.rows) {
    for (const auto& [key, row] : rows) documented.insert("[" + path + "] " + key);
  }
  for (const std::string& key : expected)
    EXPECT_TRUE(documented.contains(key)) << key << " is not in docs/reference/keys";
  for (const std::string& key : documented)
    EXPECT_TRUE(expected.contains(key)) << key << " is not in schema/sweep.proto";
}

TEST(SweepDocs, EveryRowIsFilledAndUnitsMatchNames) {
  const std::map<std::string, std::string> unit_of_suffix = {
      {"_deg", "degree"}, {"_k", "K"}, {"_m", "m"},   {"_um", "um"},
      {"_pa", "Pa"},      {"_s", "s"}, {"_m2", "m2"}, {"_px", "pixel"}};
  for (const auto& [table, rows] : read_pages().rows) {
    for (const auto& [key, row] : rows) {
      for (const std::string& cell : {row.unit, row.fallback, row.meaning, row.example})
        EXPECT_NE(cell, "") << table << " " << key;
      const std::size_t cut = key.rfind('_');
      if (cut == std::string::npos || row.unit.find('/') != std::string::npos) continue;
      const auto unit = unit_of_suffix.find(key.substr(cut));
      if (unit == unit_of_suffix.end()) continue;
      EXPECT_EQ(row.unit, unit->second) << table << " " << key;
    }
  }
}

TEST(SweepDocs, ExamplesOfKeysAreAccepted) {
  for (const auto& [table, rows] : read_pages().rows) {
    for (const auto& [key, row] : rows) {
      ASSERT_GT(row.example.size(), 2U) << key;
      const std::string example = row.example.substr(1, row.example.size() - 2);
      if (example.front() == '[') continue;  // the header of a table that has rows of its own
      // Arrays of tables in the middle of a path are written as such.
      std::string text;
      const Descriptor* message = schema::Sweep::descriptor();
      std::string path;
      std::stringstream names(table);
      std::string name;
      while (std::getline(names, name, '.')) {
        const FieldDescriptor* field = message->FindFieldByName(name);
        ASSERT_NE(field, nullptr) << table;
        path += (path.empty() ? "" : ".") + name;
        text += field->is_repeated() ? "[[" + path + "]]\n" : "[" + path + "]\n";
        message = field->message_type();
      }
      const auto file = parse_sweep(text + example + "\n", "example");
      EXPECT_TRUE(file.ok()) << text << example << "\n" << file.status();
      EXPECT_EQ(example.rfind(key + " =", 0), 0U) << example;
    }
  }
}

TEST(SweepDocs, TheSmallestFileResolvesAndTheOtherBlocksParse) {
  const Page page = read_pages();
  ASSERT_GE(page.blocks.size(), 2U);
  const auto smallest = resolved_text(page.blocks[0]);
  EXPECT_TRUE(smallest.ok()) << smallest.status();
  for (const std::string& block : page.blocks) {
    const auto file = parse_sweep(block, "block");
    EXPECT_TRUE(file.ok()) << file.status();
  }
}

TEST(SweepDocs, NameEveryEffectThatCanBeLeftOutAndNoOther) {
  const std::string page = text_of(reference() / "keys/effects.md");
  for (std::size_t i = 0; i < kEffectCount; ++i) {
    const EffectInfo& effect = info_of(static_cast<Effect>(i));
    const auto text = [](std::string_view view) { return std::string(view); };
    const std::string line = "\n| `" + text(effect.name) + "` | " + text(effect.what) + " | " +
                             text(effect.when) + " |\n";
    EXPECT_EQ(page.find(line) != std::string::npos, effect.switchable) << line;
  }
}

std::string text_of_value(const google::protobuf::Message& message, const FieldDescriptor& field) {
  const google::protobuf::Reflection& r = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return absl::StrCat(r.GetDouble(message, &field));
    case FieldDescriptor::CPPTYPE_UINT32:
      return absl::StrCat(r.GetUInt32(message, &field));
    case FieldDescriptor::CPPTYPE_UINT64:
      return absl::StrCat(r.GetUInt64(message, &field));
    case FieldDescriptor::CPPTYPE_BOOL:
      return r.GetBool(message, &field) ? "true" : "false";
    case FieldDescriptor::CPPTYPE_STRING:
      return r.GetString(message, &field);
    default:
      return "?";
  }
}

// A default in `code type` is the value that a file without that key resolves to.
TEST(SweepDocs, DefaultsAreThoseOfTheCode) {
  const Page page = read_pages();
  std::string text =
      page.blocks.at(0) + "[place]\nlatitude_deg = 0\nlongitude_deg = 0\nheading_deg = 0\n";
  auto sweep = resolved_text(text);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  sweep->mutable_sweep()->mutable_model()->set_reference(
      "origin");  // files only: tests/unit/resolve_test.cpp
  int compared = 0;
  for (const auto& [table, rows] : page.rows) {
    const google::protobuf::Message* message = &sweep->sweep();
    std::stringstream names(table);
    std::string name;
    while (std::getline(names, name, '.')) {
      const FieldDescriptor* field = message->GetDescriptor()->FindFieldByName(name);
      ASSERT_NE(field, nullptr);
      const google::protobuf::Reflection& r = *message->GetReflection();
      if (field->is_repeated() && r.FieldSize(*message, field) == 0) {
        message = nullptr;
        break;
      }
      message = field->is_repeated() ? &r.GetRepeatedMessage(*message, field, 0)
                                     : &r.GetMessage(*message, field);
    }
    for (const auto& [key, row] : rows) {
      if (message == nullptr || row.fallback.front() != '`' || row.fallback.back() != '`') continue;
      if (row.fallback.find('`', 1) + 1 != row.fallback.size())
        continue;  // more than one in the cell
      const FieldDescriptor* field = message->GetDescriptor()->FindFieldByName(key);
      ASSERT_NE(field, nullptr) << key;
      if (field->is_repeated()) continue;
      EXPECT_EQ("`" + text_of_value(*message, *field) + "`", row.fallback) << table << " " << key;
      ++compared;
    }
  }
  EXPECT_GE(compared, 10);
}

}  // namespace
}  // namespace irsig
