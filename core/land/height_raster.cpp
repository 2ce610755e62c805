#include "core/land/height_raster.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/csv_rows.h"
#include "core/base/file_errors.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

absl::Status refuse(std::string_view file, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat(one_line(file), ": ", why));
}

struct Corner {
  int latitude_deg, longitude_deg;
};

// N46E007 at the beginning of the name, without its folder.
std::optional<Corner> corner_named(std::string_view file) {
  file.remove_prefix(file.rfind('/') + 1);  // npos + 1 is 0
  const auto signed_number = [&](std::size_t at, std::size_t digits, char plus,
                                 char minus) -> std::optional<int> {
    int value = 0;
    const char letter = absl::ascii_toupper(static_cast<unsigned char>(file[at]));
    const char* begin = file.data() + at + 1;
    const auto [end, error] = std::from_chars(begin, begin + digits, value);
    if (error != std::errc() || end != begin + digits || value < 0) return std::nullopt;
    if (letter != plus && letter != minus) return std::nullopt;
    return letter == plus ? value : -value;
  };
  if (file.size() < 7) return std::nullopt;
  const auto latitude = signed_number(0, 2, 'N', 'S'), longitude = signed_number(3, 3, 'E', 'W');
  if (!latitude || !longitude || *latitude < -90 || *latitude > 89 || *longitude < -180 ||
      *longitude > 179)
    return std::nullopt;
  return Corner{*latitude, *longitude};
}

// Words of a text between white space, with their places.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  // The next word; empty at the end of the text.
  std::string_view next() {
    while (at_ < text_.size() && absl::ascii_isspace(static_cast<unsigned char>(text_[at_])))
      if (text_[at_++] == '\n') {
        ++line_;
        line_begin_ = at_;
      }
    column_ = at_ - line_begin_ + 1;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !absl::ascii_isspace(static_cast<unsigned char>(text_[at_])))
      ++at_;
    return text_.substr(begin, at_ - begin);
  }
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::size_t column() const { return column_; }
  [[nodiscard]] std::size_t left() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0, line_ = 1, line_begin_ = 0, column_ = 1;
};

struct AscHeader {
  std::optional<double> ncols, nrows, xllcorner, xllcenter, yllcorner, yllcenter, cellsize,
      nodata_value;
};

std::optional<double>* header_value(AscHeader& header, std::string_view key) {
  const std::string name = absl::AsciiStrToLower(std::string(key));
  const std::array<std::pair<std::string_view, std::optional<double>*>, 8> known{
      {{"ncols", &header.ncols},
       {"nrows", &header.nrows},
       {"xllcorner", &header.xllcorner},
       {"xllcenter", &header.xllcenter},
       {"yllcorner", &header.yllcorner},
       {"yllcenter", &header.yllcenter},
       {"cellsize", &header.cellsize},
       {"nodata_value", &header.nodata_value}}};
  for (const auto& [key_known, value] : known)
    if (name == key_known) return value;
  return nullptr;
}

class AscReader {
 public:
  AscReader(std::string_view text, std::string_view file) : words_(text), file_(file) {}

  absl::StatusOr<HeightRaster> read(const MapSystem& system) {
    RETURN_IF_ERROR(read_header());
    HeightRaster out{.system = system, .height_m = {}};
    RETURN_IF_ERROR(take_header(out));
    RETURN_IF_ERROR(read_heights(out));
    return out;
  }

 private:
  [[nodiscard]] absl::Status here(const std::string& why) const {
    FileErrors errors(file_);
    errors.add(words_.line(), words_.column(), why);
    return errors.status();
  }

  // Leaves the first word that is no key of the header in word_.
  absl::Status read_header() {
    for (word_ = words_.next(); !word_.empty() && !finite_number(word_); word_ = words_.next()) {
      std::optional<double>* value = header_value(header_, word_);
      if (value == nullptr)
        return here(absl::StrCat("\"", std::string(word_.substr(0, 40)),
                                 "\" is no key of an ESRI ASCII grid; expected ncols, nrows, "
                                 "xllcorner, yllcorner, cellsize, nodata_value"));
      if (value->has_value())
        return here(absl::StrCat(std::string(word_), " is given twice; delete one line"));
      const std::string key(word_);
      *value = finite_number(words_.next());
      if (!value->has_value()) return here(absl::StrCat(key, " needs a finite number"));
    }
    return absl::OkStatus();
  }

  absl::Status take_header(HeightRaster& out) {
    const auto& h = header_;
    if (!h.ncols || !h.nrows || !h.cellsize || h.xllcorner.has_value() == h.xllcenter.has_value() ||
        h.yllcorner.has_value() == h.yllcenter.has_value())
      return here(
          "the header is not complete; it needs ncols, nrows, cellsize, one of xllcorner and "
          "xllcenter, and one of yllcorner and yllcenter");
    for (const double n : {*h.ncols, *h.nrows})
      if (n < 2 || n != std::floor(n) || n > double(kMostLandVertices))
        return here(absl::StrCat("ncols and nrows are ", *h.ncols, " and ", *h.nrows,
                                 "; expected whole numbers from 2 to ", kMostLandVertices));
    if (*h.cellsize <= 0) return here(absl::StrCat("cellsize is ", *h.cellsize, "; expected > 0"));
    const double samples = *h.ncols * *h.nrows;
    // Each height takes a character and a space.
    if (samples > double(kMostLandVertices) || samples / 2 > double(words_.left() + word_.size()))
      return here(absl::StrCat("the header states ", samples, " heights, more than the file holds",
                               " or more than the limit of ", kMostLandVertices));
    out.columns = static_cast<std::uint32_t>(*h.ncols);
    out.rows = static_cast<std::uint32_t>(*h.nrows);
    out.x_step = *h.cellsize;
    out.y_step = -*h.cellsize;
    out.x0 = h.xllcenter ? *h.xllcenter : *h.xllcorner + 0.5 * *h.cellsize;
    const double south = h.yllcenter ? *h.yllcenter : *h.yllcorner + 0.5 * *h.cellsize;
    out.y0 = south + (*h.nrows - 1) * *h.cellsize;
    return absl::OkStatus();
  }

  absl::Status read_heights(HeightRaster& out) {
    const std::size_t samples = std::size_t{out.columns} * out.rows;
    out.height_m.reserve(samples);
    for (; !word_.empty(); word_ = words_.next()) {
      if (out.height_m.size() == samples)
        return here(absl::StrCat("more than the ", out.columns, " x ", out.rows,
                                 " heights that the header states"));
      const std::optional<double> height = finite_number(word_);
      if (!height)
        return here(absl::StrCat("\"", std::string(word_.substr(0, 40)),
                                 "\" is no finite number; write ",
                                 "nodata_value where a height is missing"));
      if (std::abs(*height) > kMostHeightM && height != header_.nodata_value)
        return here(absl::StrCat("a height of ", *height,
                                 " m is beyond 100 km; state nodata_value if it means missing"));
      out.height_m.push_back(height == header_.nodata_value ? kMissing
                                                            : static_cast<float>(*height));
    }
    if (out.height_m.size() < samples)
      return here(
          absl::StrCat("the file ends after ", out.height_m.size(), " of ", samples, " heights"));
    return absl::OkStatus();
  }

  Words words_;
  std::string_view file_, word_;
  AscHeader header_;
};

}  // namespace

absl::StatusOr<MapSystem> map_system(std::uint64_t epsg) {
  if (epsg == 4326) return MapSystem(GeographicDegrees{});
  const auto zone = static_cast<int>(epsg % 100);
  if ((epsg / 100 == 326 || epsg / 100 == 327) && zone >= 1 && zone <= 60)
    return MapSystem(UtmZone{zone, epsg / 100 == 327});
  return absl::InvalidArgumentError(absl::StrCat(
      "coordinates of EPSG:", epsg, " are not read; convert the file to a UTM zone: gdalwarp ",
      "-t_srs EPSG:326ZZ (south of the equator EPSG:327ZZ), ZZ = floor((longitude + 180) / 6) + "
      "1"));
}

absl::StatusOr<HeightRaster> read_hgt(std::string_view bytes, std::string_view file) {
  const auto corner = corner_named(file);
  if (!corner)
    return refuse(file,
                  "the name does not state the tile's southwest corner; expected a name that "
                  "begins as N46E007.hgt does");
  std::uint32_t side = 0;
  for (const std::uint32_t known : {1201U, 3601U})
    if (bytes.size() == std::size_t{2} * known * known) side = known;
  if (side == 0)
    return refuse(file,
                  absl::StrCat(bytes.size(),
                               " bytes are no tile of 1201 x 1201 or 3601 x 3601 heights "
                               "(2884802 or 25934402 bytes); decompress it or load it again"));
  const double step = 1.0 / (side - 1);
  HeightRaster out{.system = GeographicDegrees{},
                   .x0 = double(corner->longitude_deg),
                   .y0 = corner->latitude_deg + 1.0,
                   .x_step = step,
                   .y_step = -step,
                   .columns = side,
                   .rows = side,
                   .height_m = {}};
  out.height_m.reserve(std::size_t{side} * side);
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    const auto high = static_cast<unsigned char>(bytes[at]);
    const auto low = static_cast<unsigned char>(bytes[at + 1]);
    const auto height = static_cast<std::int16_t>(high << 8 | low);
    out.height_m.push_back(height == -32768 ? kMissing : static_cast<float>(height));
  }
  return out;
}

absl::StatusOr<HeightRaster> read_asc(std::string_view text, std::string_view file,
                                      const MapSystem& system) {
  return AscReader(text, file).read(system);
}

std::string write_asc(const HeightRaster& raster) {
  constexpr float kNoData = -99999;
  std::string out;
  const auto append = [&](auto number) {  // as many digits as reading it back takes
    std::array<char, 32> digits{};
    out.append(digits.data(),
               std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
  };
  const auto line = [&](const char* key, auto number) {
    out += key;
    append(number);
    out += '\n';
  };
  line("ncols ", raster.columns);
  line("nrows ", raster.rows);
  line("xllcenter ", raster.x0);
  line("yllcenter ", raster.y0 + (raster.rows - 1) * raster.y_step);
  line("cellsize ", raster.x_step);
  line("nodata_value ", kNoData);
  for (std::size_t at = 0; at < raster.height_m.size(); ++at) {
    const float height = raster.height_m[at];
    append(std::isnan(height) ? kNoData : height);
    out += (at + 1) % raster.columns == 0 ? '\n' : ' ';
  }
  return out;
}

}  // namespace irsig
