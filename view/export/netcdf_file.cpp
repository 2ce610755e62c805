#include "view/export/netcdf_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netcdf.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "view/base/quantity.h"

namespace irsig {

NetcdfFile::NetcdfFile(const std::string& path) : path_(path) {
  check(nc_create(path.c_str(), NC_CLOBBER | NC_NETCDF4, &file_), "create");
  group_ = file_;
}

NetcdfFile::~NetcdfFile() {
  if (file_ >= 0) nc_close(file_);
}

void NetcdfFile::check(int code, std::string_view doing) {
  if (code != NC_NOERR && status_.ok())
    status_ = absl::UnavailableError(fmt::format("netCDF: {}: {}", doing, why(code)));
}

// The library says "Permission denied" whenever HDF5 cannot create a file, and "HDF error" whenever
// it cannot write one: whether the disk is full is asked of the system.
std::string NetcdfFile::why(int code) const {
  constexpr off_t kMore = 1 << 20;
  if (const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666); file >= 0) {
    const off_t size = ::lseek(file, 0, SEEK_END);
    const int room = size < 0 ? 0 : ::posix_fallocate(file, size, kMore);
    if (room == 0 && size >= 0) (void)!::ftruncate(file, size);
    ::close(file);
    if (room == ENOSPC || room == EDQUOT || room == EFBIG) return std::strerror(room);
    if (code == EACCES) return "HDF5 could not create the file";
  }
  return nc_strerror(code);
}

void NetcdfFile::group(const std::string& name) {
  std::string plain = name;
  std::replace(plain.begin(), plain.end(), '/', '_');
  if (status_.ok()) check(nc_def_grp(file_, plain.c_str(), &group_), name);
}

NetcdfFile::Dimension NetcdfFile::dimension(const std::string& name, std::size_t length) {
  int id = -1;
  if (status_.ok()) check(nc_def_dim(group_, name.c_str(), length, &id), name);
  return id;
}

void NetcdfFile::attribute(std::string_view name, const std::string& value) {
  if (!status_.ok()) return;
  check(nc_put_att_text(group_, NC_GLOBAL, std::string(name).c_str(), value.size(), value.data()),
        name);
}

int NetcdfFile::define(const Quantity& what, int type, const std::vector<Dimension>& dimensions) {
  int id = -1;
  if (!status_.ok()) return id;
  check(nc_def_var(group_, what.name.c_str(), type, static_cast<int>(dimensions.size()),
                   dimensions.data(), &id),
        what.name);
  const auto text = [&](const char* name, const std::string& value) {
    if (!value.empty() && status_.ok()) {
      check(nc_put_att_text(group_, id, name, value.size(), value.data()), what.name);
    }
  };
  const irsig::Quantity quantity = quantity_of(what.of.empty() ? what.name : what.of);
  text("long_name", what.long_name.empty() ? quantity.noun : what.long_name);
  if (type != NC_STRING) text("units", quantity.cf_unit);
  text("coordinates", what.coordinates);
  text("bounds", what.bounds);
  text("comment", what.comment);
  // CF allows no fill value where a variable is the coordinate of its own dimension.
  char dimension[NC_MAX_NAME + 1] = "";
  if (status_.ok() && dimensions.size() == 1)
    check(nc_inq_dimname(group_, dimensions.front(), dimension), what.name);
  const bool coordinate = what.name == dimension;
  if (status_.ok() && type == NC_DOUBLE && !coordinate) {
    const double fill = std::numeric_limits<double>::quiet_NaN();
    check(nc_def_var_fill(group_, id, NC_FILL, &fill), what.name);
  } else if (status_.ok() && type == NC_FLOAT) {
    const float fill = std::numeric_limits<float>::quiet_NaN();
    check(nc_def_var_fill(group_, id, NC_FILL, &fill), what.name);
    // Spectra are smooth: level 4 with shuffling halves them; higher levels gain < 2 %.
    if (!dimensions.empty()) check(nc_def_var_deflate(group_, id, 1, 1, 4), what.name);
  }
  return id;
}

void NetcdfFile::doubles(const Quantity& what, const std::vector<Dimension>& dimensions,
                         const std::vector<double>& values) {
  const int id = define(what, NC_DOUBLE, dimensions);
  if (status_.ok()) check(nc_put_var_double(group_, id, values.data()), what.name);
}

void NetcdfFile::times(const Quantity& what, const std::vector<Dimension>& dimensions,
                       const std::vector<double>& unix_s) {
  const int id = define(what, NC_DOUBLE, dimensions);
  for (const auto& [name, value] :
       {std::pair<const char*, std::string_view>{"units", "seconds since 1970-01-01 00:00:00"},
        {"calendar", "standard"}})
    if (status_.ok())
      check(nc_put_att_text(group_, id, name, value.size(), value.data()), what.name);
  if (status_.ok()) check(nc_put_var_double(group_, id, unix_s.data()), what.name);
}

NetcdfFile::Variable NetcdfFile::slabs(const Quantity& what,
                                       const std::vector<Dimension>& dimensions) {
  const int id = define(what, NC_FLOAT, dimensions);
  std::vector<std::size_t> chunk;
  for (const Dimension d : dimensions) {
    std::size_t length = 0;
    if (status_.ok()) check(nc_inq_dimlen(group_, d, &length), what.name);
    chunk.push_back(chunk.empty() ? 1 : length);
  }
  if (status_.ok()) check(nc_def_var_chunking(group_, id, NC_CHUNKED, chunk.data()), what.name);
  return {id, dimensions.size()};
}

void NetcdfFile::put(const Variable& to, std::size_t first, const std::vector<float>& values) {
  if (!status_.ok()) return;
  std::vector<std::size_t> start(to.dimensions, 0), count(to.dimensions, 1);
  std::vector<int> dimension(to.dimensions);
  check(nc_inq_vardimid(group_, to.id, dimension.data()), "put");
  for (std::size_t i = 1; i < to.dimensions; ++i)
    check(nc_inq_dimlen(group_, dimension[i], &count[i]), "put");
  start[0] = first;
  check(nc_put_vara_float(group_, to.id, start.data(), count.data(), values.data()), "put");
}

void NetcdfFile::counts(const Quantity& what, const std::vector<Dimension>& dimensions,
                        const std::vector<long long>& values) {
  const int id = define(what, NC_INT64, dimensions);
  if (status_.ok()) check(nc_put_var_longlong(group_, id, values.data()), what.name);
}

void NetcdfFile::strings(const Quantity& what, const std::vector<Dimension>& dimensions,
                         const std::vector<std::string>& values) {
  const int id = define(what, NC_STRING, dimensions);
  if (!status_.ok()) return;
  std::vector<const char*> text;
  for (const auto& v : values) text.push_back(v.c_str());
  check(nc_put_var_string(group_, id, text.data()), what.name);
}

absl::Status NetcdfFile::close() {
  if (file_ >= 0) check(nc_close(file_), "close");
  file_ = group_ = -1;
  return status_;
}

}  // namespace irsig
