#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <fstream>

#include "core/base/status_macros.h"
#include "view/base/atomic_file.h"
#include "view/base/envi_text.h"
#include "view/base/progress.h"
#include "view/export/export.h"
#include "view/rows/signature_quantity.h"

namespace irsig {
namespace {

std::string name_of(const StoredSignature& s) {
  const std::string row = s.row > 0 ? fmt::format("row {}", s.row) : "interpolated";
  return envi_text(fmt::format("{} {} {} {} azimuth {:g} elevation {:g} deg range {:g} m of {}",
                               row, s.season, s.time_utc, s.band, s.aspect_azimuth_deg,
                               s.aspect_elevation_deg, s.range_m, s.sweep));
}

}  // namespace

std::string envi_header_of(const std::string& path) {
  return path.substr(0, path.size() - (path.ends_with(".sli") ? 4 : 0)) + ".hdr";
}

absl::Status write_envi(StoreReader& reader, QueryRows& rows, SignatureQuantity quantity,
                        const std::string& path) {
  static_assert(std::endian::native == std::endian::little, "the header says byte order 0");
  const QuantityColumns& columns = columns_of(quantity);
  std::vector<std::string> names;
  std::vector<double> lambda_um;
  std::uint64_t first_row = 0;
  LoopProgress progress("spectra written, rows", rows.count());
  const auto append = [&](const QueryRow& row, std::ostream& out) -> absl::Status {
    ASSIGN_OR_RETURN(const auto got, spectrum_of(reader, row));
    const schema::Spectrum& s = got.spectrum;
    const auto& spectrum = (s.*columns.spectral_value)();
    if (spectrum.empty())
      return absl::FailedPreconditionError(
          fmt::format("row {} has no spectrum of {}", row.signature.row, columns.name));
    if (lambda_um.empty()) {
      lambda_um.assign(s.lambda_um().begin(), s.lambda_um().end());
      first_row = row.signature.row;
    }
    if (!std::equal(lambda_um.begin(), lambda_um.end(), s.lambda_um().begin(), s.lambda_um().end()))
      return absl::InvalidArgumentError(
          fmt::format("row {} has other wavelengths than row {}: a spectral library has one set of "
                      "them, expected --band (and --sweep)",
                      row.signature.row, first_row));
    out.write(reinterpret_cast<const char*>(spectrum.data()),
              static_cast<std::streamsize>(sizeof(float)) * spectrum.size());
    names.push_back(name_of(row.signature));
    progress.step();
    return absl::OkStatus();
  };
  const absl::Status written = replace_file(path, [&](const std::string& beside) -> absl::Status {
    errno = 0;
    std::ofstream file(beside, std::ios::binary | std::ios::trunc);
    while (file) {
      ASSIGN_OR_RETURN(const auto some, rows.next());
      if (some.empty()) break;
      for (const QueryRow& row : some) RETURN_IF_ERROR(append(row, file));
    }
    file.close();
    if (!file) return write_failure(path);
    if (names.empty())
      return absl::NotFoundError("nothing to export: no signature matches the filters");
    return absl::OkStatus();
  });
  if (!written.ok()) return written;
  // The header last: with it the library is complete.
  return replace_file(
      envi_header_of(path),
      fmt::format(
          "ENVI\ndescription = {{spectral {}, means over bins, per um}}\nsamples = {}\nlines = "
          "{}\nbands = 1\n"
          "header offset = 0\nfile type = ENVI Spectral Library\ndata type = 4\ninterleave = bsq\n"
          "byte order = 0\nwavelength units = Micrometers\nwavelength = {{{}}}\nspectra names = "
          "{{{}}}\n",
          columns.name, lambda_um.size(), names.size(), fmt::join(lambda_um, ", "),
          fmt::join(names, ", ")));
}

}  // namespace irsig
