#pragma once

#include <openvdb/openvdb.h>

#include <istream>
#include <string>
#include <vector>

namespace irsig {

// A VDB file in memory, of which only the grids that are asked for are read: OpenVDB's own io::File
// opens files by name, its io::Stream reads all that is there. Exceptions are OpenVDB's.
class VdbArchive : public openvdb::io::Archive {
 public:
  struct Entry {
    std::string name, value_type;  // "float", "double", "vec3s" ...
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid;  // empty until it is loaded
    bool loaded = false;
  };

  explicit VdbArchive(std::istream& in);
  [[nodiscard]] std::vector<Entry>& entries() { return entries_; }
  void read(Entry& entry);

 private:
  void load(Entry& entry);

  std::istream& in_;
  openvdb::io::StreamMetadata::Ptr metadata_;
  std::vector<Entry> entries_;
};

}  // namespace irsig
