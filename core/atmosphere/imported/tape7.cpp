#include <algorithm>
#include <optional>

#include "absl/strings/str_format.h"
#include "core/atmosphere/imported/imported_samples.h"
#include "core/atmosphere/imported/tape7_cards.h"

// tape7 is written in fixed columns: the input's cards as they were read, a line or two of labels,
// and a table whose columns may be blank where a run has nothing to say. Values stand under the
// right end of their label.                                                      [kneizys1988, ch.
// 3]
namespace irsig {
namespace {

struct Label {
  std::string_view name;
  std::size_t end;  // of its last character, from 1
};

// Labels of two words; the versions join them by a blank or by an underscore.
constexpr std::string_view kTwoWords[] = {
    "TOT TRANS", "PTH THRML", "THRML SCT", "SURF EMIS", "SOL SCAT",    "SING SCAT", "GRND RFLT",
    "DRCT RFLT", "TOTAL RAD", "REF SOL",   "SOL TR",    "WAVLEN MCRN", "WAVLEN NM"};

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::vector<Label> labels_of(std::string_view line) {
  std::vector<Label> labels;
  for (std::size_t i = 0; i < line.size();) {
    if (is_blank(line[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    for (const std::string_view two : kTwoWords) {
      if (line.size() < i + two.size()) continue;
      bool same = true;
      for (std::size_t k = 0; k < two.size() && same; ++k) {
        same = line[i + k] == two[k] || (two[k] == ' ' && line[i + k] == '_');
      }
      if (same) end = i + two.size();
    }
    if (end == i) {
      while (end < line.size() && !is_blank(line[end])) ++end;
    }
    labels.push_back({line.substr(i, end - i), end});
    i = end;
  }
  return labels;
}

bool named(std::string_view label, std::string_view two_words) {
  return label.size() == two_words.size() &&
         std::equal(label.begin(), label.end(), two_words.begin(),
                    [](char a, char b) { return a == b || (a == '_' && b == ' '); });
}

enum class Axis { kWavenumber, kMicrometre, kNanometre };

// Where the quantities stand: an index of the labels, or nothing.
struct Columns {
  std::vector<Label> label;
  Axis axis = Axis::kWavenumber;
  std::optional<std::size_t> transmittance, thermal, solar, sun;
};

class Tape7Reader {
 public:
  Tape7Reader(std::string_view text, FileErrors& errors)
      : lines_(split_lines(text)), errors_(errors) {}

  std::vector<SampledRun> read() {
    while (at_ < lines_.size() && !errors_.full()) {
      if (trimmed(lines_[at_]).empty() || ends_run(lines_[at_])) {
        ++at_;
        continue;
      }
      if (!read_run()) break;
    }
    if (runs_.empty() && !errors_.any()) errors_.add(1, 1, "no run in the file");
    return std::move(runs_);
  }

 private:
  // -9999. closes a table.
  static bool ends_run(std::string_view line) {
    const std::string_view text = trimmed(line);
    return text.starts_with("-9999") || text.starts_with("-999.");
  }

  static bool is_header(std::string_view line) {
    const std::string_view text = trimmed(line);
    return text.starts_with("FREQ") || text.starts_with("WAVE") || text.starts_with("WAVL");
  }

  // False if there is nothing left to be understood.
  bool read_run() {
    const std::size_t first = at_;
    while (at_ < lines_.size() && !is_header(lines_[at_])) ++at_;
    if (at_ == lines_.size()) {
      errors_.add(first + 1, 1,
                  "no table follows: expected a line of labels that begins with FREQ or WAVLEN");
      return false;
    }
    const std::vector<std::string_view> echoed(lines_.begin() + static_cast<std::ptrdiff_t>(first),
                                               lines_.begin() + static_cast<std::ptrdiff_t>(at_));
    const std::optional<Tape7Cards> cards = read_tape7_cards(echoed, first + 1, errors_);
    const std::size_t header = at_++;
    const std::optional<Columns> columns =
        columns_of(lines_[header], header, cards.has_value() ? cards->axis_flag : ' ');
    // A second line of labels: the units of transmittances.
    if (at_ < lines_.size() && (lines_[at_].find("CM-1") != std::string_view::npos ||
                                lines_[at_].find("TRANS") != std::string_view::npos)) {
      ++at_;
    }
    SampledRun run;
    if (cards.has_value()) run.path = cards->path;
    for (; at_ < lines_.size() && !ends_run(lines_[at_]); ++at_) {
      if (trimmed(lines_[at_]).empty()) continue;
      if (columns.has_value() && !errors_.full()) read_row(*columns, run);
    }
    if (!cards.has_value() || !columns.has_value()) return true;
    if (run.wavenumber_cm1.size() < 2 && !errors_.any()) {
      errors_.add(header + 1, 1, "expected at least two lines in the table");
    }
    runs_.push_back(std::move(run));
    return true;
  }

  std::optional<Columns> columns_of(std::string_view line, std::size_t index, char axis_flag) {
    Columns out;
    out.label = labels_of(line);
    const std::string_view axis = out.label.front().name;
    if (axis.starts_with("WAV")) {
      const bool nanometres = axis.find("NM") != std::string_view::npos || axis_flag == 'N';
      if (!nanometres && axis.find("MCR") == std::string_view::npos && axis_flag != 'M') {
        errors_.add(index + 1, out.label.front().end,
                    "the unit of the wavelengths is not stated: expected WAVLEN MCRN or WAVLEN NM");
        return std::nullopt;
      }
      out.axis = nanometres ? Axis::kNanometre : Axis::kMicrometre;
    }
    for (std::size_t i = 1; i < out.label.size(); ++i) {
      const std::string_view name = out.label[i].name;
      if (!out.transmittance && (named(name, "TOT TRANS") || name == "TRANS" || name == "COMBIN" ||
                                 name == "TOTAL" || name == "TRAN")) {
        out.transmittance = i;
      }
      if (named(name, "PTH THRML")) out.thermal = i;  // what is scattered thermally included
      if (named(name, "SOL SCAT")) out.solar = i;     // SING SCAT is part of it
      if (named(name, "SOL TR")) out.sun = i;
    }
    if (!out.transmittance) {
      errors_.add(index + 1, 1,
                  "no column of transmittance: expected TOT TRANS, TRANS, COMBIN or TOTAL");
      return std::nullopt;
    }
    return out;
  }

  struct Token {
    std::string_view text;
    std::size_t end;  // column of its last character, from 1
  };

  void read_row(const Columns& columns, SampledRun& run) {
    const std::string_view line = lines_[at_];
    std::vector<Token> tokens;
    for (std::size_t i = 0; i < line.size();) {
      std::size_t end = i;
      while (end < line.size() && !is_blank(line[end])) ++end;
      if (end > i) tokens.push_back({line.substr(i, end - i), end});
      i = end + 1;
    }
    std::vector<const Token*> of_label(columns.label.size(), nullptr);
    if (tokens.size() == columns.label.size()) {
      for (std::size_t i = 0; i < tokens.size(); ++i) of_label[i] = &tokens[i];
    } else {  // some are blank: by the right ends
      for (const Token& token : tokens) {
        std::size_t nearest = 0, least = line.size() + 1000;
        for (std::size_t i = 0; i < columns.label.size(); ++i) {
          const std::size_t a = columns.label[i].end, b = token.end, off = a > b ? a - b : b - a;
          if (off < least) {
            least = off;
            nearest = i;
          }
        }
        if (least > 3 || of_label[nearest] != nullptr) {
          error(token, absl::StrFormat("\"%s\" stands under no label of its own", token.text));
          return;
        }
        of_label[nearest] = &token;
      }
    }
    add_sample(columns, of_label, run);
  }

  void error(const Token& token, std::string_view what) {
    errors_.add(at_ + 1, token.end - token.text.size() + 1, what);
  }

  // nullopt: an error has been added. A blank column is 0: the run has none of it.
  std::optional<double> value(const Token* token) {
    if (token == nullptr) return 0;
    double x = 0;
    if (!parse_fortran_number(token->text, x)) {
      error(*token, absl::StrFormat("\"%s\" is not a number", token->text));
      return std::nullopt;
    }
    return x;
  }

  void add_sample(const Columns& columns, const std::vector<const Token*>& of_label,
                  SampledRun& run) {
    const Token* transmittance_token = of_label[*columns.transmittance];
    if (of_label[0] == nullptr || transmittance_token == nullptr) {
      errors_.add(at_ + 1, 1, "no wavenumber or no transmittance in this line");
      return;
    }
    const std::optional<double> axis = value(of_label[0]),
                                transmittance = value(transmittance_token);
    if (!axis) return;
    const double wavenumber_cm1 = columns.axis == Axis::kWavenumber   ? *axis
                                  : columns.axis == Axis::kMicrometre ? 1e4 / *axis
                                                                      : 1e7 / *axis;
    const std::string wrong = extend_axis(run.wavenumber_cm1, wavenumber_cm1);
    if (!wrong.empty()) return error(*of_label[0], wrong);
    if (!transmittance) return;
    if (!(*transmittance >= 0 && *transmittance <= 1.0001)) {
      return error(*transmittance_token,
                   absl::StrFormat("transmittance %g: expected 0 to 1", *transmittance));
    }
    // W cm-2 / cm-1: x 1e4 cm2/m2 x nu^2 / 1e4 cm-1/um. W cm-2 / um: x 1e4. uW cm-2 / nm: x 10.
    const double unit = columns.axis == Axis::kWavenumber   ? wavenumber_cm1 * wavenumber_cm1
                        : columns.axis == Axis::kMicrometre ? 1e4
                                                            : 10;
    double radiance = 0, sun = 0;
    for (const auto& [column, sum] :
         {std::pair{columns.thermal, &radiance}, std::pair{columns.solar, &radiance},
          std::pair{columns.sun, &sun}}) {
      if (!column) continue;
      const std::optional<double> x = value(of_label[*column]);
      if (!x) return;
      if (!(*x >= 0)) return error(*of_label[*column], "expected 0 or more");
      *sum += unit * *x;
    }
    run.transmittance.push_back(std::min(*transmittance, 1.0));
    if (columns.thermal) run.radiance_w_m2_sr_um.push_back(radiance);
    if (columns.sun) run.sun_w_m2_um.push_back(sun);
  }

  std::vector<std::string_view> lines_;
  FileErrors& errors_;
  std::size_t at_ = 0;  // index of the line to be read
  std::vector<SampledRun> runs_;
};

}  // namespace

std::vector<SampledRun> read_tape7(std::string_view text, FileErrors& errors) {
  return Tape7Reader(text, errors).read();
}

}  // namespace irsig
