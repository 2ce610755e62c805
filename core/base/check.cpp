#include "core/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace irsig::check_detail {

void fail(const char* file, int line, const char* expression, const std::string& operands) {
  std::fprintf(stderr, "%s:%d: IRSIG_CHECK(%s) failed: %s\n", file, line, expression,
               operands.c_str());
  std::abort();
}

}  // namespace irsig::check_detail
