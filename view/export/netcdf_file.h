#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace irsig {

// A netCDF-4 file that is being written. After the first error later calls do nothing, and close()
// reports the error. The only user of the netCDF library. Names of quantities are those of the
// glossary; units and long_name are made from them.
class NetcdfFile {
 public:
  explicit NetcdfFile(const std::string& path);
  ~NetcdfFile();
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  // Puts all following content into a new group below the root; "/" is replaced by "_".
  void group(const std::string& name);

  using Dimension = int;
  Dimension dimension(const std::string& name, std::size_t length);
  void attribute(std::string_view name, const std::string& value);

  struct Quantity {
    std::string name;              // of the variable
    std::string long_name;         // empty: made from the name
    std::string of;                // the identifier whose unit it has; empty: its name
    std::string coordinates = "";  // CF attribute, empty: none
    std::string bounds = "";       // likewise
    std::string comment = "";      // likewise
  };
  // Writes the values in row-major order; their number is the product of the dimensions. NaN is the
  // fill value of doubles and floats.
  void doubles(const Quantity& what, const std::vector<Dimension>& dimensions,
               const std::vector<double>& values);
  // Writes instants as seconds since 1970, which readers of CF convert to dates; NaN: none.
  void times(const Quantity& what, const std::vector<Dimension>& dimensions,
             const std::vector<double>& unix_s);
  // A variable of floats that is written in pieces: put() writes all values of one index of the
  // first dimension.
  struct Variable {
    int id;
    std::size_t dimensions;
  };
  [[nodiscard]] Variable slabs(const Quantity& what, const std::vector<Dimension>& dimensions);
  void put(const Variable& to, std::size_t first, const std::vector<float>& values);
  void counts(const Quantity& what, const std::vector<Dimension>& dimensions,
              const std::vector<long long>& values);
  void strings(const Quantity& what, const std::vector<Dimension>& dimensions,
               const std::vector<std::string>& values);

  [[nodiscard]] absl::Status close();

 private:
  void check(int code, std::string_view doing);
  [[nodiscard]] std::string why(int code) const;
  int define(const Quantity& what, int type, const std::vector<Dimension>& dimensions);

  std::string path_;
  int file_ = -1, group_ = -1;
  absl::Status status_;
};

}  // namespace irsig
