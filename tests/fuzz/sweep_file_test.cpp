// The sweep parser against damaged files: deterministic mutations of every example and bad sweep, a
// bounded number of them. Whatever comes in, the answer is a sweep or INVALID_ARGUMENT whose lines
// each begin with file:line:column; and a sweep that resolves has finite numbers and jobs with
// keys.
#include "jobs/sweep_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

#include "jobs/check_resolved.h"
#include "jobs/expand.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

std::vector<std::string> corpus() {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : {"jobs/examples", "tests/unit/bad_sweeps"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             std::filesystem::path(IRSIG_SOURCE_DIR) / folder)) {
      if (entry.path().extension() == ".toml" &&
          entry.path().parent_path().filename() != "detectors")
        paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> texts;
  for (const auto& path : paths) {
    std::ifstream in(path, std::ios::binary);
    texts.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return texts;
}

constexpr std::size_t kExamples = 9;  // the first of the corpus

using Random = std::mt19937;  // the standard fixes its sequence: the same mutations everywhere

std::size_t below(Random& random, std::size_t bound) { return bound == 0 ? 0 : random() % bound; }

std::string mutated(const std::vector<std::string>& texts, Random& random) {
  static const std::vector<std::string> values = {"nan",
                                                  "-inf",
                                                  "1e999",
                                                  "-0",
                                                  "0",
                                                  "1",
                                                  "0.5",
                                                  "42",
                                                  "300",
                                                  "-1",
                                                  "99999999999999999999",
                                                  "1e308",
                                                  "4294967295",
                                                  "true",
                                                  "[]",
                                                  "{}",
                                                  "\"\"",
                                                  "\"\\u0000\"",
                                                  "2025-12-21",
                                                  "2025-13-41",
                                                  "24:00:00"};
  static const std::vector<std::string> tokens = {"[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  "[[",
                                                  "]]",
                                                  "=",
                                                  ".",
                                                  "\n",
                                                  "#",
                                                  "\"\"\"",
                                                  "'",
                                                  "\xff",
                                                  "\xef\xbb\xbf",
                                                  "[[part]]\n",
                                                  "a.b.c.d = 1\n",
                                                  "[model]\n",
                                                  "part = 3\n",
                                                  "time = []\n",
                                                  "[season.surroundings]\n",
                                                  "[viewpoints]\n"};
  // Every other mutation starts from an example, which is right before it is damaged.
  std::string text = texts[below(random, random() % 2 == 0 ? kExamples : texts.size())];
  const std::size_t edits = 1 + below(random, 4);
  for (std::size_t e = 0; e < edits; ++e) {
    const std::size_t at = below(random, text.size() + 1), length = below(random, 40);
    switch (random() % 12) {  // half of the edits keep the syntax and change a value
      case 0:                 // one byte
        if (at < text.size()) text[at] = static_cast<char>(random() % 256);
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, tokens[below(random, tokens.size())]);
        break;
      case 3:  // a piece twice
        text.insert(at, text.substr(below(random, text.size()), length));
        break;
      case 4:
        text.resize(at);
        break;
      case 5: {  // a piece of another file
        const std::string& other = texts[below(random, texts.size())];
        text.insert(at, other.substr(below(random, other.size()), 10 * length));
        break;
      }
      default: {  // a value becomes another
        const std::size_t equals = text.find("= ", at);
        if (equals == std::string::npos) break;
        const std::size_t end = std::min(text.find('\n', equals), text.size());
        text.replace(equals + 2, end - equals - 2, values[below(random, values.size())]);
      }
    }
  }
  return text;
}

void expect_located(const absl::Status& status, const std::string& text) {
  ASSERT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
  std::stringstream lines{std::string(status.message())};
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    int line_number = 0, column = 0, head = 0;
    std::sscanf(line.c_str(), "fuzz.toml:%d:%d: %n", &line_number, &column, &head);
    ASSERT_GT(line_number, 0) << line << "\n" << text;
    ASSERT_GT(column, 0) << line << "\n" << text;
    ASSERT_GT(line.size(), static_cast<std::size_t>(head)) << line << "\n" << text;
  }
  ASSERT_GT(count, 0) << text;
}

TEST(SweepFileFuzz, EveryMutationIsReadOrRefusedWithAPlace) {
  const std::vector<std::string> texts = corpus();
  ASSERT_GT(texts.size(), 40U);
  Random random(20251221);
  int read = 0, resolved = 0;
  for (fuzz::Turns turn(20000); turn.next();) {
    const std::string text = mutated(texts, random);
    const absl::StatusOr<SweepFile> file = parse_sweep(text, "fuzz.toml");
    if (!file.ok()) {
      ASSERT_NO_FATAL_FAILURE(expect_located(file.status(), text));
      continue;
    }
    ++read;
    const absl::StatusOr<schema::ResolvedSweep> sweep = resolve_sweep(*file, "v");
    if (!sweep.ok()) {
      ASSERT_NO_FATAL_FAILURE(expect_located(sweep.status(), text));
      continue;
    }
    ++resolved;
    // What a file may say may be submitted.
    ASSERT_TRUE(check_resolved(*sweep).ok()) << check_resolved(*sweep) << text;
    ASSERT_GT(sweep->viewpoint_size(), 0) << text;
    ASSERT_GT(sweep->condition_size(), 0) << text;
    for (const schema::Condition& condition : sweep->condition()) {
      ASSERT_EQ(condition.part_temperature_k_size(), sweep->sweep().part_size()) << text;
      for (const double t : condition.part_temperature_k()) ASSERT_TRUE(std::isfinite(t)) << text;
    }
    if (sweep->viewpoint_size() < 300) {
      const std::vector<schema::JobSpec> jobs = expand_jobs(*sweep, 1);
      ASSERT_GE(jobs.size(), static_cast<std::size_t>(sweep->viewpoint_size())) << text;
    }
  }
  // Mutations that are all refused at the first byte would test nothing.
  EXPECT_GT(read, 1000);
  EXPECT_GT(resolved, 200);
}

TEST(SweepFileFuzz, DeepAndLongFilesEnd) {
  const auto repeated = [](int count, const std::string& piece) {
    std::string text;
    for (int i = 0; i < count; ++i) text += piece;
    return text;
  };
  // The parser alone overflows the stack on these keys.
  for (const std::string& text :
       {repeated(100000, "a.") + "a = 1", repeated(100000, "a . ") + "a = 1",
        "[" + repeated(100000, "a.") + "a]", "[[" + repeated(100000, "\"a\".") + "a]]",
        "x = {" + repeated(100000, "a.") + "a = 1}", "x = " + repeated(100000, "{ a = "),
        "x = " + repeated(100000, "[") + repeated(100000, "]"),
        "x = \"\"\"\"\"\"\n" + repeated(100000, "'a'.") + "a = 1",
        "x = '''a'''''\n" + repeated(100000, "a.") + "a = 1"}) {
    const absl::StatusOr<SweepFile> file = parse_sweep(text, "fuzz.toml");
    ASSERT_FALSE(file.ok());
    expect_located(file.status(), text.substr(0, 100));
  }
  for (const std::string& piece : {std::string("["), std::string("{a="), std::string("a."),
                                   std::string("[[a]]\n"), std::string("\"")}) {
    std::string text = "name = ";
    for (int i = 0; i < 20000; ++i) text += piece;
    const absl::StatusOr<SweepFile> file = parse_sweep(text, "fuzz.toml");
    ASSERT_FALSE(file.ok());
    expect_located(file.status(), piece);
  }
}

}  // namespace
}  // namespace irsig
