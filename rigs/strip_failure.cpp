#include "rigs/strip_failure.h"

namespace tuft::rigs {

bool strip_failed(const fe::Carpet& carpet) {
  return carpet.eroded_count() > 0;
}

}  // namespace tuft::rigs
