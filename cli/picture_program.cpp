#include "cli/picture_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "coordinator/client/child_process.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/client/scratch_folder.h"
#include "planning/machine.h"
#include "view/atomic_file.h"

namespace irsig {

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
  if (!painter->wait(600) || !painter->succeeded())
    return absl::InternalError(fmt::format("irsig-picture: {}", painter->last_words()));
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

absl::StatusOr<std::vector<PictureFacts>> paint_pictures(
    const std::vector<PictureAsked>& pictures) {
  const auto made = ScratchFolder::make();
  if (!made.ok()) return made.status();
  const ScratchFolder& folder = **made;
  // The program takes 0.1 s to load: worth it for some dozens.
  const std::size_t pieces =
      std::max<std::size_t>(1, std::min<std::size_t>(usable_cores(), pictures.size() / 50));
  std::vector<ChildProcess> painter;
  const auto first_of = [&](std::size_t piece) { return piece * pictures.size() / pieces; };
  for (std::size_t p = 0; p < pieces; ++p) {
    const std::string asked = folder.file(fmt::format("asked{}", p));
    std::ofstream file(asked, std::ios::binary);
    for (std::size_t i = first_of(p); i < first_of(p + 1); ++i) {
      const PictureAsked& picture = pictures[i];
      const PictureAsked::Seen seen = picture.seen.value_or(PictureAsked::Seen{});
      file << fmt::format(
                  "{} {} {} {} {} {} {} {} {}\n", picture.exr.size(), picture.black_w_m2_sr,
                  picture.white_w_m2_sr, picture.seen ? 1 : 0, seen.gain,
                  seen.path_radiance_w_m2_sr, seen.background_radiance_w_m2_sr, seen.target_area_px,
                  picture.png.empty() ? "-" : std::filesystem::absolute(picture.png).string())
           << picture.exr;
    }
    file.close();
    if (!file) return absl::UnavailableError("cannot write " + asked);
    auto started = ChildProcess::start({beside_this_executable("irsig-picture"),
                                        folder.file(fmt::format("facts{}", p)), "many", asked},
                                       folder.file(fmt::format("log{}", p)), SIGKILL);
    if (!started.ok()) return started.status();
    painter.push_back(*std::move(started));
  }
  std::vector<PictureFacts> out;
  for (std::size_t p = 0; p < pieces; ++p) {
    if (!painter[p].wait(600) || !painter[p].succeeded())
      return absl::InternalError(fmt::format("irsig-picture: {}", painter[p].last_words()));
    std::ifstream file(folder.file(fmt::format("facts{}", p)));
    PictureFacts facts{};
    while (file >> facts.hottest_w_m2_sr >> facts.shown_px >> facts.left_px >> facts.top_px >>
           facts.width_px >> facts.height_px)
      out.push_back(facts);
  }
  return out;
}

}  // namespace irsig
