#include "schema/wire_size.h"

#include <unordered_map>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/message.h"

namespace irsig {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::io::CodedInputStream;

enum class WireType { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

constexpr std::uint64_t kAllocation = 16;  // of the heap, for each block
constexpr std::uint64_t kPointer = 8;      // in the list that holds it
constexpr int kDeepest = 32;

// An empty message, as it lies in memory.
std::uint64_t empty_bytes(const Descriptor& type) {
  thread_local std::unordered_map<const Descriptor*, std::uint64_t> known;
  std::uint64_t& bytes = known[&type];
  if (bytes == 0)
    bytes = static_cast<std::uint64_t>(google::protobuf::MessageFactory::generated_factory()
                                           ->GetPrototype(&type)
                                           ->SpaceUsedLong());
  return bytes;
}

std::uint64_t element_bytes(const FieldDescriptor& field) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_INT64:
    case FieldDescriptor::CPPTYPE_UINT64:
      return 8;
    default:
      return 4;
  }
}

bool is_packed_on_the_wire(const FieldDescriptor& field, WireType wire) {
  return field.is_packable() && wire == WireType::kBytes;
}

WireType wire_type_of(const FieldDescriptor& field) {
  switch (field.type()) {
    case FieldDescriptor::TYPE_DOUBLE:
    case FieldDescriptor::TYPE_FIXED64:
    case FieldDescriptor::TYPE_SFIXED64:
      return WireType::kFixed64;
    case FieldDescriptor::TYPE_FLOAT:
    case FieldDescriptor::TYPE_FIXED32:
    case FieldDescriptor::TYPE_SFIXED32:
      return WireType::kFixed32;
    case FieldDescriptor::TYPE_STRING:
    case FieldDescriptor::TYPE_BYTES:
    case FieldDescriptor::TYPE_MESSAGE:
      return WireType::kBytes;
    default:
      return WireType::kVarint;
  }
}

class Scan {
 public:
  explicit Scan(std::uint64_t most_bytes) : left_(most_bytes) {}

  absl::Status message(CodedInputStream& in, const Descriptor& type, int depth) {
    if (depth > kDeepest) return damaged(type);
    if (!take(empty_bytes(type) + kAllocation + kPointer)) return too_large();
    while (in.BytesUntilLimit() != 0) {
      const std::uint32_t tag = in.ReadTag();
      if (tag == 0) return in.ConsumedEntireMessage() ? absl::OkStatus() : damaged(type);
      const FieldDescriptor* field = type.FindFieldByNumber(static_cast<int>(tag >> 3U));
      if (field == nullptr)
        return absl::InvalidArgumentError(absl::StrCat(type.name(), " has no field ", tag >> 3U));
      RETURN_IF_ERROR(value(in, *field, WireType(tag & 7U), depth));
    }
    return absl::OkStatus();
  }

 private:
  absl::Status value(CodedInputStream& in, const FieldDescriptor& field, WireType wire, int depth) {
    const Descriptor& type = *field.containing_type();
    if (wire != wire_type_of(field) && !is_packed_on_the_wire(field, wire)) return damaged(type);
    std::uint64_t ignored = 0;
    std::uint32_t ignored_too = 0;
    bool read = true;
    switch (wire) {
      case WireType::kVarint:
        read = in.ReadVarint64(&ignored);
        break;
      case WireType::kFixed64:
        read = in.ReadLittleEndian64(&ignored);
        break;
      case WireType::kFixed32:
        read = in.ReadLittleEndian32(&ignored_too);
        break;
      case WireType::kBytes:
        return bytes(in, field, depth);
    }
    if (!read) return damaged(type);
    return !field.is_repeated() || take(2 * element_bytes(field)) ? absl::OkStatus() : too_large();
  }

  absl::Status bytes(CodedInputStream& in, const FieldDescriptor& field, int depth) {
    const Descriptor& type = *field.containing_type();
    int length = 0;
    if (!in.ReadVarintSizeAsInt(&length)) return damaged(type);
    const int until = in.BytesUntilLimit();
    if (until >= 0 && length > until) return damaged(type);
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      const CodedInputStream::Limit outer = in.PushLimit(length);
      RETURN_IF_ERROR(message(in, *field.message_type(), depth + 1));
      if (in.BytesUntilLimit() != 0) return damaged(type);
      in.PopLimit(outer);
      return absl::OkStatus();
    }
    const auto size = static_cast<std::uint64_t>(length);
    // A packed list of numbers that each take one byte on the wire.
    const std::uint64_t taken =
        is_packed_on_the_wire(field, WireType::kBytes)
            ? size * (wire_type_of(field) == WireType::kVarint ? 2 * element_bytes(field) : 1)
            : size + 32 + kAllocation + kPointer;
    if (!take(taken)) return too_large();
    return in.Skip(length) ? absl::OkStatus() : damaged(type);
  }

  bool take(std::uint64_t bytes) {
    if (bytes > left_) return false;
    left_ -= bytes;
    return true;
  }

  static absl::Status damaged(const Descriptor& type) {
    return absl::InvalidArgumentError(absl::StrCat("the bytes are no ", type.name()));
  }
  static absl::Status too_large() {
    return absl::ResourceExhaustedError("it would take more memory than it may");
  }

  std::uint64_t left_;
};

}  // namespace

absl::Status check_wire_size(std::string_view bytes, const Descriptor& type,
                             std::uint64_t most_bytes) {
  CodedInputStream in(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                      static_cast<int>(bytes.size()));
  in.SetTotalBytesLimit(static_cast<int>(bytes.size()));
  const CodedInputStream::Limit all = in.PushLimit(static_cast<int>(bytes.size()));
  const absl::Status status = Scan(most_bytes).message(in, type, 0);
  in.PopLimit(all);
  return status;
}

}  // namespace irsig
