#include "view/base/envi_text.h"

namespace irsig {

std::string envi_text(std::string text) {
  for (char& c : text)
    if (c == '{' || c == '}' || c == ',' || c == '\n' || c == '\r') c = '_';
  return text;
}

}  // namespace irsig
