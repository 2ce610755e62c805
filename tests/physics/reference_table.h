#pragma once

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace irsig {

// A CSV file of tests/physics/values: lines that begin with # name its source, then a header, then
// rows.
class ReferenceTable {
 public:
  explicit ReferenceTable(const std::string& name) {
    std::ifstream file(std::string(IRSIG_TEST_VALUES) + "/" + name);
    if (!file) throw std::runtime_error("cannot read " + name);
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line.front() == '#') continue;
      if (header_.empty()) {
        header_ = fields(line);
      } else {
        rows_.push_back(fields(line));
        if (rows_.back().size() != header_.size()) {
          throw std::runtime_error(name + ": row with a wrong number of fields: " + line);
        }
      }
    }
  }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }

  [[nodiscard]] const std::string& text(std::size_t row, const std::string& column) const {
    for (std::size_t i = 0; i < header_.size(); ++i) {
      if (header_[i] == column) return rows_.at(row)[i];
    }
    throw std::runtime_error("no column " + column);
  }

  // 0 for what is below the range of double, as strtod rounds it.
  [[nodiscard]] double number(std::size_t row, const std::string& column) const {
    const std::string& field = text(row, column);
    char* end = nullptr;
    const double value = std::strtod(field.c_str(), &end);
    if (end == field.c_str() || *end != '\0') throw std::runtime_error("no number: " + field);
    return value;
  }

 private:
  // Commas inside double quotes do not separate.
  static std::vector<std::string> fields(const std::string& line) {
    std::vector<std::string> out(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        out.emplace_back();
      } else {
        out.back() += c;
      }
    }
    return out;
  }

  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace irsig
