#include <cstdint>

#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft {

/// FNV-1a, 64 bits (Fowler, Noll, Vo; RFC 9923): enough to tell scenes apart, not meant against forgery.
std::string content_hash(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char letter : text) {
    hash ^= static_cast<unsigned char>(letter);
    hash *= 0x100000001b3u;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace tuft
