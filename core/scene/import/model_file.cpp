#include "core/scene/import/model_file.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/printable.h"
#include "core/base/user_file.h"
#include "core/scene/import/import_json.h"
#include "core/scene/import/import_text.h"
#include "fmt/format.h"

namespace irsig {
namespace {

std::string as_base64(std::string_view bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      out += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63];
  }
  return out;
}

// A URI's %20 as a blank.
std::string without_percents(std::string_view uri) {
  std::string out;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      out += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

// The file that a buffer names, which must lie in the model's folder: links are followed first.
absl::StatusOr<std::string> read_buffer(const std::filesystem::path& folder, std::string_view uri,
                                        std::uint64_t most_bytes) {
  namespace fs = std::filesystem;
  const std::string name = without_percents(uri);
  const fs::path path(name);
  if (name.find('\\') != name.npos)
    return absl::InvalidArgumentError(
        "the path has a backslash, expected \"/\" between folders, as glTF requires");
  if (path.is_absolute() || name.find(':') != name.npos || name.find('\0') != name.npos ||
      std::ranges::find(path, fs::path("..")) != path.end())
    return absl::InvalidArgumentError("expected a file in the folder of the model");
  std::error_code error;
  const fs::path inside = fs::canonical(folder.empty() ? fs::path(".") : folder, error);
  const fs::path file = fs::weakly_canonical(inside / path, error);
  const auto [end, other] = std::mismatch(inside.begin(), inside.end(), file.begin(), file.end());
  if (end != inside.end())
    return absl::InvalidArgumentError("it lies outside the folder of the model");
  if (!fs::exists(file, error))
    return absl::InvalidArgumentError(
        "no such file, expected it beside the .gltf: copy it there, or export a .glb");
  return read_user_file(file.string(), most_bytes);
}

absl::StatusOr<std::string> with_buffers(std::string text, const std::filesystem::path& folder,
                                         std::uint64_t most_bytes) {
  const absl::StatusOr<JsonValue> root = parse_json(text, "");
  // The reader reports errors of the JSON text.
  const JsonValue* buffers = root.ok() ? root->find("buffers") : nullptr;
  if (buffers == nullptr) return text;
  std::string out;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < buffers->item.size(); ++i) {
    const JsonValue* uri = buffers->item[i].find("uri");
    if (uri == nullptr || uri->kind != JsonValue::Kind::kString || uri->text.starts_with("data:"))
      continue;
    const auto bytes = read_buffer(folder, uri->text, most_bytes);
    if (!bytes.ok())
      return absl::InvalidArgumentError(fmt::format("buffers[{}].uri \"{}\": {}", i,
                                                    one_line(uri->text),
                                                    std::string(bytes.status().message())));
    out += text.substr(copied, uri->begin - copied);
    out += "\"data:application/octet-stream;base64," + as_base64(*bytes) + "\"";
    copied = uri->end;
    if (out.size() > most_bytes)
      return absl::InvalidArgumentError(fmt::format(
          "has more than {} bytes with its buffers, expected at most so many", most_bytes));
  }
  if (copied == 0) return text;
  return out + text.substr(copied);
}

}  // namespace

absl::StatusOr<std::string> read_model_file(const std::string& path, std::uint64_t most_bytes) {
  absl::StatusOr<std::string> bytes = read_user_file(path, most_bytes);
  if (!bytes.ok()) return bytes;
  const std::filesystem::path file(path);
  if (!equals_ignoring_case(file.extension().string(), ".gltf") || bytes->starts_with("glTF"))
    return bytes;
  return with_buffers(*std::move(bytes), file.parent_path(), most_bytes);
}

absl::StatusOr<std::string> read_model_beside(const std::string& naming_file,
                                              const std::string& name, std::uint64_t most_bytes) {
  const std::filesystem::path folder = std::filesystem::path(naming_file).parent_path();
  auto bytes = read_model_file((folder / name).string(), most_bytes);
  if (bytes.ok() || folder.empty() || std::filesystem::path(name).is_absolute()) return bytes;
  return absl::InvalidArgumentError(
      fmt::format("{} (looked for beside {})", std::string(bytes.status().message()), naming_file));
}

}  // namespace irsig
