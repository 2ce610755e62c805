// irsig-picture: an image of radiances (EXR) as PNG, on a scale that other images share.
//
//   irsig-picture OUT.png SCALE FOLDER
//
// FOLDER/picture.exr is painted. SCALE: "common", from 0 to the hottest pixel of all the folder's
// images, or BLACK,WHITE in W/(m2 sr). A program of its own, because OpenImageIO is slow to load.
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

absl::Status paint(const std::string& out, const std::string& scale_text, const fs::path& folder) {
  const auto picture = read(folder / "picture.exr");
  if (!picture.ok()) return picture.status();
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
  file.close();
  return file ? absl::OkStatus() : absl::UnavailableError("cannot write " + out);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: irsig-picture OUT.png SCALE FOLDER\n");
    return 2;
  }
  const absl::Status status = paint(argv[1], argv[2], argv[3]);
  if (status.ok()) return 0;
  std::fprintf(stderr, "irsig-picture: %s\n", std::string(status.message()).c_str());
  return 1;
}
