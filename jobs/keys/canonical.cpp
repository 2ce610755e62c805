#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "absl/strings/str_cat.h"
#include "jobs/keys/expand.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

void append_quoted(std::string_view text, std::string& out) {
  constexpr std::string_view kHex = "0123456789abcdef";
  out += '"';
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f && c != '"' && c != '\\') {
      out += c;
    } else {
      out += "\\x";
      out += kHex[byte >> 4U];
      out += kHex[byte & 15U];
    }
  }
  out += '"';
}

void append_double(double value, std::string& out) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%a", value == 0 ? 0.0 : value);
  out += text.data();
}

// One value: of a singular field (index -1) or the index-th of a repeated one.
class Encoder {
 public:
  explicit Encoder(std::string& out) : out_(out) {}

  void encode(const Message& message, const std::string& prefix) {
    std::vector<const FieldDescriptor*> fields;
    message.GetReflection()->ListFields(message, &fields);  // by field number
    for (const FieldDescriptor* field : fields) {
      const std::string path = absl::StrCat(prefix, field->number());
      if (field->is_map()) {
        encode_map(message, *field, path);
      } else if (field->is_repeated()) {
        const int size = message.GetReflection()->FieldSize(message, field);
        for (int i = 0; i < size; ++i)
          encode_value(message, *field, i, absl::StrCat(path, "[", i, "]"));
      } else {
        encode_value(message, *field, -1, path);
      }
    }
  }

 private:
  void encode_map(const Message& message, const FieldDescriptor& field, const std::string& path) {
    const Reflection& reflection = *message.GetReflection();
    const FieldDescriptor* key = field.message_type()->map_key();
    std::vector<std::pair<std::string, const Message*>> entries;
    for (int i = 0; i < reflection.FieldSize(message, &field); ++i) {
      const Message& entry = reflection.GetRepeatedMessage(message, &field, i);
      entries.emplace_back(entry.GetReflection()->GetString(entry, key), &entry);
    }
    std::sort(entries.begin(), entries.end());
    for (const auto& [name, entry] : entries) {
      std::string entry_path = path + "{";
      append_quoted(name, entry_path);
      encode_value(*entry, *field.message_type()->map_value(), -1, entry_path + "}");
    }
  }

  void encode_value(const Message& message, const FieldDescriptor& field, int index,
                    const std::string& path) {
    const Reflection& r = *message.GetReflection();
    const bool one = index < 0;
    out_ += path;
    switch (field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        out_ += " message\n";
        encode(one ? r.GetMessage(message, &field) : r.GetRepeatedMessage(message, &field, index),
               path + ".");
        return;
      case FieldDescriptor::CPPTYPE_STRING:
        out_ += " string ";
        append_quoted(
            one ? r.GetString(message, &field) : r.GetRepeatedString(message, &field, index), out_);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        out_ += " double ";
        append_double(
            one ? r.GetDouble(message, &field) : r.GetRepeatedDouble(message, &field, index), out_);
        break;
      case FieldDescriptor::CPPTYPE_UINT32:
        absl::StrAppend(
            &out_, " uint ",
            one ? r.GetUInt32(message, &field) : r.GetRepeatedUInt32(message, &field, index));
        break;
      case FieldDescriptor::CPPTYPE_UINT64:
        absl::StrAppend(
            &out_, " uint ",
            one ? r.GetUInt64(message, &field) : r.GetRepeatedUInt64(message, &field, index));
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        out_ += (one ? r.GetBool(message, &field) : r.GetRepeatedBool(message, &field, index))
                    ? " bool true"
                    : " bool false";
        break;
      default:
        std::fprintf(stderr, "canonical_encoding: field %s has a type without an encoding\n",
                     field.full_name().c_str());
        std::abort();  // a new kind of field in sweep.proto or job.proto needs a line here
    }
    out_ += '\n';
  }

  std::string& out_;
};

}  // namespace

std::string canonical_encoding(const schema::ResolvedSweep& sweep) {
  std::string out;
  Encoder(out).encode(sweep, "");
  return out;
}

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest.data());
  std::string hex;
  for (const unsigned char byte : digest) {
    constexpr std::string_view kHex = "0123456789abcdef";
    hex += kHex[byte >> 4U];
    hex += kHex[byte & 15U];
  }
  return hex;
}

}  // namespace irsig
