#include "dem_bridge/host/screen_ring.h"

#include <stdexcept>

namespace tuft::dem {
namespace {

ssize_t write_to_ring(void* cookie, const char* text, std::size_t size) {
  auto& shared = *static_cast<RankState*>(cookie);
  for (std::size_t i = 0; i < size; ++i)
    shared.words[(shared.words_written + i) % shared.words.size()] = text[i];
  shared.words_written += size;
  return static_cast<ssize_t>(size);
}

}  // namespace

std::FILE* open_screen_ring(RankState& shared) {
  cookie_io_functions_t functions{};
  functions.write = write_to_ring;
  std::FILE* stream = ::fopencookie(&shared, "w", functions);
  if (stream == nullptr) throw std::runtime_error("the screen stream cannot be opened");
  std::setvbuf(stream, nullptr, _IOLBF, BUFSIZ);
  return stream;
}

}  // namespace tuft::dem
