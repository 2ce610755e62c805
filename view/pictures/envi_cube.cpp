#include "view/pictures/envi_cube.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <string_view>

#include "view/base/atomic_file.h"
#include "view/base/envi_text.h"

namespace irsig {
namespace {

static_assert(std::endian::native == std::endian::little, "the header states byte order 0");

bool write_at(int file, std::string_view bytes, std::size_t place) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
    place += static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace

absl::Status write_envi_band(const std::string& path, std::size_t band,
                             const RadianceImage& image) {
  const std::string_view bytes(reinterpret_cast<const char*>(image.radiance_w_m2_sr.data()),
                               sizeof(float) * image.radiance_w_m2_sr.size());
  errno = 0;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) return write_failure(path);
  const bool written = write_at(file, bytes, band * bytes.size());
  const absl::Status failure = written ? absl::OkStatus() : write_failure(path);
  return ::close(file) == 0 || !written ? failure : write_failure(path);
}

std::string envi_header(const EnviCube& cube) {
  std::vector<std::string> names;
  std::vector<double> middle_um, width_um;
  for (const EnviBand& band : cube.band) {
    names.push_back(envi_text(band.name));
    middle_um.push_back((band.lambda_min_um + band.lambda_max_um) / 2);
    width_um.push_back(band.lambda_max_um - band.lambda_min_um);
  }
  return fmt::format(
      "ENVI\ndescription = {{{}}}\nsamples = {}\nlines = {}\nbands = {}\nheader offset = 0\n"
      "file type = ENVI Standard\ndata type = 4\ninterleave = bsq\nbyte order = 0\n"
      "data units = W/(m2 sr)\nband names = {{{}}}\nwavelength units = Micrometers\n"
      "wavelength = {{{}}}\nfwhm = {{{}}}\n",
      envi_text(cube.description), cube.width_px, cube.height_px, cube.band.size(),
      fmt::join(names, ", "), fmt::join(middle_um, ", "), fmt::join(width_um, ", "));
}

}  // namespace irsig
