#include "core/plume/volume/vdb_archive.h"

#include <algorithm>

namespace irsig {

VdbArchive::VdbArchive(std::istream& in) : in_(in), metadata_(new openvdb::io::StreamMetadata) {
  openvdb::io::setStreamMetadataPtr(in_, metadata_, false);
  readHeader(in_);
  setFormatVersion(in_);
  setLibraryVersion(in_);
  setDataCompression(in_);
  openvdb::MetaMap of_file;
  of_file.readMeta(in_);
  for (std::int32_t left = readGridCount(in_); left > 0; --left) {
    Entry entry;
    entry.grid = entry.descriptor.read(in_);
    entry.name = entry.descriptor.gridName();
    entry.value_type = entry.grid->valueType();
    if (inputHasGridOffsets()) {
      entry.descriptor.seekToEnd(in_);
    } else {
      readGrid(entry.grid, entry.descriptor, in_);
      entry.loaded = true;
    }
    if (!in_) OPENVDB_THROW(openvdb::IoError, "it ends too early");
    entries_.push_back(std::move(entry));
  }
}

void VdbArchive::read(Entry& entry) {
  load(entry);
  if (!entry.descriptor.isInstance()) return;
  const auto parent = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    return e.descriptor.uniqueName() == entry.descriptor.instanceParentName();
  });
  if (parent == entries_.end() || parent->descriptor.isInstance() ||
      parent->grid->type() != entry.grid->type())
    OPENVDB_THROW(openvdb::IoError, "a grid shares the tree of one that is not there");
  load(*parent);
  entry.grid->setTree(parent->grid->baseTreePtr());
}

void VdbArchive::load(Entry& entry) {
  if (entry.loaded) return;
  entry.descriptor.seekToGrid(in_);
  readGrid(entry.grid, entry.descriptor, in_);
  if (!in_) OPENVDB_THROW(openvdb::IoError, "it ends too early");
  entry.loaded = true;
}

}  // namespace irsig
