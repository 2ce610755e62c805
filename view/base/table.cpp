#include "view/base/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/formula.h"
#include "core/base/printable.h"
#include "view/base/quantity.h"

namespace irsig {
namespace {

absl::Status stream_status(std::ostream& out) {
  out.flush();
  if (!out) return absl::UnavailableError("cannot write the output (disk full or closed pipe?)");
  return absl::OkStatus();
}

class CsvWriter : public TableWriter {
 public:
  CsvWriter(const std::vector<Column>& columns, std::ostream& out) : out_(out) {
    for (std::size_t i = 0; i < columns.size(); ++i) out_ << (i ? "," : "") << text(columns[i].name);
    out_ << "\n";
  }
  void row(const std::vector<Cell>& cells) override {
    for (std::size_t i = 0; i < cells.size(); ++i) out_ << (i ? "," : "") << text(cells[i]);
    out_ << "\n";
  }
  absl::Status finish() override { return stream_status(out_); }

 private:
  static std::string text(const std::string& s) {
    const std::string plain = (is_formula(s) ? "'" : "") + s;
    if (plain.find_first_of(",\"\r\n") == std::string::npos) return plain;
    std::string quoted = "\"";
    for (char c : plain) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
  }
  static std::string text(const Cell& cell) {
    if (const auto* s = std::get_if<std::string>(&cell)) return text(*s);
    if (const auto* d = std::get_if<double>(&cell)) return fmt::format("{}", *d);
    if (const auto* u = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *u);
    if (const auto* b = std::get_if<bool>(&cell)) return *b ? "true" : "false";
    return "";
  }
  std::ostream& out_;
};

class JsonWriter : public TableWriter {
 public:
  JsonWriter(const std::vector<Column>& columns, std::ostream& out) : columns_(columns), out_(out) {
    out_ << "[";
  }
  void row(const std::vector<Cell>& cells) override {
    out_ << (first_ ? "\n {" : ",\n {");
    first_ = false;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      out_ << (i ? ", " : "") << json_string(columns_[i].name) << ": " << text(cells[i]);
    }
    out_ << "}";
  }
  absl::Status finish() override {
    out_ << (first_ ? "]\n" : "\n]\n");
    return stream_status(out_);
  }

 private:
  static std::string text(const Cell& cell) {
    if (const auto* s = std::get_if<std::string>(&cell)) return json_string(*s);
    if (const auto* d = std::get_if<double>(&cell)) {
      return std::isfinite(*d) ? fmt::format("{}", *d) : "null";
    }
    if (const auto* u = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *u);
    if (const auto* b = std::get_if<bool>(&cell)) return *b ? "true" : "false";
    return "null";
  }
  std::vector<Column> columns_;
  std::ostream& out_;
  bool first_ = true;
};

// Columns as wide as their widest cell; three header lines: the noun in two lines, the unit.
class TextWriter : public TableWriter {
 public:
  TextWriter(const std::vector<Column>& columns, std::ostream& out)
      : columns_(columns), out_(out) {}
  void row(const std::vector<Cell>& cells) override {
    std::vector<Line> line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (columns_[i].brief) {
        line.push_back(
            {text(cells[i], columns_[i].name), std::holds_alternative<std::string>(cells[i])});
      }
    }
    rows_.push_back(std::move(line));
  }
  absl::Status finish() override {
    std::vector<std::vector<Line>> lines(3);
    for (const Column& c : columns_) {
      if (!c.brief) continue;
      const Quantity q = quantity_of(c.name);
      const std::size_t cut = split_at(q.noun);
      const bool two = cut < q.noun.size();
      lines[0].push_back({two ? q.noun.substr(0, cut) : "", false});
      lines[1].push_back({two ? q.noun.substr(cut + 1) : q.noun, false});
      lines[2].push_back({q.unit.empty() ? "" : "[" + q.unit + "]", false});
    }
    const std::size_t n = lines[0].size();
    for (std::size_t i = 0; i < n; ++i) {
      const bool left = !rows_.empty() && rows_[0][i].left;
      for (auto& line : lines) line[i].left = left;
    }
    lines.insert(lines.end(), rows_.begin(), rows_.end());
    std::vector<std::size_t> width(n, 0);
    for (const auto& line : lines) {
      for (std::size_t i = 0; i < n; ++i) width[i] = std::max(width[i], line[i].text.size());
    }
    for (std::size_t r = 0; r < lines.size(); ++r) {
      std::string printed;
      for (std::size_t i = 0; i < n; ++i) {
        const Line& cell = lines[r][i];
        printed += cell.left ? fmt::format("{:<{}}", cell.text, width[i])
                             : fmt::format("{:>{}}", cell.text, width[i]);
        if (i + 1 < n) printed += "  ";
      }
      printed.erase(printed.find_last_not_of(' ') + 1);
      if (!printed.empty()) out_ << printed << "\n";
      if (r == 2) {
        std::size_t total = 2 * (n - 1);
        for (std::size_t w : width) total += w;
        out_ << std::string(total, '-') << "\n";
      }
    }
    return stream_status(out_);
  }

 private:
  struct Line {
    std::string text;
    bool left;
  };
  // The space nearest to the middle of a long noun.
  static std::size_t split_at(const std::string& noun) {
    std::size_t best = noun.size();
    if (noun.size() < 9) return best;
    for (std::size_t i = 0; i < noun.size(); ++i) {
      const auto off = [&](std::size_t at) {
        return std::abs(2 * static_cast<long>(at) - static_cast<long>(noun.size()));
      };
      if (noun[i] == ' ' && off(i) < off(best)) best = i;
    }
    return best;
  }
  static std::string text(const Cell& cell, const std::string& name) {
    if (const auto* s = std::get_if<std::string>(&cell)) return one_line(*s);
    if (const auto* d = std::get_if<double>(&cell)) {
      if (name.ends_with("_deg")) return fmt::format("{:.2f}", *d);
      const bool error =
          name.find("stderr") != std::string::npos || name.find("error") != std::string::npos;
      if (!error) return fmt::format("{:.6g}", *d);
      // Two digits; 110 rather than 1.1e+02.
      const double size = std::abs(*d);
      return size >= 100 && size < 1e6 ? fmt::format("{:.0f}", *d) : fmt::format("{:.2g}", *d);
    }
    if (const auto* u = std::get_if<std::uint64_t>(&cell)) return fmt::format("{}", *u);
    if (const auto* b = std::get_if<bool>(&cell)) return *b ? "yes" : "no";
    return "-";
  }
  std::vector<Column> columns_;
  std::ostream& out_;
  std::vector<std::vector<Line>> rows_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<TableWriter>> make_table_writer(std::string_view format,
                                                               const std::vector<Column>& columns,
                                                               std::ostream& out) {
  if (format == "csv") return std::make_unique<CsvWriter>(columns, out);
  if (format == "json") return std::make_unique<JsonWriter>(columns, out);
  if (format == "text") return std::make_unique<TextWriter>(columns, out);
  return absl::InvalidArgumentError(
      fmt::format("unknown format \"{}\": expected text, csv or json", format));
}

}  // namespace irsig
