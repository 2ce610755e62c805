#include "cli/picture_program.h"

#include <fmt/format.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "coordinator/client/child_process.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/client/scratch_folder.h"
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

}  // namespace irsig
