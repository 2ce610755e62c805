#include "cli/picture_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>

#include "coordinator/client/child_process.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/client/scratch_folder.h"
#include "planning/machine.h"
#include "view/atomic_file.h"

namespace irsig {
namespace {

constexpr std::string_view kDamaged = "damaged: ";  // worker/picture_main.cpp

}  // namespace

absl::StatusOr<std::string> paint_png(const std::string& exr, const std::string& scale,
                                      const NextExr& others) {
  const auto made = ScratchFolder::make();
  if (!made.ok()) return made.status();
  const ScratchFolder* folder = made->get();
  const std::string at = folder->path() + "/images", out = folder->path() + "/picture";
  std::error_code error;
  if (!std::filesystem::create_directory(at, error))
    return absl::UnavailableError(fmt::format("cannot make {}: {}", at, error.message()));
  if (auto status = replace_file(at + "/picture.exr", exr); !status.ok()) return status;
  for (std::size_t i = 0;; ++i) {
    const auto other = others();
    if (!other.ok()) return other.status();
    if (other->empty()) break;
    if (auto status = replace_file(fmt::format("{}/{}.exr", at, i), *other); !status.ok())
      return status;
  }
  auto painter = ChildProcess::start({beside_this_executable("irsig-picture"), out, scale, at},
                                     folder->path() + "/log", SIGKILL);
  if (!painter.ok()) return painter.status();
  if (!painter->wait(600) || !painter->succeeded()) {
    const std::string words = painter->last_words();
    if (const std::size_t why = words.find(kDamaged); why != std::string::npos)
      return absl::DataLossError(words.substr(why + kDamaged.size()));
    return absl::InternalError(fmt::format("irsig-picture: {}", words));
  }
  std::ifstream file(out, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

absl::StatusOr<StoredPixels> read_exr(const std::string& exr) {
  const auto bytes = paint_png(exr, "pixels", [] { return std::string(); });
  if (!bytes.ok()) return bytes.status();
  std::istringstream in(*bytes);
  StoredPixels out;
  in >> out.width_px >> out.height_px;
  const std::size_t count = static_cast<std::size_t>(out.width_px) * out.height_px;
  const auto begin = static_cast<std::size_t>(in.tellg()) + 1;  // behind the end of the line
  if (!in || bytes->size() != begin + count * sizeof(float))
    return absl::InternalError("irsig-picture: its pixels are not as many as it says");
  out.radiance_w_m2_sr.resize(count);
  std::memcpy(out.radiance_w_m2_sr.data(), bytes->data() + begin, count * sizeof(float));
  return out;
}

// One process, which paints what it is told as long as there is something to paint.
class PicturePainters::Painter {
 public:
  static absl::StatusOr<std::unique_ptr<Painter>> start(const std::string& path) {
    const std::string asked = path + ".asked", said = path + ".said";
    if (::mkfifo(asked.c_str(), 0600) != 0 || ::mkfifo(said.c_str(), 0600) != 0)
      return absl::UnavailableError(fmt::format("cannot make {}: {}", path, std::strerror(errno)));
    // Both ways: neither side waits for the other to open its end.
    const int to = ::open(asked.c_str(), O_RDWR | O_CLOEXEC);
    const int from = ::open(said.c_str(), O_RDWR | O_CLOEXEC);
    auto process = ChildProcess::start(
        {beside_this_executable("irsig-picture"), said, "many", asked}, path + ".log", SIGKILL);
    std::unique_ptr<Painter> out(new Painter(path, to, from));
    if (to < 0 || from < 0) return absl::UnavailableError("cannot open " + path);
    if (!process.ok()) return process.status();
    out->process_.emplace(*std::move(process));
    return out;
  }
  ~Painter() {
    ::close(to_);
    ::close(from_);
  }
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  absl::Status ask(std::span<const PictureAsked> pictures) {
    std::ofstream file(path_ + ".in", std::ios::binary);
    for (const PictureAsked& picture : pictures) {
      const PictureAsked::Seen seen = picture.seen.value_or(PictureAsked::Seen{});
      const std::string png =
          picture.png.empty() ? "-" : std::filesystem::absolute(picture.png).string();
      file << fmt::format("{} {} {} {} {} {} {} {} {}\n", picture.exr.size(), picture.black_w_m2_sr,
                          picture.white_w_m2_sr, picture.seen ? 1 : 0, seen.gain,
                          seen.path_radiance_w_m2_sr, seen.background_radiance_w_m2_sr,
                          seen.target_area_px, png)
           << picture.exr;
    }
    file.close();
    const std::string line = fmt::format("{0}.out\t{0}.in\n", path_);
    if (!file || ::write(to_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
      return absl::UnavailableError("cannot write " + path_);
    return absl::OkStatus();
  }

  absl::Status answer(std::vector<PictureFacts>& out) {
    std::string said;
    while (!said.ends_with('\n')) {
      pollfd ready{from_, POLLIN, 0};
      if (::poll(&ready, 1, 200) > 0) {
        char text[512];
        const ssize_t n = ::read(from_, text, sizeof text);
        if (n > 0) said.append(text, static_cast<std::size_t>(n));
      } else if (process_->ended()) {
        return absl::InternalError(fmt::format("irsig-picture: {}", process_->last_words()));
      }
    }
    said.pop_back();
    if (said != "ok") return absl::InternalError("irsig-picture: " + said);
    std::ifstream file(path_ + ".out");
    for (std::string line; std::getline(file, line);) {
      PictureFacts facts{};
      if (line.starts_with(kDamaged)) {
        facts.damage = line.substr(kDamaged.size());
      } else {
        std::istringstream numbers(line);
        numbers >> facts.hottest_w_m2_sr >> facts.shown_px >> facts.left_px >> facts.top_px >>
            facts.width_px >> facts.height_px;
        if (!numbers) return absl::InternalError("irsig-picture: no facts of an image: " + line);
      }
      out.push_back(std::move(facts));
    }
    return absl::OkStatus();
  }

 private:
  Painter(std::string path, int to, int from) : path_(std::move(path)), to_(to), from_(from) {}
  std::string path_;
  int to_, from_;
  std::optional<ChildProcess> process_;
};

PicturePainters::PicturePainters() = default;
PicturePainters::~PicturePainters() = default;

absl::StatusOr<std::vector<PictureFacts>> PicturePainters::paint(
    const std::vector<PictureAsked>& pictures) {
  if (!folder_) {
    auto made = ScratchFolder::make();
    if (!made.ok()) return made.status();
    folder_ = *std::move(made);
  }
  // The program takes 0.25 s of CPU time to load: worth it for some hundreds.
  const std::size_t pieces =
      std::max<std::size_t>(1, std::min<std::size_t>(usable_cores(), pictures.size() / 500));
  while (painter_.size() < pieces) {
    auto started = Painter::start(folder_->file(fmt::format("painter{}", painter_.size())));
    if (!started.ok()) return started.status();
    painter_.push_back(*std::move(started));
  }
  const std::span all(pictures);
  const auto first_of = [&](std::size_t piece) { return piece * all.size() / pieces; };
  for (std::size_t p = 0; p < pieces; ++p)
    if (auto s = painter_[p]->ask(all.subspan(first_of(p), first_of(p + 1) - first_of(p))); !s.ok())
      return s;
  std::vector<PictureFacts> out;
  for (std::size_t p = 0; p < pieces; ++p)
    if (auto s = painter_[p]->answer(out); !s.ok()) return s;
  return out;
}

}  // namespace irsig
