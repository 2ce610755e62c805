// Tests the input of `irsig plan` and `irsig run`: sweep files made from the grammar, and damaged
// files beside them, through the code of the commands. They are read, resolved, expanded and
// checked; for some of them the scene is built, and for a few a view is computed. Nothing ends the
// program, and every refusal has a place. Turns run in processes of their own, so that the file
// that ends one can be named.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>

#include "core/base/problems.h"
#include "core/plume/generate_plume.h"
#include "core/plume/vdb_subprocess.h"
#include "jobs/check_resolved.h"
#include "jobs/files/temperature_files.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_plume.h"
#include "jobs/resolve_sweep.h"
#include "planning/load_sweep.h"
#include "runner/job_runner.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/sweep_grammar.h"
#include "tests/fuzz/turns.h"
#include "tests/unit/test_folder.h"

namespace irsig {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostText = 1 << 20;
constexpr long kMostCpuS = 120;  // of one file: far more than any takes

// How far the files came.
struct Counts {
  std::uint64_t files, parsed, resolved, built, computed;
};

// Data that a turn leaves for the process that looks after it.
struct Shared {
  Counts counts;
  std::uint64_t turn;
  char what[1 << 16];    // an expectation that it broke
  char text[kMostText];  // its sweep file
  char beside[256];      // the file beside it that was damaged
};

// Empty for what is no file: a model of the name "" is the folder.
std::string bytes_of(const fs::path& path) {
  if (!fs::is_regular_file(path)) return {};
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void keep(std::string_view from, std::span<char> to) {
  const std::size_t count = std::min(from.size(), to.size() - 1);
  std::memcpy(to.data(), from.data(), count);
  to[count] = '\0';
}

// Small files of every kind that a sweep may name.
std::map<std::string, std::string> files_beside() {
  std::map<std::string, std::string> out;
  const fs::path examples = fs::path(IRSIG_SOURCE_DIR) / "jobs/examples";
  out["boxes.obj"] = bytes_of(fs::path(IRSIG_SOURCE_DIR) / "jobs/models/boxes.obj");
  for (const auto& [file, reader] :
       std::map<std::string, const char*>{{"weather.csv", "weather_csv"},
                                          {"tmy3.csv", "tmy3"},
                                          {"sounding.csv", "sounding"},
                                          {"path.csv", "path_csv"},
                                          {"spectrum.csv", "spectrum"},
                                          {"nk.yml", "optical_constants"},
                                          {"brdf.csv", "brdf"},
                                          {"field.csv", "temperature_csv"}})
    out[file] = fuzz::reader_named(reader)->sound.front();
  out["conditions.csv"] =
      "name,date,time,air_temperature_k\na,2025-06-21,12:00Z,288\nb,2025-12-21,10:30+09:00,275\n";
  UniformPlume ball;
  ball.kind = "sphere";
  ball.radius_m = 1;
  ball.temperature_k = 600;
  ball.co2 = 0.05;
  ball.voxel_m = 0.5;
  const auto made = generate_uniform_plume(ball);
  EXPECT_TRUE(made.ok()) << made.status();
  const auto vdb = made.ok() ? write_vdb_apart(made->volume) : made.status();
  EXPECT_TRUE(vdb.ok()) << vdb.status();
  out["ball.vdb"] = vdb.value_or("");
  out["empty.csv"] = "";
  return out;
}

std::vector<std::string> names_of(const std::map<std::string, std::string>& files) {
  std::vector<std::string> out;
  for (const auto& [name, bytes] : files) out.push_back(name);
  return out;
}

// Examples of the repository, their files among those beside.
std::vector<std::string> examples() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(fs::path(IRSIG_SOURCE_DIR) / "jobs/examples"))
    if (entry.path().extension() == ".toml") out.push_back(bytes_of(entry.path()));
  std::sort(out.begin(), out.end());
  return out;
}

// A sweep with tables that the examples do not have.
constexpr const char* kBox = R"(
time = ["12:00Z"]
model = { generate = "box", triangles = 12 }
[[part]]
name = "box"
material = "generic_grey_paint"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
air_temperature_k = 288
[[band]]
name = "b"
lambda_min_um = 3.3
lambda_max_um = 5
step_um = 0.1
[viewpoints]
kind = "ring"
count = 2
elevation_deg = [0]
range_m = 5000
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
)";
const std::string kSound[] = {kBox, std::string(kBox) + R"(
[plume]
kind = "file"
position_m = [0, 0, 5]
file = "ball.vdb"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
temperature = { grid = "temperature", unit = "K" }
pressure = { constant = 101325, unit = "Pa" }
co2 = { grid = "co2", unit = "1" }
h2o = 0
co = 0
soot = 0
)",
                              std::string(kBox) + R"(
[plume]
kind = "slab"
position_m = [0, 0, 5]
temperature_k = 600
voxel_m = 0.5
length_m = 3
width_m = 2
height_m = 1
co2 = 0.05
)",
                              std::string(kBox) + R"(
[effects]
mode = "only"
only = ["path_sun", "sky"]
[[profile]]
name = "across"
from_m = [0, -1, 0]
to_m = [0, 1, 0]
points = 3
reflections = [0, 1]
samples = 100
)"};

// Whose every problem has a place.
std::string wrong_refusal(const absl::Status& status) {
  if (!absl::IsInvalidArgument(status)) return "refused with " + status.ToString();
  const std::vector<Problem> problems = problems_of(status);
  if (problems.front().place.empty()) return "a refusal without a place: " + status.ToString();
  for (const Problem& problem : problems)
    if (problem.text.empty() || problem.text.find('\n') != std::string::npos)
      return "a refusal that is no line: " + status.ToString();
  return "";
}

// Few enough that its scene is built in a moment.
bool is_small(const schema::ResolvedSweep& sweep) {
  double wavelengths = 0;
  for (const schema::Band& b : sweep.sweep().band())
    wavelengths += (b.lambda_max_um() - b.lambda_min_um()) / b.step_um();
  const schema::Plume& plume = sweep.sweep().plume();
  const double voxels = plume.kind() == "funnel"
                            ? plume.length_m() / plume.voxel_m()
                            : std::max({plume.length_m(), plume.radius_m(), plume.width_m()}) /
                                  std::max(1e-9, plume.voxel_m());
  return sweep.viewpoint_size() <= 200 && sweep.condition_size() <= 8 && wavelengths <= 300 &&
         sweep.sweep().model().triangles() <= 2000 &&
         (!sweep.sweep().has_plume() || plume.kind() == "file" || voxels <= 60) &&
         (!sweep.sweep().has_heat() || !sweep.sweep().heat().has_element_size_m() ||
          sweep.sweep().heat().element_size_m() > 0.5);
}

// Does the work of load_sweep, with steps between which the files are counted. Returns what is
// wrong.
std::string read_as_plan_does(const std::string& path, bool build, bool compute, Counts& counts) {
  ++counts.files;
  auto file = load_sweep_file(path);
  if (!file.ok()) return wrong_refusal(file.status());
  ++counts.parsed;
  std::string model;
  if (const schema::Model& of = file->sweep.model(); of.has_file())
    model = bytes_of(fs::path(path).parent_path() / of.file());
  std::vector<Problem> warnings;
  const auto sweep = resolve_sweep(*file, model, &warnings);
  if (!sweep.ok()) return wrong_refusal(sweep.status());
  ++counts.resolved;
  for (const Problem& warning : warnings)
    if (warning.key.empty()) return "a warning without a key: " + warning.text;
  if (const absl::Status status = check_resolved(*sweep); !status.ok())
    return "what a file says may not be submitted: " + status.ToString();
  if (sweep->viewpoint_size() > 2000) return "";
  const std::vector<schema::JobSpec> jobs = expand_jobs(*sweep, 1);
  if (jobs.empty()) return "a sweep without jobs";
  if (!build || !is_small(*sweep)) return "";
  auto loaded = load_sweep(path, {});
  if (!loaded.ok()) return wrong_refusal(loaded.status());
  ++counts.built;
  if (!compute || loaded->size.rows() > 3000) return "";
  schema::ResolvedSweep little = loaded->resolved;
  schema::Accuracy& accuracy = *little.mutable_sweep()->mutable_accuracy();
  accuracy.clear_relative_error();
  accuracy.clear_target_paths();
  accuracy.clear_time_budget_s();
  accuracy.set_samples_per_replicate(1);
  little.mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  if (little.heat_size() > 0) return "";
  const auto runner = JobRunner::create(little, loaded->assets, {});
  if (!runner.ok()) return "it was built before: " + runner.status().ToString();
  (void)(*runner)->run(expand_jobs(little, 1).front());
  ++counts.computed;
  return "";
}

// Turns from `begin` to `end` in this process.
void turns(fuzz::SweepGrammar& grammar, const std::map<std::string, std::string>& files,
           std::uint64_t begin, std::uint64_t end, Shared& shared) {
  static constexpr const char* kWords[] = {"nan", "1e999", ",", "-", "\n", "#", "\"", "0", "x:"};
  const TestFolder folder;
  for (const auto& [name, bytes] : files)
    std::ofstream(folder.file(name), std::ios::binary) << bytes;
  const std::string path = folder.file("sweep.toml");
  for (std::uint64_t turn = begin; turn < end; ++turn) {
    shared.turn = turn;
    const std::string text = grammar.make(turn);
    keep(text, shared.text);
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
    const auto damaged = std::next(files.begin(), static_cast<std::ptrdiff_t>(turn % files.size()));
    const bool damage = turn % 5 == 4;
    keep(damage ? damaged->first : "", shared.beside);
    if (damage)
      std::ofstream(folder.file(damaged->first), std::ios::binary | std::ios::trunc)
          << fuzz::Mutator(turn, kWords).mutate(damaged->second);
    const itimerval limit = {{0, 0}, {kMostCpuS, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    std::string wrong;
    try {
      wrong = read_as_plan_does(path, turn % 8 == 0, turn % 64 == 0, shared.counts);
    } catch (const std::exception& error) {
      wrong = std::string("an exception: ") + error.what();
    }
    if (!wrong.empty()) {
      keep(wrong, shared.what);
      return;
    }
    if (damage)
      std::ofstream(folder.file(damaged->first), std::ios::binary | std::ios::trunc)
          << damaged->second;
  }
}

std::string report(const Shared& shared, int status) {
  std::string out = "turn " + std::to_string(shared.turn) + ": ";
  if (WIFSIGNALED(status)) out += "signal " + std::to_string(WTERMSIG(status));
  out += std::string(shared.what) + "\n";
  if (shared.beside[0] != '\0') out += std::string("beside it a damaged ") + shared.beside + "\n";
  return out + shared.text;
}

TEST(SweepGrammarFuzz, NoFileEndsTheProgramAndEveryRefusalHasAPlace) {
  const auto files = files_beside();
  std::vector<std::string> sound = examples();
  sound.insert(sound.end(), std::begin(kSound), std::end(kSound));
  fuzz::SweepGrammar grammar(sound, fuzz::reader_named("sweep")->sound, names_of(files));
  auto* shared = static_cast<Shared*>(
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(shared, MAP_FAILED);
  const char* first = std::getenv("IRSIG_FUZZ_FROM");  // a turn, to make it again
  const std::uint64_t from = first != nullptr ? std::strtoull(first, nullptr, 10) : 0;
  constexpr std::uint64_t kInAProcess = 200;
  int found = 0;
  for (fuzz::Turns turn(4); turn.next() && found < 20;) {
    std::uint64_t begin = from + kInAProcess * static_cast<std::uint64_t>(turn.index());
    const std::uint64_t end = begin + kInAProcess;
    while (begin < end && found < 20) {
      shared->what[0] = '\0';
      const pid_t pid = fork();
      ASSERT_GE(pid, 0);
      if (pid == 0) {
        const rlimit none{};
        setrlimit(RLIMIT_CORE, &none);
        turns(grammar, files, begin, end, *shared);
        _exit(shared->what[0] == '\0' ? 0 : 1);
      }
      int status = 0;
      ASSERT_EQ(waitpid(pid, &status, 0), pid);
      if (status == 0) break;
      ADD_FAILURE() << report(*shared, status);
      ++found;
      begin = shared->turn + 1;
    }
  }
  const Counts& c = shared->counts;
  std::printf("%llu files: %llu parsed, %llu resolved, %llu built, %llu computed\n",
              static_cast<unsigned long long>(c.files), static_cast<unsigned long long>(c.parsed),
              static_cast<unsigned long long>(c.resolved), static_cast<unsigned long long>(c.built),
              static_cast<unsigned long long>(c.computed));
  // Files that are all refused at the first line would test nothing.
  EXPECT_GT(c.parsed, c.files / 3);
  EXPECT_GT(c.resolved, c.files / 50);
  EXPECT_GT(c.built, 0U);
}

}  // namespace
}  // namespace irsig
