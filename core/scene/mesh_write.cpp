#include <charconv>
#include <iterator>

#include "core/scene/mesh.h"
#include "fmt/format.h"

namespace irsig {
namespace {

void append_number(double value, std::string& out) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, value + 0.0).ptr);
}

}  // namespace

std::string write_obj(const Mesh& mesh) {
  std::string out = fmt::format("# x forward, y port, z up, in metres: {} vertices, {} triangles\n",
                                mesh.vertex.size(), mesh.triangle.size());
  out.reserve(60 * mesh.vertex.size() + 24 * mesh.triangle.size());
  for (const Vec<Body>& v : mesh.vertex) {
    out += "v ";
    append_number(v.x, out);
    out += ' ';
    append_number(-v.y, out);
    out += ' ';
    append_number(-v.z, out);
    out += '\n';
  }
  // "o" and not "g": its name may hold blanks.
  std::uint32_t group = 0;
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    if (i == 0 || mesh.triangle_group[i] != group) {
      group = mesh.triangle_group[i];
      fmt::format_to(std::back_inserter(out), "o {}\n", mesh.group[group]);
    }
    const auto& t = mesh.triangle[i];
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return out;
}

}  // namespace irsig
