#include <fmt/format.h>

#include <bit>
#include <fstream>

#include "view/atomic_file.h"
#include "view/export.h"
#include "view/progress.h"
#include "view/signature_quantity.h"

namespace irsig {
namespace {

// Braces and commas separate in a header; names of seasons and bands may have them.
std::string in_list(std::string text) {
  for (char& c : text)
    if (c == '{' || c == '}' || c == ',' || c == '\n') c = '_';
  return text;
}

std::string name_of(const StoredSignature& s) {
  const std::string row = s.row > 0 ? fmt::format("row {}", s.row) : "interpolated";
  return in_list(fmt::format("{} {} {} {} azimuth {:g} elevation {:g} deg range {:g} m", row,
                             s.season, s.time_utc, s.band, s.aspect_azimuth_deg,
                             s.aspect_elevation_deg, s.range_m));
}

}  // namespace

std::string envi_header_of(const std::string& path) {
  return path.substr(0, path.size() - (path.ends_with(".sli") ? 4 : 0)) + ".hdr";
}

absl::Status write_envi(StoreReader& reader, const std::vector<QueryRow>& rows,
                        SignatureQuantity quantity, const std::string& path) {
  static_assert(std::endian::native == std::endian::little, "the header says byte order 0");
  const QuantityColumns& columns = columns_of(quantity);
  std::vector<float> values;
  std::vector<std::string> names;
  std::vector<double> lambda_um;
  LoopProgress progress("spectra read, rows", rows.size());
  for (const QueryRow& row : rows) {
    const auto got = spectrum_of(reader, row);
    if (!got.ok()) return got.status();
    const schema::Spectrum& s = got->spectrum;
    const auto& spectrum = (s.*columns.spectral_value)();
    if (spectrum.empty())
      return absl::FailedPreconditionError(
          fmt::format("row {} has no spectrum of {}", row.signature.row, columns.name));
    const std::vector<double> axis(s.lambda_um().begin(), s.lambda_um().end());
    if (lambda_um.empty()) lambda_um = axis;
    if (axis != lambda_um)
      return absl::InvalidArgumentError(
          fmt::format("row {} has other wavelengths than row {}: a spectral library has one set of "
                      "them, expected --band (and --sweep)",
                      row.signature.row, rows.front().signature.row));
    values.insert(values.end(), spectrum.begin(), spectrum.end());
    names.push_back(name_of(row.signature));
    progress.step();
  }
  const auto header = fmt::format(
      "ENVI\ndescription = {{spectral {}, means over bins, per um}}\nsamples = {}\nlines = "
      "{}\nbands = 1\n"
      "header offset = 0\nfile type = ENVI Spectral Library\ndata type = 4\ninterleave = bsq\n"
      "byte order = 0\nwavelength units = Micrometers\nwavelength = {{{}}}\nspectra names = "
      "{{{}}}\n",
      columns.name, lambda_um.size(), rows.size(), fmt::join(lambda_um, ", "),
      fmt::join(names, ", "));
  // The header last: with it the library is complete.
  if (absl::Status s =
          replace_file(path, std::string_view(reinterpret_cast<const char*>(values.data()),
                                              values.size() * sizeof(float)));
      !s.ok())
    return s;
  return replace_file(envi_header_of(path), header);
}

}  // namespace irsig
