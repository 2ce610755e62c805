// irsig-picture: an image of radiances (EXR) as PNG, on a scale that other images share, or its
// pixels.
//
//   irsig-picture OUT.png SCALE FOLDER
//   irsig-picture OUT pixels FOLDER
//   irsig-picture SAID many ASKED
//
// FOLDER/picture.exr is painted. SCALE: "common", from 0 to the hottest pixel of all the folder's
// images, or BLACK,WHITE in W/(m2 sr). "pixels": a line "WIDTH HEIGHT", then float32 of this
// machine, row by row from the top left. "many": ASKED and SAID are pipes. Each line
// of ASKED, "OUT<tab>FILE", is answered by a line of SAID, "ok" or what is wrong; the program ends
// with ASKED. FILE has, of each image, a line
//
//   BYTES BLACK WHITE SEEN GAIN PATH BACKGROUND AREA PNG
//
// and so many bytes of EXR; SEEN: 1, if the image is to be as seen_from() makes it (image.h) of the
// four numbers behind it. It is painted from BLACK to WHITE as the file PNG; "-": it is only looked
// at. OUT has a line of each: "HOTTEST SHOWN LEFT TOP WIDTH HEIGHT": the hottest pixel of what is
// painted, and where the target is; or "damaged: " and why it cannot be read, as the program says
// of FOLDER/picture.exr. A program of its own, because OpenImageIO is slow to load.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
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

std::string one_line(const absl::Status& status) {
  std::string text(status.message());
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
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
  if (!picture.ok()) return absl::DataLossError("damaged: " + one_line(picture.status()));
  if (scale_text == "pixels") return write_pixels(out, *picture);
  irsig::GreyScale scale{0, 0};
  if (scale_text == "common") {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const auto image = read(entry.path());
      if (!image.ok())
        return absl::DataLossError(
            "of the images that share the scale one cannot be read (irsig "
            "export --thumbnails says which): " +
            one_line(image.status()));
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

struct Request {
  std::size_t bytes;
  irsig::GreyScale scale;
  int seen;
  irsig::SeenFrom from;
  std::string png;
};

std::optional<Request> next_request(std::istream& in) {
  Request r;
  in >> r.bytes >> r.scale.black_w_m2_sr >> r.scale.white_w_m2_sr >> r.seen >> r.from.gain >>
      r.from.path_radiance_w_m2_sr >> r.from.background_radiance_w_m2_sr >> r.from.target_area_px;
  if (!in || in.get() != ' ' || !std::getline(in, r.png)) return std::nullopt;
  return r;
}

absl::Status paint_many(const std::string& out_path, const std::string& in_path) {
  std::ifstream in(in_path, std::ios::binary);
  std::ofstream out(out_path);
  std::string exr;
  while (const auto request = next_request(in)) {
    exr.resize(request->bytes);
    in.read(exr.data(), static_cast<std::streamsize>(exr.size()));
    if (!in) return absl::InvalidArgumentError(in_path + " ends within an image");
    auto image = irsig::decode_exr(exr);
    if (!image.ok()) {
      out << "damaged: " << one_line(image.status()) << '\n';
      continue;
    }
    irsig::ImageContent content = irsig::content_of(*image);
    if (request->seen != 0) {
      *image = irsig::seen_from(*image, request->from);
      content.hottest_w_m2_sr =
          *std::max_element(image->radiance_w_m2_sr.begin(), image->radiance_w_m2_sr.end());
    }
    if (request->png != "-") {
      const auto png = irsig::encode_png(*image, request->scale);
      if (!png.ok()) return png.status();
      std::ofstream file(request->png, std::ios::binary);
      file << *png;
      if (absl::Status s = written(request->png, file); !s.ok()) return s;
    }
    char line[160];
    std::snprintf(line, sizeof line, "%.9g %u %u %u %u %u\n",
                  static_cast<double>(content.hottest_w_m2_sr), content.shown_px, content.left_px,
                  content.top_px, content.width_px, content.height_px);
    out << line;
  }
  if (!in.eof()) return absl::InvalidArgumentError(in_path + ": a line that is no image's");
  return written(out_path, out);
}

absl::Status serve(const std::string& said_path, const std::string& asked_path) {
  std::ifstream asked(asked_path);
  std::ofstream said(said_path);
  std::string line;
  while (std::getline(asked, line)) {
    const std::vector<std::string> files = absl::StrSplit(line, '\t');
    absl::Status done = files.size() == 2 ? paint_many(files[0], files[1])
                                          : absl::InvalidArgumentError("no two files: " + line);
    said << (done.ok() ? "ok" : one_line(done)) << std::endl;
  }
  return absl::OkStatus();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: irsig-picture OUT SCALE|pixels FOLDER, SAID many ASKED\n");
    return 2;
  }
  const absl::Status status =
      std::string(argv[2]) == "many" ? serve(argv[1], argv[3]) : paint(argv[1], argv[2], argv[3]);
  if (status.ok()) return 0;
  std::fprintf(stderr, "irsig-picture: %s\n", std::string(status.message()).c_str());
  return 1;
}
