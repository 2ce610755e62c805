#include "core/land/geotiff/read_geotiff.h"

#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/csv_rows.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr std::uint32_t kPixelScale = 33550, kTiepoints = 33922, kTransformation = 34264,
                        kGeoKeys = 34735, kNoData = 42113;
constexpr std::uint16_t kModelType = 1024, kRasterType = 1025, kGeographicType = 2048,
                        kProjectedType = 3072, kUserDefined = 32767;
constexpr tmsize_t kMostChunkBytes = tmsize_t{1} << 28;

constexpr const char* kConvert =
    "; convert it: gdalwarp -t_srs EPSG:326ZZ (south of the equator EPSG:327ZZ), ZZ = "
    "floor((longitude + 180) / 6) + 1";

absl::Status refuse_tiff(const std::string& why) { return absl::InvalidArgumentError(why); }

// A file in memory, as libtiff reads it; and what libtiff says is wrong with it.
struct TiffBytes {
  const std::string& bytes;
  std::uint64_t at = 0;
  std::string error{};
};

tmsize_t read_bytes(thandle_t handle, void* to, tmsize_t count) {
  auto& file = *static_cast<TiffBytes*>(handle);
  const std::uint64_t size = file.bytes.size();
  const std::uint64_t left = file.at < size ? size - file.at : 0;
  const auto taken =
      std::min<std::uint64_t>(left, count > 0 ? static_cast<std::uint64_t>(count) : 0);
  if (taken > 0) std::memcpy(to, file.bytes.data() + file.at, taken);
  file.at += taken;
  return static_cast<tmsize_t>(taken);
}
tmsize_t write_bytes(thandle_t, void*, tmsize_t) { return -1; }
toff_t seek_bytes(thandle_t handle, toff_t offset, int whence) {
  auto& file = *static_cast<TiffBytes*>(handle);
  file.at = offset + (whence == SEEK_CUR ? file.at : whence == SEEK_END ? file.bytes.size() : 0);
  return file.at;
}
int close_bytes(thandle_t) { return 0; }
toff_t size_of_bytes(thandle_t handle) { return static_cast<TiffBytes*>(handle)->bytes.size(); }

int keep_error(TIFF*, void* to, const char*, const char* format, va_list values) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, values);
  auto& error = *static_cast<std::string*>(to);
  if (error.empty()) error = one_line(text);
  return 1;
}
int drop_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using Tiff = std::unique_ptr<TIFF, CloseTiff>;

Tiff open_tiff(TiffBytes& file) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, &file.error);
  TIFFOpenOptionsSetWarningHandlerExtR(options, drop_warning, nullptr);
  Tiff tiff(TIFFClientOpenExt("heights", "rm", &file, read_bytes, write_bytes, seek_bytes,
                              close_bytes, size_of_bytes, nullptr, nullptr, options));
  TIFFOpenOptionsFree(options);
  return tiff;
}

// The values of a tag that libtiff does not know, if they have this type; none: it is missing.
template <typename T>
std::span<const T> values_of(TIFF* tiff, std::uint32_t tag, TIFFDataType type) {
  const TIFFField* field = TIFFFindField(tiff, tag, TIFF_ANY);
  if (field == nullptr || TIFFFieldDataType(field) != type || TIFFFieldPassCount(field) == 0 ||
      TIFFFieldReadCount(field) != TIFF_VARIABLE2)
    return {};
  std::uint32_t count = 0;
  const T* values = nullptr;
  if (TIFFGetField(tiff, tag, &count, &values) != 1 || values == nullptr) return {};
  return {values, count};
}

std::optional<std::uint16_t> geo_key(TIFF* tiff, std::uint16_t key) {
  const auto keys = values_of<std::uint16_t>(tiff, kGeoKeys, TIFF_SHORT);
  for (std::size_t at = 4; at + 4 <= keys.size(); at += 4)
    if (keys[at] == key && keys[at + 1] == 0) return keys[at + 3];
  return std::nullopt;
}

absl::Status take_system(TIFF* tiff, HeightRaster& out) {
  const auto model = geo_key(tiff, kModelType);
  const auto code = geo_key(tiff, model == std::uint16_t{2} ? kGeographicType : kProjectedType);
  if (!model || !code || *code == kUserDefined)
    return refuse_tiff(
        "the file does not state the EPSG code of its coordinates; add it: gdal_edit.py -a_srs "
        "EPSG:CODE FILE");
  ASSIGN_OR_RETURN(out.system, map_system(*code));
  return absl::OkStatus();
}

absl::Status take_place(TIFF* tiff, HeightRaster& out) {
  const auto scale = values_of<double>(tiff, kPixelScale, TIFF_DOUBLE);
  const auto tie = values_of<double>(tiff, kTiepoints, TIFF_DOUBLE);
  const auto matrix = values_of<double>(tiff, kTransformation, TIFF_DOUBLE);
  if (matrix.size() >= 16) {
    if (matrix[1] != 0 || matrix[4] != 0)
      return refuse_tiff(
          absl::StrCat("the raster is rotated, and its axes are not east and north", kConvert));
    out.x_step = matrix[0];
    out.y_step = matrix[5];
    out.x0 = matrix[3];
    out.y0 = matrix[7];
  } else if (scale.size() >= 2 && tie.size() == 6) {
    out.x_step = scale[0];
    out.y_step = -scale[1];
    out.x0 = tie[3] - tie[0] * out.x_step;
    out.y0 = tie[4] - tie[1] * out.y_step;
  } else {
    return refuse_tiff(absl::StrCat("the file does not state where its raster lies, by one tie ",
                                    "point and a scale or by a transformation", kConvert));
  }
  if (geo_key(tiff, kRasterType) != std::uint16_t{2}) {  // else samples are points, not areas
    out.x0 += 0.5 * out.x_step;
    out.y0 += 0.5 * out.y_step;
  }
  for (const double number : {out.x0, out.y0, 1 / out.x_step, 1 / out.y_step})
    if (!std::isfinite(number) || out.x_step == 0)
      return refuse_tiff(absl::StrCat("the raster's place or the size of its samples is no finite ",
                                      "number above 0", kConvert));
  return absl::OkStatus();
}

struct SampleForm {
  std::uint16_t bits = 1, format = SAMPLEFORMAT_UINT, bands = 1, planar = PLANARCONFIG_CONTIG;
};

// Reads one sample as a number; nullptr: a form that no raster of heights has.
using ReadSample = double (*)(const unsigned char*);
template <typename T>
double sample_as(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

ReadSample reader_of(const SampleForm& form) {
  const auto is = [&](int format, int bits) { return form.format == format && form.bits == bits; };
  if (is(SAMPLEFORMAT_IEEEFP, 32)) return sample_as<float>;
  if (is(SAMPLEFORMAT_IEEEFP, 64)) return sample_as<double>;
  if (is(SAMPLEFORMAT_INT, 8)) return sample_as<std::int8_t>;
  if (is(SAMPLEFORMAT_INT, 16)) return sample_as<std::int16_t>;
  if (is(SAMPLEFORMAT_INT, 32)) return sample_as<std::int32_t>;
  if (is(SAMPLEFORMAT_UINT, 8)) return sample_as<std::uint8_t>;
  if (is(SAMPLEFORMAT_UINT, 16)) return sample_as<std::uint16_t>;
  if (is(SAMPLEFORMAT_UINT, 32)) return sample_as<std::uint32_t>;
  return nullptr;
}

class GeoTiffReader {
 public:
  GeoTiffReader(TIFF* tiff, const std::string& error) : tiff_(tiff), error_(error) {}

  absl::StatusOr<HeightRaster> read() {
    HeightRaster out;
    RETURN_IF_ERROR(take_size(out));
    RETURN_IF_ERROR(take_place(tiff_, out));
    RETURN_IF_ERROR(take_system(tiff_, out));
    RETURN_IF_ERROR(take_form());
    take_no_data();
    out.height_m.resize(std::size_t{out.columns} * out.rows);
    RETURN_IF_ERROR(read_chunks(out));
    return out;
  }

 private:
  [[nodiscard]] absl::Status damaged(const std::string& what) const {
    return refuse_tiff(absl::StrCat("the file is damaged: ", what, error_.empty() ? "" : ": ",
                                    error_, "; load it again"));
  }

  absl::Status take_size(HeightRaster& out) {
    if (TIFFGetField(tiff_, TIFFTAG_IMAGEWIDTH, &out.columns) != 1 ||
        TIFFGetField(tiff_, TIFFTAG_IMAGELENGTH, &out.rows) != 1)
      return damaged("it does not state its size");
    if (out.columns < 2 || out.rows < 2 ||
        std::uint64_t{out.columns} * out.rows > kMostLandVertices)
      return refuse_tiff(absl::StrCat(
          "a raster of ", out.columns, " x ", out.rows, " samples is not from 2 x 2 to ",
          kMostLandVertices, " samples (memory); cut it: gdalwarp -te WEST SOUTH EAST NORTH"));
    return absl::OkStatus();
  }

  absl::Status take_form() {
    SampleForm form;
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_BITSPERSAMPLE, &form.bits);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_SAMPLEFORMAT, &form.format);
    TIFFGetFieldDefaulted(tiff_, TIFFTAG_SAMPLESPERPIXEL, &form.bands);
    if (form.bands != 1)
      return refuse_tiff(absl::StrCat("the file has ", form.bands,
                                      " bands; keep the one of heights: gdal_translate -b 1"));
    read_sample_ = reader_of(form);
    sample_bytes_ = form.bits / 8;
    if (read_sample_ == nullptr)
      return refuse_tiff(absl::StrCat("samples of ", form.bits, " bits in format ", form.format,
                                      " are not read; convert them: gdal_translate -ot Float32"));
    return absl::OkStatus();
  }

  void take_no_data() {
    const auto text = values_of<char>(tiff_, kNoData, TIFF_ASCII);
    std::string value(text.data(), text.size());
    value.resize(std::min(value.size(), value.find('\0')));
    absl::StripAsciiWhitespace(&value);
    no_data_ = finite_number(value);
  }

  // A chunk is a strip or a tile: all have the same number of columns and rows but the last ones.
  absl::Status read_chunks(HeightRaster& out) {
    const bool tiled = TIFFIsTiled(tiff_) != 0;
    std::uint32_t columns = out.columns, rows = out.rows;
    if (tiled) {
      TIFFGetField(tiff_, TIFFTAG_TILEWIDTH, &columns);
      TIFFGetField(tiff_, TIFFTAG_TILELENGTH, &rows);
    } else {
      TIFFGetFieldDefaulted(tiff_, TIFFTAG_ROWSPERSTRIP, &rows);
      rows = std::min(rows, out.rows);
    }
    const tmsize_t bytes = tiled ? TIFFTileSize(tiff_) : TIFFStripSize(tiff_);
    if (columns == 0 || rows == 0 || bytes <= 0 || bytes > kMostChunkBytes ||
        static_cast<std::uint64_t>(bytes) / sample_bytes_ < std::uint64_t{columns} * rows)
      return damaged("its strips or tiles have a size of 0 or above 256 MB");
    std::vector<unsigned char> chunk(static_cast<std::size_t>(bytes));
    std::uint32_t index = 0;
    for (std::uint32_t top = 0; top < out.rows; top += rows)
      for (std::uint32_t left = 0; left < out.columns; left += columns, ++index) {
        const std::uint32_t wide = std::min(columns, out.columns - left);
        const std::uint32_t high = std::min(rows, out.rows - top);
        const tmsize_t needed = static_cast<tmsize_t>(std::size_t{columns} * high * sample_bytes_);
        const tmsize_t got = tiled ? TIFFReadEncodedTile(tiff_, index, chunk.data(), bytes)
                                   : TIFFReadEncodedStrip(tiff_, index, chunk.data(), needed);
        if (got < needed) return damaged(absl::StrCat("strip or tile ", index, " cannot be read"));
        for (std::uint32_t row = 0; row < high; ++row)
          for (std::uint32_t column = 0; column < wide; ++column)
            out.height_m[std::size_t{top + row} * out.columns + left + column] =
                height(chunk.data() + (std::size_t{row} * columns + column) * sample_bytes_);
      }
    return absl::OkStatus();
  }

  // NaN: missing. Heights beyond any land stay what they are, for place_heights to refuse.
  [[nodiscard]] float height(const unsigned char* sample) const {
    const double value = read_sample_(sample);
    if (no_data_ && value == *no_data_) return std::numeric_limits<float>::quiet_NaN();
    return static_cast<float>(std::clamp(value, -2 * kMostHeightM, 2 * kMostHeightM));
  }

  TIFF* tiff_;
  const std::string& error_;
  ReadSample read_sample_ = nullptr;
  std::size_t sample_bytes_ = 0;
  std::optional<double> no_data_;
};

}  // namespace

absl::StatusOr<HeightRaster> read_geotiff(const std::string& file) {
  TiffBytes bytes{file};
  const Tiff tiff = open_tiff(bytes);
  if (tiff == nullptr)
    return refuse_tiff(
        absl::StrCat("the file is no TIFF that can be read: ", bytes.error, "; load it again"));
  return GeoTiffReader(tiff.get(), bytes.error).read();
}

}  // namespace irsig
