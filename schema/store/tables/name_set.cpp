#include "schema/store/tables/name_set.h"

#include "core/base/printable.h"

namespace irsig {

std::string NameSet::json() const {
  if (names_.empty()) return "";
  std::string out;
  for (const std::string& name : names_) out += (out.empty() ? '[' : ',') + json_string(name);
  return out + ']';
}

}  // namespace irsig
