#include "core/scene/import/import_gltf_file.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "fmt/format.h"

namespace irsig {
namespace {

constexpr std::uint64_t kMostNumbers = 1'000'000'000;  // of an accessor: 8 GB

std::uint64_t little_endian(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t out = 0;
  for (std::size_t i = size; i-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes[at + i]);
  return out;
}

std::size_t component_bytes(std::uint64_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

double component(std::string_view bytes, std::size_t at, std::uint64_t type, bool normalized) {
  const std::uint64_t bits = little_endian(bytes, at, component_bytes(type));
  const auto scaled = [normalized](double value, double most) {
    return normalized ? std::max(value / most, -1.0) : value;
  };
  switch (type) {
    case 5120:
      return scaled(static_cast<std::int8_t>(bits), 127);
    case 5121:
      return scaled(static_cast<double>(bits), 255);
    case 5122:
      return scaled(static_cast<std::int16_t>(bits), 32767);
    case 5123:
      return scaled(static_cast<double>(bits), 65535);
    case 5125:
      return scaled(static_cast<double>(bits), 4294967295.0);
    default:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  }
}

std::size_t width_of(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  return 0;
}

}  // namespace

absl::StatusOr<std::string> bytes_of_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos || !uri.substr(0, comma).ends_with(";base64"))
    return absl::InvalidArgumentError("expected data:...;base64,...");
  std::string out;
  std::uint32_t group = 0;
  int digits = 0;
  for (char c : uri.substr(comma + 1)) {
    std::uint32_t digit = 0;
    if (c == '=') break;
    if (c >= 'A' && c <= 'Z')
      digit = static_cast<std::uint32_t>(c - 'A');
    else if (c >= 'a' && c <= 'z')
      digit = static_cast<std::uint32_t>(c - 'a' + 26);
    else if (c >= '0' && c <= '9')
      digit = static_cast<std::uint32_t>(c - '0' + 52);
    else if (c == '+' || c == '-')
      digit = 62;
    else if (c == '/' || c == '_')
      digit = 63;
    else
      return absl::InvalidArgumentError("there is a character that base64 does not have");
    group = group << 6 | digit;
    if (++digits % 4 == 0) {
      for (const int shift : {16, 8, 0}) out += static_cast<char>(group >> shift & 0xff);
      group = 0;
    }
  }
  if (digits % 4 == 1) return absl::InvalidArgumentError("the base64 text is cut short");
  if (digits % 4 == 2) out += static_cast<char>(group >> 4 & 0xff);
  if (digits % 4 == 3) {
    out += static_cast<char>(group >> 10 & 0xff);
    out += static_cast<char>(group >> 2 & 0xff);
  }
  return out;
}

GltfFile::GltfFile(std::string_view bytes, const std::string& file_name) : file_name_(file_name) {
  read_container(bytes);
  if (ok()) check_version();
}

void GltfFile::fail(std::string_view place, std::string_view what) {
  if (!ok()) return;
  status_ = absl::InvalidArgumentError(place.empty()
                                           ? fmt::format("{}: {}", file_name_, what)
                                           : fmt::format("{}: {}: {}", file_name_, place, what));
}

void GltfFile::read_container(std::string_view bytes) {
  std::string_view json = bytes;
  if (bytes.starts_with("glTF")) {
    if (bytes.size() < 20) return fail("", "the file is cut short: a GLB has at least 20 bytes");
    const std::uint64_t version = little_endian(bytes, 4, 4), length = little_endian(bytes, 8, 4);
    if (version != 2)
      return fail("", fmt::format("this is GLB of version {}, expected version 2: export it as "
                                  "glTF 2.0",
                                  version));
    if (length > bytes.size())
      return fail(
          "", fmt::format("the file is cut short: it has {} bytes of {}", bytes.size(), length));
    const std::uint64_t json_bytes = little_endian(bytes, 12, 4);
    if (little_endian(bytes, 16, 4) != 0x4e4f534a)
      return fail("", "the first chunk of this GLB is not its JSON");
    if (json_bytes > length - std::min<std::uint64_t>(length, 20))
      return fail("", fmt::format("the JSON chunk of {} bytes ends behind the file", json_bytes));
    if (json_bytes % 4 != 0)
      return fail("", fmt::format("the JSON chunk has {} bytes, and GLB requires a multiple of 4: "
                                  "fill it up with blanks, or export the file again",
                                  json_bytes));
    json = bytes.substr(20, json_bytes);
    for (std::uint64_t at = 20 + json_bytes; at + 8 <= length;) {
      const std::uint64_t size = little_endian(bytes, at, 4);
      if (size > length - at - 8)
        return fail("", fmt::format("the chunk at byte {} ends behind the file", at));
      if (!has_binary_ && little_endian(bytes, at + 4, 4) == 0x004e4942) {
        binary_ = bytes.substr(at + 8, size);
        has_binary_ = true;
      }
      at += 8 + (size + 3) / 4 * 4;
    }
  }
  absl::StatusOr<JsonValue> root = parse_json(json, file_name_);
  if (!root.ok()) {
    status_ = root.status();
    return;
  }
  root_ = *std::move(root);
  if (root_.kind != JsonValue::Kind::kObject) fail("", "this is no glTF: its JSON is no object");
}

void GltfFile::check_version() {
  const JsonValue* asset = root_.find("asset");
  const JsonValue* version = asset == nullptr ? nullptr : asset->find("version");
  if (version == nullptr) return fail("asset.version", "is missing, expected \"2.0\"");
  const JsonValue* least = asset->find("minVersion");
  if (version->text.starts_with("2.") && (least == nullptr || least->text == "2.0")) return;
  fail(least == nullptr ? "asset.version" : "asset.minVersion",
       fmt::format("this is glTF {}, expected 2.0: export it as glTF 2.0",
                   least == nullptr ? version->text : least->text));
}

std::size_t GltfFile::count(std::string_view name) const {
  const JsonValue* list = root_.find(name);
  return list == nullptr ? 0 : list->item.size();
}

const JsonValue* GltfFile::element(std::string_view name, std::size_t index) {
  const JsonValue* list = root_.find(name);
  const std::size_t size = list == nullptr ? 0 : list->item.size();
  if (index < size && list->item[index].kind == JsonValue::Kind::kObject) return &list->item[index];
  fail(fmt::format("{}[{}]", name, index),
       index < size ? std::string("this is no object")
                    : fmt::format("does not exist: the file has {} {}", size, name));
  return nullptr;
}

std::uint64_t GltfFile::whole(const JsonValue& of, std::string_view name, std::string_view place,
                              std::uint64_t otherwise) {
  const JsonValue* value = of.find(name);
  if (value == nullptr) return otherwise;
  if (value->kind == JsonValue::Kind::kNumber && value->number >= 0 &&
      value->number <= 4294967295.0 && value->number == std::floor(value->number))
    return static_cast<std::uint64_t>(value->number);
  fail(fmt::format("{}.{}", place, name), "expected a whole number from 0 to 4294967295");
  return otherwise;
}

std::size_t GltfFile::index(const JsonValue& of, std::string_view name, std::string_view place) {
  if (of.find(name) == nullptr)
    fail(fmt::format("{}.{}", place, name), "is missing, expected a number from 0");
  return whole(of, name, place, 0);
}

std::vector<double> GltfFile::numbers(const JsonValue& of, std::string_view name,
                                      std::string_view place) {
  std::vector<double> out;
  const JsonValue* list = of.find(name);
  if (list == nullptr) return out;
  if (list->kind != JsonValue::Kind::kArray)
    fail(fmt::format("{}.{}", place, name), "expected a list of numbers");
  for (const JsonValue& item : list->item) {
    if (item.kind != JsonValue::Kind::kNumber)
      fail(fmt::format("{}.{}[{}]", place, name, out.size()), "expected a number");
    out.push_back(item.number);
  }
  return out;
}

std::string_view GltfFile::buffer(std::size_t index) {
  const JsonValue* buffer = element("buffers", index);
  if (buffer == nullptr) return {};
  const std::string place = fmt::format("buffers[{}]", index);
  const std::uint64_t bytes = this->index(*buffer, "byteLength", place);
  std::string_view found;
  if (const JsonValue* uri = buffer->find("uri"); uri != nullptr) {
    if (!uri->text.starts_with("data:")) {
      fail(place + ".uri", fmt::format("the file \"{}\" was not found beside this one", uri->text));
      return {};
    }
    auto decoded = decoded_.find(index);
    if (decoded == decoded_.end()) {
      absl::StatusOr<std::string> read = bytes_of_data_uri(uri->text);
      if (!read.ok()) fail(place + ".uri", std::string(read.status().message()));
      if (!ok()) return {};
      decoded = decoded_.emplace(index, *std::move(read)).first;
    }
    found = decoded->second;
  } else if (index == 0 && has_binary_) {
    found = binary_;
  } else {
    const JsonValue* extensions = buffer->find("extensions");
    fail(place, extensions != nullptr && !extensions->member.empty()
                    ? fmt::format("has no bytes of its own but the extension {}, which is not "
                                  "read: export the model without compression",
                                  extensions->member.front().name)
                    : std::string("has neither a uri nor a chunk of this file"));
    return {};
  }
  if (found.size() < bytes) {
    fail(place + ".byteLength",
         fmt::format("is {}, but the buffer has {} bytes", bytes, found.size()));
    return {};
  }
  return found.substr(0, bytes);
}

std::string_view GltfFile::view(std::size_t index, std::string_view from, std::uint64_t& stride) {
  const JsonValue* view = element("bufferViews", index);
  if (view == nullptr) return {};
  const std::string place = fmt::format("bufferViews[{}]", index);
  if (const JsonValue* extensions = view->find("extensions"); extensions != nullptr)
    for (const auto& [name, value] : extensions->member)
      if (name.find("compression") != name.npos) {
        // Compressed data have a plain copy where the extension is not required.
        const JsonValue* fallback = root_.find("buffers");
        const std::size_t of = this->index(*view, "buffer", place);
        if (fallback == nullptr || of >= fallback->item.size() ||
            (fallback->item[of].find("uri") == nullptr && !(of == 0 && has_binary_))) {
          fail(fmt::format("{} ({})", place, from),
               fmt::format("the extension {} is not read: export the model without compression",
                           name));
          return {};
        }
      }
  const std::string_view buffer = this->buffer(this->index(*view, "buffer", place));
  const std::uint64_t at = whole(*view, "byteOffset", place, 0),
                      bytes = this->index(*view, "byteLength", place);
  stride = whole(*view, "byteStride", place, 0);
  if (!ok()) return {};
  if (at > buffer.size() || bytes > buffer.size() - at) {
    fail(place,
         fmt::format("bytes {} to {} of a buffer of {} bytes", at, at + bytes, buffer.size()));
    return {};
  }
  return buffer.substr(at, bytes);
}

void GltfFile::read_numbers(std::string_view bytes, std::uint64_t stride, std::uint64_t type,
                            bool normalized, Values& out) {
  const std::size_t size = component_bytes(type);
  out.value.resize(out.count * out.width);
  for (std::size_t i = 0; i < out.count; ++i)
    for (std::size_t j = 0; j < out.width; ++j)
      out.value[i * out.width + j] = component(bytes, i * stride + j * size, type, normalized);
}

void GltfFile::put_sparse(const JsonValue& sparse, std::string_view place, std::uint64_t type,
                          bool normalized, Values& out) {
  const JsonValue *indices = sparse.find("indices"), *values = sparse.find("values");
  if (indices == nullptr || values == nullptr)
    return fail(place, indices == nullptr ? "has no indices" : "has no values");
  const auto take = [&](const JsonValue& of, const char* name, std::uint64_t of_type,
                        Values& read) {
    const std::string where = fmt::format("{}.{}", place, name);
    std::uint64_t stride = 0;
    const std::string_view view = this->view(index(of, "bufferView", where), where, stride);
    const std::uint64_t at = whole(of, "byteOffset", where, 0);
    const std::uint64_t element = read.width * component_bytes(of_type);
    if (!ok()) return;
    if (at > view.size() || read.count > (view.size() - at) / std::max<std::uint64_t>(element, 1))
      return fail(where, "ends behind its bufferView");
    read_numbers(view.substr(at), element, of_type, normalized && &of == values, read);
  };
  Values which, put;
  which.count = put.count = index(sparse, "count", place);
  which.width = 1;
  put.width = out.width;
  if (which.count > out.count)
    return fail(place, fmt::format("has {} values for {} elements", which.count, out.count));
  const std::uint64_t index_type =
      index(*indices, "componentType", fmt::format("{}.indices", place));
  if (ok() && index_type != 5121 && index_type != 5123 && index_type != 5125)
    return fail(fmt::format("{}.indices.componentType", place), "expected 5121, 5123 or 5125");
  if (!ok()) return;
  take(*indices, "indices", index_type, which);
  take(*values, "values", type, put);
  for (std::size_t i = 0; ok() && i < which.count; ++i) {
    const double to = which.value[i];
    if (to >= static_cast<double>(out.count))
      return fail(place, fmt::format("names element {} of {}", to, out.count));
    for (std::size_t j = 0; j < out.width; ++j)
      out.value[static_cast<std::size_t>(to) * out.width + j] = put.value[i * out.width + j];
  }
}

GltfFile::Values GltfFile::values(std::size_t accessor, std::string_view type,
                                  std::string_view from) {
  Values out;
  const JsonValue* of = element("accessors", accessor);
  if (of == nullptr) return out;
  const std::string place = fmt::format("accessors[{}]", accessor);
  const JsonValue* is = of->find("type");
  if (is == nullptr || is->text != type) {
    fail(place + ".type", fmt::format("is \"{}\", and {} needs {}",
                                      is == nullptr ? std::string() : is->text, from, type));
    return out;
  }
  const std::uint64_t component = index(*of, "componentType", place);
  const std::size_t size = component_bytes(component);
  const JsonValue* normal = of->find("normalized");
  const bool normalized = normal != nullptr && normal->boolean;
  if (ok() && size == 0) fail(place + ".componentType", "expected 5120 to 5123, 5125 or 5126");
  out.width = width_of(type);
  out.count = index(*of, "count", place);
  out.is_float = component == 5126;
  if (ok() && out.count * out.width > kMostNumbers)
    fail(place + ".count",
         fmt::format("is {}, expected at most {} numbers", out.count, kMostNumbers));
  if (!ok()) return {};
  if (of->find("bufferView") == nullptr) {
    out.value.assign(out.count * out.width, 0);
  } else {
    std::uint64_t stride = 0;
    const std::string_view view = this->view(index(*of, "bufferView", place), place, stride);
    const std::uint64_t at = whole(*of, "byteOffset", place, 0), element = size * out.width;
    if (stride == 0) stride = element;
    if (!ok()) return {};
    if (stride < element) fail(place, "its bufferView's byteStride is less than an element");
    if (out.count > 0 && (at > view.size() || element > view.size() - at ||
                          (out.count - 1) > (view.size() - at - element) / stride))
      fail(place,
           fmt::format("{} elements end behind a bufferView of {} bytes", out.count, view.size()));
    if (!ok()) return {};
    if (out.count > 0) read_numbers(view.substr(at), stride, component, normalized, out);
  }
  if (const JsonValue* sparse = of->find("sparse"); sparse != nullptr)
    put_sparse(*sparse, place + ".sparse", component, normalized, out);
  if (!ok()) return {};
  for (std::size_t i = 0; i < out.value.size(); ++i)
    if (!std::isfinite(out.value[i])) {
      fail(place, fmt::format("element {} ({}) is not finite", i / out.width, from));
      return {};
    }
  return out;
}

}  // namespace irsig
