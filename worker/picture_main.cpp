// irsig-picture: an image of radiances (EXR) as PNG, on a scale that other images share, or its
// pixels.
//
//   irsig-picture OUT.png SCALE FOLDER
//   irsig-picture OUT pixels FOLDER
//
// FOLDER/picture.exr is painted. SCALE: "common", from 0 to the hottest pixel of all the folder's
// images, or BLACK,WHITE in W/(m2 sr). "pixels": a line "WIDTH HEIGHT", then float32 of this
// machine, row by row from the top left. A program of its own, because OpenImageIO is slow to load.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "core/image/image.h"

namespace {

namespace fs = std::filesystem;

absl::StatusOr<irsig::RadianceImage> read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return irsig::decode_exr(std::string(std::istreambuf_iterator<char>(file), {}));
}

absl::Status written(const std::string& out, std::ofstream& file) {
  file.close();
  return file ? absl::OkStatus() : absl::UnavailableError("cannot write " + out);
}

absl::Status write_pixels(const std::string& out, const irsig::RadianceImage& image) {
  std::ofstream file(out, std::ios::binary);
  file << image.width_px << ' ' << image.height_px << '\n';
  file.write(reinterpret_cast<const char*>(image.radiance_w_m2_sr.data()),
             static_cast<std::streamsize>(image.radiance_w_m2_sr.size() * sizeof(float)));
  return written(out, file);
}

absl::Status paint(const std::string& out, const std::string& scale_text, const fs::path& folder) {
  const auto picture = read(folder / "picture.exr");
  if (!picture.ok()) return picture.status();
  if (scale_text == "pixels") return write_pixels(out, *picture);
  irsig::GreyScale scale{0, 0};
  if (scale_text == "common") {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const auto image = read(entry.path());
      if (!image.ok()) return image.status();
      for (const float radiance : image->radiance_w_m2_sr)
        scale.white_w_m2_sr = std::max(scale.white_w_m2_sr, radiance);
    }
  } else {
    const std::vector<std::string> ends = absl::StrSplit(scale_text, ',');
    if (ends.size() != 2 || !absl::SimpleAtof(ends[0], &scale.black_w_m2_sr) ||
        !absl::SimpleAtof(ends[1], &scale.white_w_m2_sr))
      return absl::InvalidArgumentError("scale " + scale_text + ", expected common or BLACK,WHITE");
  }
  const auto png = irsig::encode_png(*picture, scale);
  if (!png.ok()) return png.status();
  std::ofstream file(out, std::ios::binary);
  file << *png;
  return written(out, file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: irsig-picture OUT SCALE|pixels FOLDER\n");
    return 2;
  }
  const absl::Status status = paint(argv[1], argv[2], argv[3]);
  if (status.ok()) return 0;
  std::fprintf(stderr, "irsig-picture: %s\n", std::string(status.message()).c_str());
  return 1;
}
